// SPDX-License-Identifier: Apache-2.0
#include "desktop/picture/strip_stack.h"

#include <QEvent>
#include <QLayout>
#include <QWidget>
#include <algorithm>

namespace handpiece::desktop {

namespace {

constexpr int kSide = 12, kBetween = 6, kWidest = 760;
// In the picture's lower corners stand its scale and its legend: what comes below stands between them, or over them
// where the picture is too narrow for that.
constexpr int kScaleWide = 250, kLegendWide = 150, kCornersHigh = 130, kNarrowest = 340;

int heightOf(QWidget* strip, int width) {
    if (strip->layout()) strip->layout()->activate();
    return strip->hasHeightForWidth() ? strip->heightForWidth(width) : strip->sizeHint().height();
}

}  // namespace

StripStack::StripStack(QWidget* picture) : QObject(picture), picture_(picture) {
    picture_->installEventFilter(this);
}

void StripStack::add(QWidget* strip, Where where) {
    const bool shown = !strip->isHidden();
    strip->setParent(picture_);
    // A press on a message is none on the tooth under it.
    strip->setAttribute(Qt::WA_NoMousePropagation);
    strip->setCursor(Qt::ArrowCursor);
    strip->setVisible(shown);
    strip->installEventFilter(this);
    (where == Where::above ? strips_ : where == Where::below ? below_ : corner_) << strip;
    place();
}

void StripStack::setTop(int pixels) {
    if (pixels == top_) return;
    top_ = pixels;
    place();
}

std::vector<QRectF> StripStack::covered() const {
    std::vector<QRectF> places;
    for (const QWidget* strip : strips_ + below_ + corner_)
        if (!strip->isHidden()) places.emplace_back(strip->geometry());
    return places;
}

bool StripStack::eventFilter(QObject* watched, QEvent* event) {
    switch (event->type()) {
        case QEvent::Resize:
            if (watched == picture_) place();
            break;
        case QEvent::ShowToParent:
        case QEvent::HideToParent:
        case QEvent::LayoutRequest:
            if (watched != picture_) place();
            break;
        default:
            break;
    }
    return QObject::eventFilter(watched, event);
}

void StripStack::place() {
    const int width = std::min(picture_->width() - 2 * kSide, kWidest);
    int y = top_;
    for (QWidget* strip : strips_) {
        if (strip->isHidden()) continue;
        const int height = heightOf(strip, width);
        strip->setGeometry((picture_->width() - width) / 2, y, width, height);
        strip->raise();
        y += height + kBetween;
    }
    placeBelow();
    placeInCorner();
}

/// Beside the strips above, under them where the picture is too narrow for that.
void StripStack::placeInCorner() {
    for (QWidget* card : corner_) {
        if (card->isHidden()) continue;
        const QSize size = card->sizeHint();
        QRect place(QPoint(picture_->width() - size.width() - kSide, top_), size);
        for (const QWidget* strip : strips_)
            if (!strip->isHidden() && strip->geometry().intersects(place))
                place.moveTop(strip->geometry().bottom() + 1 + kBetween);
        card->setGeometry(place);
        card->raise();
    }
}

void StripStack::placeBelow() {
    const int between = picture_->width() - kScaleWide - kLegendWide;
    const bool fits = between >= kNarrowest;
    const int width = std::min(fits ? between : picture_->width() - 2 * kSide, kWidest);
    const int x = fits ? kScaleWide + (between - width) / 2 : (picture_->width() - width) / 2;
    int y = picture_->height() - (fits ? kSide : kCornersHigh);
    for (QWidget* strip : below_) {
        if (strip->isHidden()) continue;
        const int height = heightOf(strip, width);
        y -= height;
        strip->setGeometry(x, y, width, height);
        strip->raise();
        y -= kBetween;
    }
}

}  // namespace handpiece::desktop
