// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The panels around the picture: each in a dock with a place in each of the three layouts.

#include <QMainWindow>
#include <functional>
#include <vector>

#include "desktop/widgets/detail.h"

class QDockWidget;

namespace handpiece::desktop {

/// Where a panel stands in a layout. One that has none there is closed.
struct DockPlace {
    Detail detail;
    Qt::DockWidgetArea area;
    int at;                            ///< in this order, from top to bottom
    int size;                          ///< of its share of the area [pixels]; 0: what it needs
    const char* tabbedWith = nullptr;  ///< null: beside the others
    int width = 0;                     ///< of its share below the picture [pixels]; 0: as it comes
    bool grows = true;                 ///< where the area is higher than all need
};
struct DockRow {
    const char* name;  ///< "drillDock"; docs/desktop-objects.md lists them
    QString title;
    int at;  ///< its place in the menu of panels
    std::vector<DockPlace> places;
    /// A panel that is there only sometimes; none: the layouts decide.
    std::function<bool()> isWanted = {};
};

class Docks : public QObject {
    Q_OBJECT
  public:
    explicit Docks(QMainWindow* window) : QObject(window), window_(window) {}
    /// A panel with setDetail() hears of the layout.
    template <class Panel>
    QDockWidget* add(DockRow row, Panel* panel) {
        if constexpr (requires { panel->setDetail(Detail::paper); })
            connect(this, &Docks::detailChanged, panel, &Panel::setDetail);
        return addWidget(std::move(row), panel);
    }
    /// All to the places that this layout has for them.
    void arrange(Detail detail);
    /// Those with a wish of their own, once the layout is there.
    void showWanted();
    [[nodiscard]] std::vector<QDockWidget*> all() const;

  signals:
    /// Before the panels are placed.
    void detailChanged(handpiece::desktop::Detail detail);

  private:
    struct Docked {
        DockRow row;
        QDockWidget* dock;
    };
    QDockWidget* addWidget(DockRow row, QWidget* panel);
    [[nodiscard]] QDockWidget* byName(const char* name) const;

    QMainWindow* window_;
    std::vector<Docked> docks_;
};

}  // namespace handpiece::desktop
