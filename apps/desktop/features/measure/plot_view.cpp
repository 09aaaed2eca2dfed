// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/measure/plot_view.h"

#include <QEvent>
#include <QKeyEvent>
#include <QLocale>
#include <QMouseEvent>
#include <QPainter>
#include <algorithm>
#include <cmath>

#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

namespace {

constexpr double kLeft = 58, kRight = 10, kTop = 20, kBottom = 22, kGap = 24;

}  // namespace

PlotView::PlotView(QWidget* parent) : QWidget(parent) {
    setObjectName("plotView");
    setAccessibleName(tr("Force, depth and speed of the last 20 seconds"));
    setMouseTracking(true);
    setFocusPolicy(Qt::StrongFocus);
    setAttribute(Qt::WA_OpaquePaintEvent);
    fitAxes();
}

void PlotView::append(const std::vector<simulation::PlotPoint>& points) {
    if (points.empty()) return;
    for (const auto& point : points) {
        if (!points_.empty() && point.timeS < points_.back().timeS) {
            points_.clear();
            marks_.clear();
        }
        points_.push_back(point);
    }
    const double oldest = points_.back().timeS - PlotPanel::kSpanS;
    while (points_.size() > 2 && points_[1].timeS < oldest)
        points_.pop_front();
    if (!paused_) {
        std::erase_if(marks_, [oldest](const Mark& mark) { return mark.timeS < oldest; });
        fitAxes();
        if (isVisible()) update();
    }
}

void PlotView::addMark(double timeS, const QString& label) {
    marks_.push_back({timeS, label});
    update();
}

void PlotView::clear() {
    points_.clear();
    frozen_.clear();
    marks_.clear();
    fitAxes();
    update();
}

void PlotView::setForceLimit(double limitN) {
    limitN_ = std::max(0.0, limitN);
    fitAxes();
    update();
}

void PlotView::setFreeSpeed(double rpm) {
    freeRpm_ = std::max(1.0, rpm);
    fitAxes();
    update();
}

void PlotView::setPaused(bool paused) {
    if (paused == paused_) return;
    if (paused) frozen_ = points_;
    paused_ = paused;
    if (!paused) frozen_.clear();
    fitAxes();
    update();
}

void PlotView::setPractice(bool practice) {
    practice_ = practice;
    axesPicture_ = {};
    update();
}

double PlotView::valueOf(const simulation::PlotPoint& point, int plot) {
    const float value = plot == 0 ? point.forceN : plot == 1 ? point.depthMm : point.speedRpm;
    return std::isfinite(value) ? value : 0.0;
}

double PlotView::endS() const {
    const auto& shown = points();
    return shown.empty() ? PlotPanel::kSpanS : std::max(shown.back().timeS, PlotPanel::kSpanS);
}

void PlotView::fitAxes() {
    Axis fitted[kPlots];
    double mostForce = std::max(1.0, limitN_ * 1.12), mostDepth = 0.2;
    for (const auto& point : points()) {
        mostForce = std::max(mostForce, valueOf(point, 0) * 1.05);
        mostDepth = std::max(mostDepth, valueOf(point, 1) * 1.1);
    }
    const double most[] = {mostForce, mostDepth, freeRpm_ * 1.05};
    bool changed = false;
    for (int i = 0; i < kPlots; ++i) {
        const double step = niceStep(most[i], 4);
        fitted[i] = {0.0, i == 1 ? std::ceil(most[i] / step - 1e-9) * step : most[i], step};
        changed |= fitted[i].most != axes_[i].most || fitted[i].step != axes_[i].step;
        axes_[i] = fitted[i];
    }
    if (changed) axesPicture_ = {};
}

QRectF PlotView::frameOf(int plot, const QSize& size) const {
    const double height = (size.height() - kTop - kBottom - kGap * (kPlots - 1)) / kPlots;
    return {kLeft, kTop + plot * (height + kGap), std::max(20.0, size.width() - kLeft - kRight),
            std::max(10.0, height)};
}

QPolygonF PlotView::curve(int plot, const QRectF& frame) const {
    QPolygonF line;
    const auto& shown = points();
    if (shown.empty()) return line;
    const double startS = endS() - PlotPanel::kSpanS, perS = frame.width() / PlotPanel::kSpanS;
    const Axis& axis = axes_[plot];
    const double perUnit = frame.height() / (axis.most - axis.least);
    const auto yOf = [&](double value) {
        return frame.bottom() - (std::clamp(value, axis.least, axis.most) - axis.least) * perUnit;
    };
    line.reserve(static_cast<qsizetype>(frame.width()) * 2 + 8);
    int column = -1;
    double least = 0, most = 0, leastX = 0, mostX = 0;
    const auto flush = [&] {
        if (column < 0) return;
        if (leastX <= mostX) {
            line << QPointF(leastX, yOf(least));
            if (most != least) line << QPointF(mostX, yOf(most));
        } else {
            line << QPointF(mostX, yOf(most)) << QPointF(leastX, yOf(least));
        }
    };
    for (const auto& point : shown) {
        if (point.timeS < startS) continue;
        const double x = frame.left() + (point.timeS - startS) * perS;
        // A slow picture is no reason to lose a dip of the speed.
        const double value = valueOf(point, plot);
        const double low = plot == 2 && std::isfinite(point.leastRpm) ? std::min<double>(value, point.leastRpm) : value;
        const int c = static_cast<int>(x);
        if (c != column) {
            flush();
            column = c;
            least = low;
            most = value;
            leastX = mostX = x;
            continue;
        }
        if (low < least) {
            least = low;
            leastX = x;
        }
        if (value > most) {
            most = value;
            mostX = x;
        }
    }
    flush();
    return line;
}

double PlotView::largestDrawn(int plot) const {
    const QRectF frame = frameOf(plot, size());
    double top = frame.bottom();
    for (const QPointF& p : curve(plot, frame))
        top = std::min(top, p.y());
    return axes_[plot].least + (frame.bottom() - top) / frame.height() * (axes_[plot].most - axes_[plot].least);
}

void PlotView::drawAxes(QPainter& painter, const QSize& size) const {
    const Tones tones = tonesOf(palette());
    painter.fillRect(QRect(QPoint(), size), palette().color(QPalette::Base));
    const QString titles[] = {practice_ ? tr("Pressure") : tr("Force [N]"), tr("Depth [mm]"),
                              practice_ ? tr("Speed [1000 rpm]") : tr("Rotor speed [1000 rpm]")};
    const QColor colours[] = {tones.force, tones.depth, tones.speed};
    const QFont small = scaledFont(font(), 0.85), bold = scaledFont(font(), 0.88, true);
    for (int plot = 0; plot < kPlots; ++plot) {
        const QRectF frame = frameOf(plot, size);
        const Axis& axis = axes_[plot];
        painter.setRenderHint(QPainter::Antialiasing, false);
        painter.setFont(small);
        const double unit = plot == 2 ? 1e-3 : 1.0;
        for (double value = axis.least; value <= axis.most * 1.0001; value += axis.step) {
            const double y =
                std::round(frame.bottom() - (value - axis.least) / (axis.most - axis.least) * frame.height());
            painter.setPen(QPen(tones.line, 1));
            painter.drawLine(QPointF(frame.left(), y), QPointF(frame.right(), y));
            painter.setPen(tones.quiet);
            painter.drawText(QRectF(0, y - 9, kLeft - 7, 18), Qt::AlignRight | Qt::AlignVCenter,
                             QLocale().toString(value * unit, 'g', 4));
        }
        painter.setPen(QPen(mixed(tones.line, tones.quiet, 0.5), 1));
        painter.drawLine(frame.bottomLeft(), frame.bottomRight());
        painter.drawLine(frame.topLeft(), frame.bottomLeft());
        for (int s = 0; s <= static_cast<int>(PlotPanel::kSpanS); s += 5) {
            const double x = std::round(frame.left() + s / PlotPanel::kSpanS * frame.width());
            painter.drawLine(QPointF(x, frame.bottom()), QPointF(x, frame.bottom() + 4));
        }
        painter.setRenderHint(QPainter::Antialiasing);
        painter.setFont(bold);
        painter.setPen(colours[plot]);
        painter.drawText(QRectF(frame.left(), frame.top() - 18, frame.width(), 17), Qt::AlignLeft | Qt::AlignVCenter,
                         titles[plot]);
        if (plot == 0 && limitN_ > 0) {
            const double y = frame.bottom() - limitN_ / (axis.most - axis.least) * frame.height();
            painter.setPen(QPen(tones.bad, 1.2, Qt::DashLine));
            painter.drawLine(QPointF(frame.left(), y), QPointF(frame.right(), y));
            painter.setFont(small);
            painter.setPen(tones.bad);
            painter.drawText(QRectF(frame.left(), frame.top() - 18, frame.width(), 17),
                             Qt::AlignRight | Qt::AlignVCenter,
                             practice_ ? tr("the device gives no more")
                                       : tr("device's limit %1 N").arg(QLocale().toString(limitN_, 'g', 3)));
        }
    }
    const QRectF last = frameOf(kPlots - 1, size);
    painter.setFont(small);
    painter.setPen(tones.quiet);
    for (int s = 0; s <= static_cast<int>(PlotPanel::kSpanS); s += 5) {
        const double x = last.left() + s / PlotPanel::kSpanS * last.width();
        const bool end = s == static_cast<int>(PlotPanel::kSpanS);
        const QString label = end ? tr("now") : tr("%1 s").arg(QLocale().toString(s - PlotPanel::kSpanS, 'f', 0));
        painter.drawText(QRectF(end ? x - 60 + kRight - 2 : x - 30, last.bottom() + 4, 60, 17),
                         (end ? Qt::AlignRight : Qt::AlignHCenter) | Qt::AlignTop, label);
    }
}

void PlotView::drawCurves(QPainter& painter, const QSize& size, bool live) const {
    const Tones tones = tonesOf(palette());
    const QColor colours[] = {tones.force, tones.depth, tones.speed};
    const double startS = endS() - PlotPanel::kSpanS;
    const auto xOf = [&](const QRectF& frame, double timeS) {
        return frame.left() + (timeS - startS) / PlotPanel::kSpanS * frame.width();
    };
    const QRectF first = frameOf(0, size), last = frameOf(kPlots - 1, size);
    painter.setFont(scaledFont(font(), 0.8));
    const QFontMetricsF metrics(painter.font());
    double freeFrom = -1e9;
    for (const Mark& mark : marks_) {
        if (mark.timeS < startS || mark.timeS > endS()) continue;
        const double x = std::round(xOf(first, mark.timeS));
        painter.setRenderHint(QPainter::Antialiasing, false);
        painter.setPen(QPen(tones.quiet, 1, Qt::DotLine));
        painter.drawLine(QPointF(x, first.top()), QPointF(x, last.bottom()));
        const double width = metrics.horizontalAdvance(mark.label) + 6;
        if (x > freeFrom) {  // labels that would lie over each other are left to the hover
            const double left = std::min(x + 3, first.right() - width);
            painter.setPen(tones.quiet);
            painter.drawText(QRectF(left, first.top() + 1, width, metrics.height()), Qt::AlignLeft, mark.label);
            freeFrom = left + width;
        }
    }
    for (int plot = 0; plot < kPlots; ++plot) {
        const QRectF frame = frameOf(plot, size);
        const QPolygonF line = curve(plot, frame);
        painter.setRenderHint(QPainter::Antialiasing);
        painter.setPen(QPen(colours[plot], live ? 1.2 : 1.4, Qt::SolidLine, Qt::FlatCap));
        if (!live) {
            painter.drawPolyline(line);
            continue;
        }
        // Line by line: joining a thousand corners takes Qt twenty times as long.
        QList<QLineF> pieces;
        pieces.reserve(line.size());
        for (qsizetype i = 1; i < line.size(); ++i)
            pieces << QLineF(line[i - 1], line[i]);
        painter.drawLines(pieces);
    }
    if (hoverS_ >= startS && hoverS_ <= endS()) {
        const double x = std::round(xOf(first, hoverS_));
        painter.setRenderHint(QPainter::Antialiasing, false);
        painter.setPen(QPen(palette().color(QPalette::Text), 1));
        painter.drawLine(QPointF(x, first.top()), QPointF(x, last.bottom()));
    }
}

void PlotView::draw(QPainter& painter, const QSize& size) const {
    drawAxes(painter, size);
    drawCurves(painter, size, false);
}

void PlotView::paintEvent(QPaintEvent* event) {
    Q_UNUSED(event);
    const double ratio = devicePixelRatioF();
    if (axesPicture_.isNull()) {
        axesPicture_ = QPixmap(size() * ratio);
        axesPicture_.setDevicePixelRatio(ratio);
        QPainter painter(&axesPicture_);
        drawAxes(painter, size());
    }
    QPainter painter(this);
    painter.drawPixmap(0, 0, axesPicture_);
    drawCurves(painter, size(), true);
}

void PlotView::resizeEvent(QResizeEvent* event) {
    axesPicture_ = {};
    QWidget::resizeEvent(event);
}

void PlotView::changeEvent(QEvent* event) {
    if (event->type() == QEvent::PaletteChange || event->type() == QEvent::FontChange ||
        event->type() == QEvent::LanguageChange)
        axesPicture_ = {};
    QWidget::changeEvent(event);
}

void PlotView::setHover(double timeS) {
    hoverS_ = timeS;
    update();
    const auto& shown = points();
    if (timeS < 0 || shown.empty()) {
        emit hovered({});
        return;
    }
    auto at = std::lower_bound(shown.begin(), shown.end(), timeS,
                               [](const simulation::PlotPoint& point, double t) { return point.timeS < t; });
    if (at == shown.end()) --at;
    QString text = practice_ ? tr("%1 s: depth %2 mm, %3 rpm")
                                   .arg(QLocale().toString(at->timeS, 'f', 2), QLocale().toString(at->depthMm, 'f', 2),
                                        rpmText(at->speedRpm))
                             : tr("%1 s: %2 N, %3 mm, %4 rpm")
                                   .arg(QLocale().toString(at->timeS, 'f', 2), QLocale().toString(at->forceN, 'f', 2),
                                        QLocale().toString(at->depthMm, 'f', 3), rpmText(at->speedRpm));
    for (const Mark& mark : marks_)
        if (std::abs(mark.timeS - timeS) < PlotPanel::kSpanS / std::max(50, width()) * 4)
            text += QStringLiteral(" — ") + mark.label;
    emit hovered(text);
}

void PlotView::mouseMoveEvent(QMouseEvent* event) {
    const QRectF frame = frameOf(0, size());
    const double share = (event->position().x() - frame.left()) / frame.width();
    setHover(share < 0 || share > 1 ? -1 : endS() - PlotPanel::kSpanS * (1 - share));
}

void PlotView::leaveEvent(QEvent* event) {
    setHover(-1);
    QWidget::leaveEvent(event);
}

void PlotView::keyPressEvent(QKeyEvent* event) {
    // The readout by keyboard: left and right move it, a tenth of a second or (with Shift) a second.
    const double step = event->modifiers().testFlag(Qt::ShiftModifier) ? 1.0 : 0.1;
    const double from = hoverS_ < 0 ? endS() : hoverS_;
    if (event->key() == Qt::Key_Left)
        setHover(std::max(endS() - PlotPanel::kSpanS, from - step));
    else if (event->key() == Qt::Key_Right)
        setHover(std::min(endS(), from + step));
    else
        QWidget::keyPressEvent(event);
}

}  // namespace handpiece::desktop
