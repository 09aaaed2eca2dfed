// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The foot pedal's part of the menu Device, and what is told of it.

#include <QMenu>
#include <QObject>

#include "shell/foot.h"
#include "shell/settings.h"

namespace handpiece::desktop {

class PedalMenu : public QObject {
    Q_OBJECT
  public:
    PedalMenu(Foot& foot, Settings& settings, QWidget* window);
    [[nodiscard]] QMenu* menu() const noexcept { return menu_; }

  signals:
    /// As MainWindow::tell() takes them; the other: it is no longer so.
    void noticed(const QString& id, const QStringList& arguments);
    void settled(const QString& id);
    void failed(const handpiece::desktop::Problem& problem);

  private:
    void list();
    void choose(const QString& name);

    Foot& foot_;
    Settings& settings_;
    QMenu* menu_;
    bool isAsked_ = false;  ///< a person is waiting: what goes wrong is worth a dialog
};

}  // namespace handpiece::desktop
