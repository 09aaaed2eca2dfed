// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Every command of the window: its name for scripts, text, tooltip, icon and key.

#include <QAction>
#include <QHash>
#include <QObject>
#include <QString>

namespace handpiece::desktop {

/// The actions, made once for a window. Object names are "actionSave" and so on; docs/desktop-objects.md lists them.
class Actions : public QObject {
    Q_OBJECT
  public:
    explicit Actions(QWidget* window);
    /// By its object name. There is no other way to one; an unknown name is a mistake of ours and ends the program.
    [[nodiscard]] QAction* operator[](const char* name) const;
    /// Its tooltip says that the exercise locks it, or again what it does.
    void setLocked(const char* name, bool locked) const;
    [[nodiscard]] const QList<QAction*>& all() const noexcept { return ordered_; }

  private:
    QHash<QByteArray, QAction*> byName_;
    QList<QAction*> ordered_;
};

}  // namespace handpiece::desktop
