// SPDX-License-Identifier: Apache-2.0
#include "desktop/widgets/scrolled.h"

#include <QEvent>
#include <QLayout>
#include <QScrollBar>
#include <algorithm>

namespace handpiece::desktop {

Scrolled::Scrolled(QLayout* contents, QWidget* parent) : QScrollArea(parent) {
    setWidgetResizable(true);
    setFrameShape(QFrame::NoFrame);
    setFocusPolicy(Qt::NoFocus);
    auto* within = new QWidget;
    contents->setContentsMargins(0, 0, 0, 0);
    within->setLayout(contents);
    setWidget(within);
}

QSize Scrolled::sizeHint() const {
    return widget()->sizeHint().expandedTo(widget()->minimumSizeHint());
}

QSize Scrolled::minimumSizeHint() const {
    // As wide as it needs to be, unless that is more than a small screen has: words are read line by line.
    constexpr int kMostWide = 560, kLeastHigh = 96;
    const QSize least = widget()->minimumSizeHint();
    return {std::min(kMostWide, least.width() + verticalScrollBar()->sizeHint().width()),
            std::min(kLeastHigh, least.height())};
}

bool Scrolled::eventFilter(QObject* of, QEvent* event) {
    if (of == widget() && event->type() == QEvent::LayoutRequest) updateGeometry();
    return QScrollArea::eventFilter(of, event);
}

}  // namespace handpiece::desktop
