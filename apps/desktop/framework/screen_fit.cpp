// SPDX-License-Identifier: Apache-2.0
#include "desktop/framework/screen_fit.h"

#include <QEvent>
#include <QScreen>
#include <QWidget>
#include <algorithm>

namespace handpiece::desktop {

QRect roomOn(const QScreen& screen) {
    return screen.availableGeometry().adjusted(0, kTitlePixels, 0, 0);
}

void fitToScreen(QWidget& window) {
    const QRect room = roomOn(*window.screen());
    const QSize size = window.size().boundedTo(room.size());
    if (size != window.size()) window.resize(size);
    // One that was never moved is centred by Qt, or placed by the desktop.
    if (!window.testAttribute(Qt::WA_Moved)) return;
    const QRect now = window.geometry();
    const QPoint at(std::clamp(now.x(), room.left(), std::max(room.left(), room.right() + 1 - now.width())),
                    std::clamp(now.y(), room.top(), std::max(room.top(), room.bottom() + 1 - now.height())));
    if (at != now.topLeft()) window.setGeometry(QRect(at, now.size()));
}

bool ScreenFit::eventFilter(QObject* of, QEvent* event) {
    if (event->type() == QEvent::Show && of->isWidgetType() && !event->spontaneous()) {
        auto* widget = static_cast<QWidget*>(of);
        const Qt::WindowType type = widget->windowType();
        const bool fills = (widget->windowState() & (Qt::WindowMaximized | Qt::WindowFullScreen)) != 0;
        if (widget->isWindow() && (type == Qt::Dialog || type == Qt::Window) && !fills) fitToScreen(*widget);
    }
    return QObject::eventFilter(of, event);
}

}  // namespace handpiece::desktop
