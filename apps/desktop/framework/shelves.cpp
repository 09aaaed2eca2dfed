// SPDX-License-Identifier: Apache-2.0
#include "desktop/framework/shelves.h"

#include <QDockWidget>
#include <QMainWindow>
#include <QMenu>
#include <QMenuBar>
#include <QShortcut>
#include <QToolBar>

#include "desktop/framework/mnemonics.h"

namespace handpiece::desktop {

Shelves::Shelves(QMainWindow* window, Commands& commands) : QObject(window), window_(window), commands_(commands) {
    addBar(Shelf::fileBar, "fileBar", tr("File bar"));
    addBar(Shelf::toolBar, "toolBar", tr("Tool bar"));
    QMenuBar* bar = window_->menuBar();
    addMenu(Shelf::file, "menuFile", bar->addMenu(tr("File")));
    addMenu(Shelf::edit, "menuEdit", bar->addMenu(tr("Edit")));
    addMenu(Shelf::view, "menuView", bar->addMenu(tr("View")));
    addMenu(Shelf::tools, "menuTools", bar->addMenu(tr("Tools")));
    addMenu(Shelf::sound, "menuSound", bar->addMenu(tr("Sound")));
    addMenu(Shelf::device, "menuDevice", bar->addMenu(tr("Device")));
    addMenu(Shelf::help, "menuHelp", bar->addMenu(tr("Help")));
    for (QMenu* menu : menus_)
        menu->setToolTipsVisible(true);
    under(Shelf::panels, "menuPanels", tr("Panels"), 23);
    under(Shelf::theme, "menuTheme", tr("Colours of the window"), 30);
    under(Shelf::language, "menuLanguage", tr("Language"), 31);
    giveMnemonics(bar->actions());
    // Where the desktop keeps Alt for itself.
    auto* first = new QShortcut(Qt::Key_F10, window_);
    connect(first, &QShortcut::activated, bar, [bar] { bar->setActiveAction(bar->actions().front()); });
}

QMenu* Shelves::addMenu(Shelf shelf, const char* name, QMenu* menu) {
    menu->setObjectName(QLatin1String(name));
    return menus_[shelf] = withMnemonics(menu);
}

QMenu* Shelves::under(Shelf shelf, const char* name, const QString& title, int at) {
    auto* menu = new QMenu(title, menus_[Shelf::view]);
    commands_.place({Shelf::view, at}, menu->menuAction());
    return addMenu(shelf, name, menu);
}

void Shelves::addBar(Shelf shelf, const char* name, const QString& title) {
    QToolBar* bar = bars_[shelf] = window_->addToolBar(title);
    bar->setObjectName(QLatin1String(name));
    bar->setMovable(true);
    bar->setIconSize({22, 22});
    bar->toggleViewAction()->setObjectName(QStringLiteral("actionPanel_") + bar->objectName());
    bar->toggleViewAction()->setToolTip(tr("Show or hide this bar"));
}

void Shelves::fill(const std::vector<QDockWidget*>& docks) {
    const auto fill = [this](Shelf shelf, auto* with) {
        int before = -1;
        for (const auto& [place, action] : commands_.on(shelf)) {
            if (before >= 0 && place.at / 10 != before) with->addSeparator();
            before = place.at / 10;
            with->addAction(action);
        }
    };
    for (auto menu = menus_.cbegin(); menu != menus_.cend(); ++menu)
        fill(menu.key(), menu.value());
    for (auto bar = bars_.cbegin(); bar != bars_.cend(); ++bar)
        fill(bar.key(), bar.value());
    QMenu* panels = menus_[Shelf::panels];
    for (QDockWidget* dock : docks)
        panels->addAction(dock->toggleViewAction());
    panels->addSeparator();
    for (const Shelf shelf : {Shelf::fileBar, Shelf::toolBar})
        panels->addAction(bars_[shelf]->toggleViewAction());
}

void Shelves::arrange(Detail detail) {
    for (QToolBar* bar : bars_)
        window_->removeToolBar(bar);
    const Qt::ToolButtonStyle style = detail == Detail::paper      ? Qt::ToolButtonTextBesideIcon
                                      : detail == Detail::practice ? Qt::ToolButtonTextUnderIcon
                                                                   : Qt::ToolButtonIconOnly;
    for (const Shelf shelf : {Shelf::fileBar, Shelf::toolBar}) {
        QToolBar* bar = bars_[shelf];
        if (detail == Detail::paper && shelf == Shelf::toolBar) window_->addToolBarBreak();
        window_->addToolBar(Qt::TopToolBarArea, bar);
        bar->show();
        bar->setToolButtonStyle(style);
    }
}

}  // namespace handpiece::desktop
