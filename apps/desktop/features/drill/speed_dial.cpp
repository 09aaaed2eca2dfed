// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/drill/speed_dial.h"

#include <QLocale>
#include <QPainter>
#include <QPainterPath>
#include <cmath>

#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

namespace {

constexpr double kStartDeg = 220, kSweepDeg = 260;

}  // namespace

SpeedDial::SpeedDial(QWidget* parent) : QWidget(parent) {
    setObjectName("speedDial");
    setAccessibleName(tr("Speed of the bur now"));
    setToolTip(tr("Speed of the bur now. The mark on the rim is the speed that is set."));
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
}

void SpeedDial::setFreeSpeed(double rpm) {
    freeRpm_ = std::max(1.0, rpm);
    update();
}

void SpeedDial::setSetSpeed(double rpm) {
    setRpm_ = rpm;
    update();
}

void SpeedDial::setSpeed(double rpm, bool stalled) {
    // A change nobody can see costs no drawing.
    if (stalled == stalled_ && std::abs(rpm - rpm_) < freeRpm_ * 5e-4 && !(rpm == 0 && rpm_ != 0)) return;
    rpm_ = rpm;
    stalled_ = stalled;
    setAccessibleDescription(tr("%1 rpm").arg(rpmText(rpm_)));
    update();
}

QSize SpeedDial::sizeHint() const {
    return {190, 150};
}
QSize SpeedDial::minimumSizeHint() const {
    return {130, 120};
}

void SpeedDial::paintEvent(QPaintEvent* event) {
    Q_UNUSED(event);
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const Tones tones = tonesOf(palette());
    const QColor textColour = palette().color(QPalette::WindowText), accent = palette().color(QPalette::Highlight);
    const double radius = std::min(width() / 2.0 - 8, height() / 1.78 - 6);
    const QPointF centre(width() / 2.0, radius + 7);
    const QRectF rim(centre.x() - radius, centre.y() - radius, 2 * radius, 2 * radius);
    const auto angleOf = [this](double rpm) { return kStartDeg - kSweepDeg * std::clamp(rpm / freeRpm_, 0.0, 1.0); };
    const auto at = [&centre](double angleDeg, double r) {
        const double a = angleDeg * M_PI / 180;
        return centre + QPointF(r * std::cos(a), -r * std::sin(a));
    };
    const double thick = std::max(6.0, radius * 0.11);
    const QRectF band = rim.adjusted(thick / 2, thick / 2, -thick / 2, -thick / 2);
    painter.setPen(QPen(tones.line, thick, Qt::SolidLine, Qt::FlatCap));
    painter.drawArc(band, qRound(16 * (kStartDeg - kSweepDeg)), qRound(16 * kSweepDeg));
    const QColor live = stalled_ ? tones.bad : accent;
    const double sweep = kStartDeg - angleOf(rpm_);
    if (sweep > 0.05) {
        painter.setPen(QPen(live, thick, Qt::SolidLine, Qt::FlatCap));
        painter.drawArc(band, qRound(16 * angleOf(rpm_)), qRound(16 * sweep));
    }
    // Scale: thousands.
    painter.setFont(scaledFont(font(), 0.74));
    const QFontMetricsF metrics(painter.font());
    const double step = niceStep(freeRpm_, 5);
    for (double rpm = 0; rpm <= freeRpm_ * 1.001; rpm += step) {
        const double angle = angleOf(rpm);
        painter.setPen(QPen(tones.quiet, 1.2));
        painter.drawLine(at(angle, radius - thick - 2), at(angle, radius - thick - 6));
        const QString label = QLocale().toString(rpm / 1000.0, 'g', 3);
        const QPointF place = at(angle, radius - thick - 8 - metrics.height() * 0.75);
        painter.drawText(QRectF(place.x() - 30, place.y() - 10, 60, 20), Qt::AlignCenter, label);
    }
    // The set speed: a wedge outside the rim.
    const double set = angleOf(setRpm_);
    QPainterPath wedge;
    wedge.moveTo(at(set, radius - thick * 0.55));
    wedge.lineTo(at(set - 4.5, radius + 5));
    wedge.lineTo(at(set + 4.5, radius + 5));
    wedge.closeSubpath();
    painter.setPen(QPen(palette().color(QPalette::Window), 1.2));
    painter.setBrush(textColour);
    painter.drawPath(wedge);
    // Number.
    painter.setPen(stalled_ ? tones.bad : textColour);
    painter.setFont(scaledFont(font(), 1.75, true));
    const double big = QFontMetricsF(painter.font()).height();
    painter.drawText(QRectF(0, centre.y() - big * 0.62, width(), big), Qt::AlignCenter, rpmText(rpm_));
    painter.setPen(tones.quiet);
    painter.setFont(scaledFont(font(), 0.8));
    painter.drawText(QRectF(0, centre.y() + big * 0.36, width(), 18), Qt::AlignCenter, tr("rpm"));
    painter.drawText(QRectF(0, centre.y() + radius * 0.66, width(), 18), Qt::AlignCenter, tr("× 1000"));
}

}  // namespace handpiece::desktop
