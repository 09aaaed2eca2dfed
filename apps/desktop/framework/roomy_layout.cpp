// SPDX-License-Identifier: Apache-2.0
#include "desktop/framework/roomy_layout.h"

#include <QEvent>
#include <QScreen>
#include <utility>

namespace handpiece::desktop {
namespace {

// Below this panels are squeezed; on a screen that has no more, below this share of it.
constexpr QSize kRoom{1000, 600};
constexpr double kShareOfScreen = 0.75;

}  // namespace

RoomyLayout::RoomyLayout(QMainWindow* window, int version) : QObject(window), window_(window), version_(version) {
    window_->installEventFilter(this);
}

bool RoomyLayout::hasRoom() const {
    const QSize enough = kRoom.boundedTo(window_->screen()->availableSize() * kShareOfScreen);
    return window_->width() >= enough.width() && window_->height() >= enough.height();
}

QByteArray RoomyLayout::state() const {
    return hasRoom() || roomy_.isEmpty() ? window_->saveState(version_) : roomy_;
}

void RoomyLayout::restore(const QByteArray& state) {
    hadRoom_ = hasRoom();
    roomy_ = state;
    if (!state.isEmpty()) window_->restoreState(state, version_);
}

void RoomyLayout::resized() {
    const bool had = std::exchange(hadRoom_, hasRoom());
    if (!hadRoom_) return;
    if (!had && !roomy_.isEmpty()) {
        // When this size is laid out.
        QMetaObject::invokeMethod(
            this, [this] { window_->restoreState(roomy_, version_); }, Qt::QueuedConnection);
        return;
    }
    roomy_ = window_->saveState(version_);
}

bool RoomyLayout::eventFilter(QObject* of, QEvent* event) {
    // A panel or its edge was dragged.
    const bool isMoved = event->type() == QEvent::MouseButtonRelease && hadRoom_;
    if ((event->type() == QEvent::Resize && window_->isVisible()) || event->type() == QEvent::Show)
        resized();
    else if (isMoved)
        roomy_ = window_->saveState(version_);
    return QObject::eventFilter(of, event);
}

}  // namespace handpiece::desktop
