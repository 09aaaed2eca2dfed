// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/editor/curve_view.h"

#include <QLocale>
#include <QMouseEvent>
#include <QPainter>
#include <algorithm>
#include <cmath>

#include "desktop/widgets/theme.h"

namespace handpiece::desktop {
namespace {

constexpr double kKnotPixels = 5.0, kKnotReach = 10.0;

/// 1, 2 or 5 times a power of ten, near to a hundredth of what is shown.
double roundStep(double span) {
    const double rough = 0.01 * span, ten = std::pow(10.0, std::floor(std::log10(rough)));
    for (const double of : {1.0, 2.0, 5.0})
        if (of * ten >= rough) return of * ten;
    return 10.0 * ten;
}
/// As it is written: no crumbs of a sum.
double onStep(double value, double step) {
    return QString::number(std::round(value / step) * step, 'g', 9).toDouble();
}

}  // namespace

CurveView::CurveView(QWidget* parent) : QWidget(parent) {
    setObjectName(QStringLiteral("editorCurve"));
    setAccessibleName(tr("Points by value"));
    setToolTip(tr("Drag a knot. Double click: another one. Right button or Delete: away with it. Arrow keys move it."));
    setFocusPolicy(Qt::StrongFocus);
    setMouseTracking(true);
}

void CurveView::setCurve(const std::vector<rubric::Knot>& knots, const QString& unit, double least, double most) {
    if (dragging_) return;
    knots_ = knots;
    unit_ = unit;
    least_ = least, most_ = most;
    low_ = knots.empty() ? 0.0 : knots.front().value;
    high_ = knots.empty() ? 1.0 : knots.front().value;
    for (const rubric::Knot& k : knots)
        low_ = std::min(low_, k.value), high_ = std::max(high_, k.value);
    if (high_ - low_ < 1e-9) high_ = low_ + 1.0;
    const double margin = 0.15 * (high_ - low_);
    low_ = std::max(least, low_ - margin), high_ = std::min(most, high_ + margin);
    if (!(high_ > low_)) high_ = low_ + 1.0;
    step_ = roundStep(high_ - low_);
    if (chosen_ >= static_cast<int>(knots_.size())) chosen_ = -1;
    update();
}

QRectF CurveView::area() const {
    return QRectF(rect()).adjusted(30, 10, -12, -22);
}

QPointF CurveView::at(const rubric::Knot& knot) const {
    const QRectF box = area();
    return {box.left() + (knot.value - low_) / (high_ - low_) * box.width(),
            box.bottom() - 0.01 * knot.points * box.height()};
}

rubric::Knot CurveView::knotAt(const QPointF& place) const {
    const QRectF box = area();
    return {low_ + (place.x() - box.left()) / std::max(1.0, box.width()) * (high_ - low_),
            100.0 * (box.bottom() - place.y()) / std::max(1.0, box.height())};
}

int CurveView::knotUnder(const QPointF& place) const {
    int found = -1;
    double least = kKnotReach;
    for (int i = 0; i < static_cast<int>(knots_.size()); ++i) {
        const QPointF by = at(knots_[static_cast<std::size_t>(i)]) - place;
        if (const double far = std::hypot(by.x(), by.y()); far < least) least = far, found = i;
    }
    return found;
}

void CurveView::moveKnot(int which, rubric::Knot to) {
    const auto i = static_cast<std::size_t>(which);
    to.points = std::clamp(std::round(to.points), 0.0, 100.0);
    const double low = i > 0 ? knots_[i - 1].value + step_ : std::max(low_, least_);
    const double high = i + 1 < knots_.size() ? knots_[i + 1].value - step_ : std::min(high_, most_);
    to.value = onStep(std::clamp(to.value, low, std::max(low, high)), step_);
    knots_[i] = to;
    update();
}

void CurveView::remove(int which) {
    if (which < 0) return;
    knots_.erase(knots_.begin() + which);
    chosen_ = -1;
    emit knotsChanged(knots_);
}

void CurveView::paintEvent(QPaintEvent* event) {
    Q_UNUSED(event);
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.fillRect(rect(), palette().color(QPalette::Base));
    const QRectF box = area();
    const QColor ink = palette().color(QPalette::Text), faint = mixed(ink, palette().color(QPalette::Base), 0.75);
    painter.setFont(scaledFont(font(), 0.8));
    painter.setPen(faint);
    for (const double points : {0.0, 50.0, 100.0}) {
        const double y = box.bottom() - 0.01 * points * box.height();
        painter.drawLine(QPointF(box.left(), y), QPointF(box.right(), y));
        painter.drawText(QRectF(0, y - 8, box.left() - 4, 16), Qt::AlignRight | Qt::AlignVCenter,
                         QString::number(points));
    }
    painter.setPen(ink);
    const auto number = [this](double value) {
        return QLocale().toString(onStep(value, step_), 'g', 6) +
               (unit_.isEmpty() ? QString() : QLatin1Char(' ') + unit_);
    };
    painter.drawText(QRectF(box.left(), box.bottom() + 3, 0.5 * box.width(), 16), Qt::AlignLeft, number(low_));
    painter.drawText(QRectF(box.center().x(), box.bottom() + 3, 0.5 * box.width(), 16), Qt::AlignRight, number(high_));
    if (knots_.empty()) {
        painter.drawText(box, Qt::AlignCenter | Qt::TextWordWrap, tr("No curve: a double click makes its first knot"));
    } else {
        // Held at its ends.
        QPolygonF line{QPointF(box.left(), at(knots_.front()).y())};
        for (const rubric::Knot& k : knots_)
            line << at(k);
        line << QPointF(box.right(), at(knots_.back()).y());
        painter.setPen(QPen(palette().color(QPalette::Highlight), 2));
        painter.drawPolyline(line);
        for (int i = 0; i < static_cast<int>(knots_.size()); ++i) {
            painter.setBrush(i == chosen_ ? QColor(0xff, 0xd5, 0x4a) : palette().color(QPalette::Highlight));
            painter.setPen(QPen(ink, 1));
            painter.drawEllipse(at(knots_[static_cast<std::size_t>(i)]), kKnotPixels, kKnotPixels);
        }
        if (chosen_ >= 0) {
            const rubric::Knot& k = knots_[static_cast<std::size_t>(chosen_)];
            const QString text = QStringLiteral("%1: %2").arg(QLocale().toString(k.value, 'g', 6)).arg(k.points);
            QRectF label(0, 0, painter.fontMetrics().horizontalAdvance(text) + 10.0, 18);
            label.moveCenter(at(k) + QPointF(0, k.points > 50.0 ? 16 : -16));
            label.moveLeft(std::clamp(label.left(), 0.0, std::max(0.0, width() - label.width())));
            painter.setPen(ink);
            painter.drawText(label, Qt::AlignCenter, text);
        }
    }
    if (hasFocus()) {
        painter.setPen(QPen(palette().color(QPalette::Highlight), 1));
        painter.setBrush(Qt::NoBrush);
        painter.drawRect(QRectF(rect()).adjusted(0.5, 0.5, -0.5, -0.5));
    }
}

void CurveView::mousePressEvent(QMouseEvent* event) {
    chosen_ = knotUnder(event->position());
    update();
    if (event->button() == Qt::RightButton) return remove(chosen_);
    if (event->button() != Qt::LeftButton || chosen_ < 0) return;
    before_ = knots_;
    dragging_ = true;
}

void CurveView::mouseMoveEvent(QMouseEvent* event) {
    if (dragging_)
        moveKnot(chosen_, knotAt(event->position()));
    else
        setCursor(knotUnder(event->position()) >= 0 ? Qt::OpenHandCursor : Qt::ArrowCursor);
}

void CurveView::mouseReleaseEvent(QMouseEvent* event) {
    if (!dragging_ || event->button() != Qt::LeftButton) return;
    dragging_ = false;
    if (knots_ != before_) emit knotsChanged(knots_);
}

void CurveView::mouseDoubleClickEvent(QMouseEvent* event) {
    if (event->button() != Qt::LeftButton || knotUnder(event->position()) >= 0 || knots_.size() >= rubric::kMaxPieces)
        return;
    rubric::Knot made = knotAt(event->position());
    made.value = onStep(std::clamp(made.value, least_, most_), step_);
    made.points = std::clamp(std::round(made.points), 0.0, 100.0);
    for (const rubric::Knot& k : knots_)
        if (k.value == made.value) return;
    knots_.insert(std::upper_bound(knots_.begin(), knots_.end(), made,
                                   [](const auto& a, const auto& b) { return a.value < b.value; }),
                  made);
    emit knotsChanged(knots_);
}

bool CurveView::event(QEvent* event) {
    if (event->type() == QEvent::ShortcutOverride && dragging_ &&
        static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape) {
        event->accept();
        return true;
    }
    return QWidget::event(event);
}

void CurveView::keyPressEvent(QKeyEvent* event) {
    if (event->key() == Qt::Key_Escape && dragging_) {
        dragging_ = false;
        knots_ = before_;
        return update();
    }
    if (chosen_ < 0) return QWidget::keyPressEvent(event);
    rubric::Knot to = knots_[static_cast<std::size_t>(chosen_)];
    switch (event->key()) {
        case Qt::Key_Left:
            to.value -= step_;
            break;
        case Qt::Key_Right:
            to.value += step_;
            break;
        case Qt::Key_Up:
            to.points += 1.0;
            break;
        case Qt::Key_Down:
            to.points -= 1.0;
            break;
        case Qt::Key_Delete:
            return remove(chosen_);
        default:
            return QWidget::keyPressEvent(event);
    }
    moveKnot(chosen_, to);
    emit knotsChanged(knots_);
}

}  // namespace handpiece::desktop
