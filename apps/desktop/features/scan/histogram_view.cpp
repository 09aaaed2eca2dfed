// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/scan/histogram_view.h"

#include <QLocale>
#include <QMouseEvent>
#include <QPainter>
#include <QPainterPath>
#include <algorithm>
#include <cmath>
#include <limits>

#include "desktop/features/scan/tissue_colours.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

using segmentation::Thresholds;

namespace {

constexpr double kGrabPixels = 10.0;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

QString nameOf(int handle) {
    switch (handle) {
        case HistogramView::tooth:
            return HistogramView::tr("tooth from");
        case HistogramView::enamel:
            return HistogramView::tr("enamel from");
        default:
            return HistogramView::tr("filling from");
    }
}

}  // namespace

HistogramView::HistogramView(QWidget* parent) : QWidget(parent) {
    named(this, "histogram", tr("Grey values and where tissues begin"),
          tr("Drag a handle to say where a tissue begins. Keys: Up and Down choose a handle, Left and Right move it."));
    setFocusPolicy(Qt::StrongFocus);
    setMouseTracking(true);
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
}

void HistogramView::setHistogram(const GreyHistogram& histogram) {
    histogram_ = histogram;
    hasHistogram_ = true;
    update();
}

void HistogramView::setThresholds(const std::optional<Thresholds>& thresholds, bool byHand) {
    byHand_ = byHand;
    // Under the hand its own wins.
    if (held_ < 0) thresholds_ = thresholds;
    tell();
    update();
}

void HistogramView::tell() {
    if (!thresholds_) return setAccessibleDescription({});
    QStringList words;
    for (int h = 0; h < handleCount; ++h) {
        const float value = valueOf(static_cast<Handle>(h));
        words << nameOf(h) + QLatin1Char(' ') + (std::isfinite(value) ? QLocale().toString(value, 'f', 0) : tr("none"));
    }
    setAccessibleDescription(words.join(QStringLiteral(", ")));
}

QRectF HistogramView::plot() const {
    const double line = fontMetrics().height();
    return QRectF(rect()).adjusted(10, line + 8, -10, -line - 6);
}

double HistogramView::pixelOf(float grey) const {
    const QRectF area = plot();
    if (!std::isfinite(grey)) return area.right();
    const double share = (grey - histogram_.low) / std::max(1e-6f, histogram_.high - histogram_.low);
    return area.left() + std::clamp(share, 0.0, 1.0) * area.width();
}

float HistogramView::greyAt(double x) const {
    const QRectF area = plot();
    return histogram_.low + static_cast<float>(std::clamp((x - area.left()) / area.width(), 0.0, 1.0)) *
                                (histogram_.high - histogram_.low);
}

float HistogramView::valueOf(Handle handle) const {
    if (!thresholds_) return 0;
    return handle == tooth    ? thresholds_->toothFrom
           : handle == enamel ? thresholds_->enamelFrom
                              : thresholds_->restorationFrom;
}

void HistogramView::move(Handle handle, float grey) {
    if (!thresholds_) return;
    Thresholds& t = *thresholds_;
    const float least = (histogram_.high - histogram_.low) / 200.0f;
    switch (handle) {
        case tooth:
            t.toothFrom = std::min(grey, t.enamelFrom - least);
            break;
        case enamel:
            t.enamelFrom =
                std::clamp(grey, t.toothFrom + least, std::max(t.toothFrom + least, t.restorationFrom - least));
            break;
        default:
            // At the right end there is no filling.
            t.restorationFrom =
                grey >= histogram_.high - 0.5f * least ? kInfinity : std::max(grey, t.enamelFrom + least);
            break;
    }
    byHand_ = true;
    tell();
    update();
    emit thresholdsMoved(t);
}

void HistogramView::paintEvent(QPaintEvent* event) {
    Q_UNUSED(event);
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const Tones tones = tonesOf(palette());
    const QRectF area = plot();
    painter.setPen(QPen(tones.line, 1));
    painter.setBrush(tones.raised);
    painter.drawRoundedRect(QRectF(rect()).adjusted(0.5, 0.5, -0.5, -0.5), 5, 5);
    painter.setFont(scaledFont(font(), 0.88));
    if (!hasHistogram_) {
        painter.setPen(tones.quiet);
        painter.drawText(rect(), Qt::AlignCenter, tr("Grey values appear when the scan is read"));
        return;
    }
    // Each zone in its tissue's colour.
    if (thresholds_) {
        const double x[5] = {area.left(), pixelOf(thresholds_->toothFrom), pixelOf(thresholds_->enamelFrom),
                             pixelOf(thresholds_->restorationFrom), area.right()};
        const QColor colours[4] = {Qt::transparent, tissueColour(cases::Tissue::dentine),
                                   tissueColour(cases::Tissue::enamel), tissueColour(cases::Tissue::restoration)};
        for (int zone = 1; zone < 4; ++zone) {
            QColor colour = colours[zone];
            colour.setAlphaF(isDark(palette()) ? 0.28f : 0.45f);
            painter.fillRect(QRectF(QPointF(x[zone], area.top()), QPointF(x[zone + 1], area.bottom())), colour);
        }
    }
    // Logarithmic: the pulp is a thousandth of the scan.
    double most = 1.0;
    for (const std::uint64_t count : histogram_.counts)
        most = std::max(most, std::log1p(static_cast<double>(count)));
    QPainterPath path(area.bottomLeft());
    const std::size_t bins = std::max<std::size_t>(1, histogram_.counts.size());
    for (std::size_t b = 0; b < histogram_.counts.size(); ++b)
        path.lineTo(area.left() + (static_cast<double>(b) + 0.5) / static_cast<double>(bins) * area.width(),
                    area.bottom() - area.height() * std::log1p(static_cast<double>(histogram_.counts[b])) / most);
    path.lineTo(area.bottomRight());
    path.closeSubpath();
    QColor fill = palette().color(QPalette::WindowText);
    fill.setAlphaF(0.35f);
    painter.setPen(QPen(palette().color(QPalette::WindowText), 1));
    painter.setBrush(fill);
    painter.drawPath(path);

    const double line = painter.fontMetrics().height();
    painter.setPen(tones.quiet);
    const QRectF below(area.left(), area.bottom() + 3, area.width(), line);
    painter.drawText(below, Qt::AlignLeft, QLocale().toString(histogram_.low, 'f', 0));
    painter.drawText(below, Qt::AlignRight, QLocale().toString(histogram_.high, 'f', 0));
    if (!thresholds_) return;
    painter.drawText(below, Qt::AlignHCenter, byHand_ ? tr("set by hand") : tr("found by the program"));

    double labelEnd = -1e9;
    for (int h = 0; h < handleCount; ++h) {
        const float value = valueOf(static_cast<Handle>(h));
        const double x = pixelOf(value);
        const bool active = h == held_ || (hasFocus() && h == chosen_);
        const QColor colour = active ? palette().color(QPalette::Highlight) : palette().color(QPalette::WindowText);
        painter.setPen(QPen(colour, active ? 2.5 : 1.5));
        painter.drawLine(QPointF(x, area.top()), QPointF(x, area.bottom()));
        painter.setBrush(colour);
        const QPointF grip[3] = {{x - 6, area.top() - 1}, {x + 6, area.top() - 1}, {x, area.top() + 8}};
        painter.setPen(Qt::NoPen);
        painter.drawPolygon(grip, 3);
        const QString text =
            std::isfinite(value) ? nameOf(h) + QLatin1Char(' ') + QLocale().toString(value, 'f', 0) : tr("no filling");
        const double wide = painter.fontMetrics().horizontalAdvance(text) + 4.0;
        const double left =
            std::max(labelEnd + 6, std::clamp(x - 0.5 * wide, 4.0, std::max(4.0, width() - wide - 4.0)));
        labelEnd = left + wide;
        if (labelEnd > width()) continue;  // the handles stand close: two labels are enough
        painter.setPen(colour);
        painter.drawText(QRectF(left, 3, wide, line), Qt::AlignCenter, text);
    }
}

void HistogramView::mousePressEvent(QMouseEvent* event) {
    if (!thresholds_ || event->button() != Qt::LeftButton) return;
    // The nearest; of two at one place the one that can go there.
    double nearest = kGrabPixels + 1;
    for (int h = 0; h < handleCount; ++h) {
        const double away = std::abs(event->position().x() - pixelOf(valueOf(static_cast<Handle>(h))));
        if (away < nearest) {
            nearest = away;
            held_ = chosen_ = h;
        }
    }
    update();
}

void HistogramView::mouseMoveEvent(QMouseEvent* event) {
    const double x = event->position().x();
    if (held_ >= 0) return move(static_cast<Handle>(held_), greyAt(x));
    bool near = false;
    for (int h = 0; thresholds_ && h < handleCount; ++h)
        near = near || std::abs(x - pixelOf(valueOf(static_cast<Handle>(h)))) < kGrabPixels;
    setCursor(near ? Qt::SplitHCursor : Qt::ArrowCursor);
}

void HistogramView::mouseReleaseEvent(QMouseEvent* event) {
    Q_UNUSED(event);
    if (held_ < 0) return;
    held_ = -1;
    emit dragEnded();
    update();
}

void HistogramView::keyPressEvent(QKeyEvent* event) {
    const float step = (histogram_.high - histogram_.low) / (event->modifiers() & Qt::ShiftModifier ? 20.0f : 200.0f);
    const auto handle = static_cast<Handle>(chosen_);
    switch (event->key()) {
        case Qt::Key_Up:
            chosen_ = (chosen_ + handleCount - 1) % handleCount;
            return update();
        case Qt::Key_Down:
            chosen_ = (chosen_ + 1) % handleCount;
            return update();
        case Qt::Key_Left:
            move(handle, std::min(valueOf(handle), histogram_.high) - step);
            emit dragEnded();
            return;
        case Qt::Key_Right:
            move(handle, std::min(valueOf(handle), histogram_.high) + step);
            emit dragEnded();
            return;
        default:
            QWidget::keyPressEvent(event);
    }
}

void HistogramView::focusInEvent(QFocusEvent* event) {
    update();
    QWidget::focusInEvent(event);
}
void HistogramView::focusOutEvent(QFocusEvent* event) {
    update();
    QWidget::focusOutEvent(event);
}

}  // namespace handpiece::desktop
