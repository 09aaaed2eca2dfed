// SPDX-License-Identifier: Apache-2.0
#include "desktop/widgets/force_gauge.h"

#include <QLocale>
#include <QPainter>
#include <QPainterPath>
#include <algorithm>
#include <cmath>

#include "desktop/widgets/parts.h"
#include "desktop/widgets/press_words.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

namespace {

constexpr double kHoldS = 2.0;

}  // namespace

ForceGauge::ForceGauge(QWidget* parent) : QWidget(parent) {
    setObjectName("forceGauge");
    setAccessibleName(tr("How hard the bur presses"));
    setToolTip(tr("How hard the bur presses. The line is the highest of the last two seconds."));
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
}

void ForceGauge::setLimit(double limitN) {
    limitN_ = std::max(0.01, limitN);
    update();
}

void ForceGauge::setPressLimits(const instrument::PressLimits& limits) {
    press_ = limits;
    update();
}

void ForceGauge::setForce(double forceN, double timeS, bool limited) {
    forceN_ = std::isfinite(forceN) ? std::max(0.0, forceN) : 0.0;
    limited_ = limited;
    if (forceN_ >= peakN_ || timeS - peakTimeS_ > kHoldS || timeS < peakTimeS_) {
        peakN_ = forceN_;
        peakTimeS_ = timeS;
    }
    setAccessibleDescription(detail_ == Detail::practice ? words() : words() + ", " + quantity(forceN_, 2, tr("N")));
    update();
}

void ForceGauge::setDetail(Detail detail) {
    detail_ = detail;
    update();
}

void ForceGauge::setHeadingShown(bool shown) {
    headingShown_ = shown;
    update();
}

ForceGauge::Zone ForceGauge::zone() const {
    return limited_ || forceN_ >= press_.hardN ? Zone::hard : forceN_ >= press_.firmN ? Zone::firm : Zone::gentle;
}

QString ForceGauge::words() const {
    if (limited_) return detail_ == Detail::practice ? tr("More than the device gives") : tr("At the limit");
    return pressWords(forceN_, press_);
}

QSize ForceGauge::sizeHint() const {
    return {220, minimumSizeHint().height()};
}
QSize ForceGauge::minimumSizeHint() const {
    return {140, 24 + 2 * fontMetrics().height()};
}

void ForceGauge::paintEvent(QPaintEvent* event) {
    Q_UNUSED(event);
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const Tones tones = tonesOf(palette());
    const double line = QFontMetricsF(font()).height();
    const QColor colours[] = {tones.good, tones.caution, tones.bad};
    const QColor colour = colours[static_cast<int>(zone())];

    const QRectF textRow(2, 1, width() - 4.0, line);
    painter.setPen(palette().color(QPalette::WindowText));
    if (headingShown_)
        painter.drawText(textRow, Qt::AlignLeft | Qt::AlignVCenter,
                         detail_ == Detail::practice ? tr("Pressure") : tr("Force"));
    painter.setPen(colour);
    painter.setFont(scaledFont(font(), 1.0, true));
    painter.drawText(
        textRow, (headingShown_ ? Qt::AlignRight : Qt::AlignLeft) | Qt::AlignVCenter,
        detail_ == Detail::practice ? words() : words() + QStringLiteral("  ") + quantity(forceN_, 2, tr("N")));

    const QRectF bar(2, line + 5, width() - 4.0, 13);
    const auto xOf = [&](double n) { return bar.left() + bar.width() * std::clamp(n / limitN_, 0.0, 1.0); };
    QPainterPath round;
    round.addRoundedRect(bar, 4, 4);
    painter.save();
    painter.setClipPath(round);
    painter.fillRect(bar, tones.line);
    // The zones show faintly, so that one sees where it gets hard.
    const double edges[] = {0.0, press_.firmN, press_.hardN, std::max(press_.hardN, limitN_)};
    for (int i = 0; i < 3; ++i) {
        QColor faint = colours[i];
        faint.setAlphaF(0.22f);
        painter.fillRect(QRectF(QPointF(xOf(edges[i]), bar.top()), QPointF(xOf(edges[i + 1]), bar.bottom())), faint);
    }
    painter.fillRect(QRectF(bar.topLeft(), QPointF(xOf(forceN_), bar.bottom())), colour);
    painter.restore();
    if (peakN_ > 0) {
        const double x = std::clamp(xOf(peakN_), bar.left() + 1.5, bar.right() - 1.5);
        painter.setPen(QPen(palette().color(QPalette::WindowText), 2));
        painter.drawLine(QPointF(x, bar.top() - 2), QPointF(x, bar.bottom() + 2));
    }
    if (detail_ == Detail::practice) return;
    painter.setFont(scaledFont(font(), 0.85));
    painter.setPen(tones.quiet);
    const QRectF under(2, bar.bottom() + 2, width() - 4.0, line);
    painter.drawText(under, Qt::AlignLeft | Qt::AlignTop, tr("peak %1").arg(quantity(peakN_, 2, tr("N"))));
    painter.drawText(under, Qt::AlignRight | Qt::AlignTop, tr("limit %1").arg(quantity(limitN_, 2, tr("N"))));
}

}  // namespace handpiece::desktop
