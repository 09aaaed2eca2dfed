// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The menus and bars of the window, filled with what commands say of their places.

#include <QHash>
#include <QObject>

#include "desktop/framework/commands.h"
#include "desktop/widgets/detail.h"

class QDockWidget;
class QMainWindow;
class QMenu;
class QToolBar;

namespace handpiece::desktop {

class Shelves : public QObject {
    Q_OBJECT
  public:
    Shelves(QMainWindow* window, Commands& commands);
    [[nodiscard]] QMenu* menu(Shelf shelf) const { return menus_[shelf]; }
    [[nodiscard]] QToolBar* bar(Shelf shelf) const { return bars_[shelf]; }
    /// Once all commands are there. `docks` go into the menu of panels.
    void fill(const std::vector<QDockWidget*>& docks);
    /// The bars to where this layout has them.
    void arrange(Detail detail);

  private:
    QMenu* addMenu(Shelf shelf, const char* name, QMenu* menu);
    QMenu* under(Shelf shelf, const char* name, const QString& title, int at);
    void addBar(Shelf shelf, const char* name, const QString& title);

    QMainWindow* window_;
    Commands& commands_;
    QHash<Shelf, QMenu*> menus_;
    QHash<Shelf, QToolBar*> bars_;
};

}  // namespace handpiece::desktop
