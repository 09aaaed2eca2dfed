// SPDX-License-Identifier: Apache-2.0
#include "desktop/framework/docks.h"

#include <QAction>
#include <QDockWidget>
#include <QScreen>
#include <QScrollArea>
#include <algorithm>

namespace handpiece::desktop {
namespace {

constexpr int kMostOfWidth = 32, kLowScreen = 600, kLeastHeight = 24;

/// At least as wide as it wants to be, unless that is more than `most`: then it scrolls.
void needsWidth(QScrollArea& scroll, int wanted, int most) {
    scroll.setMinimumWidth(std::min(wanted, most));
    if (wanted > most) scroll.setHorizontalScrollBarPolicy(Qt::ScrollBarAsNeeded);
}

}  // namespace

QDockWidget* Docks::addWidget(DockRow row, QWidget* panel) {
    auto* scroll = new QScrollArea;
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    scroll->setWidget(panel);
    // On a small screen the picture keeps its share, and what a panel has no room for scrolls.
    const QSize room = window_->screen()->availableSize();
    needsWidth(*scroll, panel->minimumSizeHint().width() + 4, room.width() * kMostOfWidth / 100);
    if (room.height() < kLowScreen) scroll->setMinimumHeight(kLeastHeight);
    auto* dock = new QDockWidget(row.title, window_);
    dock->setObjectName(QLatin1String(row.name));
    dock->setAccessibleName(row.title);
    dock->setWidget(scroll);
    dock->toggleViewAction()->setObjectName(QStringLiteral("actionPanel_") + QLatin1String(row.name));
    dock->toggleViewAction()->setToolTip(tr("Show or hide this panel"));
    const auto after = std::upper_bound(docks_.begin(), docks_.end(), row.at,
                                        [](int at, const Docked& other) { return at < other.row.at; });
    docks_.insert(after, {std::move(row), dock});
    return dock;
}

std::vector<QDockWidget*> Docks::all() const {
    std::vector<QDockWidget*> docks;
    for (const Docked& docked : docks_)
        docks.push_back(docked.dock);
    return docks;
}

QDockWidget* Docks::byName(const char* name) const {
    const auto found = std::find_if(docks_.begin(), docks_.end(), [name](const Docked& docked) {
        return docked.dock->objectName() == QLatin1String(name);
    });
    return found == docks_.end() ? nullptr : found->dock;
}

void Docks::arrange(Detail detail) {
    emit detailChanged(detail);
    std::vector<std::pair<DockPlace, QDockWidget*>> places;
    for (const Docked& docked : docks_) {
        docked.dock->setFloating(false);
        window_->removeDockWidget(docked.dock);
        for (const DockPlace& place : docked.row.places)
            if (place.detail == detail) places.emplace_back(place, docked.dock);
    }
    std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.first.at < b.first.at; });
    QList<QDockWidget*> untabbed, below;
    QList<int> heights, widths;
    for (const auto& [place, dock] : places) {
        window_->addDockWidget(place.area, dock);
        if (place.tabbedWith) {
            window_->tabifyDockWidget(byName(place.tabbedWith), dock);
        } else {
            untabbed << dock;
            dock->setSizePolicy(QSizePolicy::Preferred, place.grows ? QSizePolicy::Preferred : QSizePolicy::Maximum);
            const int size = place.size > 0 ? place.size : dock->sizeHint().height();
            // On a low screen the picture keeps its share.
            const bool isBelow = place.area == Qt::BottomDockWidgetArea;
            heights << (isBelow ? std::min(size, window_->height() * 3 / 10) : size);
        }
        if (place.width > 0) {
            below << dock;
            // Those in one row share the width that the picture has.
            auto* scroll = static_cast<QScrollArea*>(dock->widget());
            needsWidth(*scroll, scroll->minimumWidth(), window_->screen()->availableSize().width() / 6);
            widths << place.width;
        }
        dock->show();
    }
    window_->resizeDocks(untabbed, heights, Qt::Vertical);
    for (const auto& [place, dock] : places)
        if (place.area != Qt::BottomDockWidgetArea)
            window_->resizeDocks({dock}, {place.area == Qt::LeftDockWidgetArea ? 262 : 304}, Qt::Horizontal);
    if (!below.isEmpty()) window_->resizeDocks(below, widths, Qt::Horizontal);
    for (QDockWidget* dock : untabbed)
        dock->raise();
    showWanted();
}

void Docks::showWanted() {
    for (const Docked& docked : docks_)
        if (docked.row.isWanted) docked.dock->setVisible(docked.row.isWanted());
}

}  // namespace handpiece::desktop
