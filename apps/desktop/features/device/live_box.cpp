// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/device/live_box.h"

#include <QGridLayout>
#include <QLabel>
#include <QLocale>
#include <QPainter>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "desktop/widgets/force_gauge.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"
#include "handpiece/base/config/words.h"

namespace handpiece::desktop {
namespace {

constexpr double kStylusMm = 40.0;

double lengthOf(const std::array<double, 3>& v) {
    return std::hypot(v[0], v[1], v[2]);
}

}  // namespace

ReachPicture::ReachPicture(QWidget* parent) : QWidget(parent) {
    named(this, "deviceReach", tr("The stylus in the device's reach"),
          tr("The stylus in the device's reach: from the front on the left, from above on the right"));
}

void ReachPicture::setReach(const core::Vec3& sizeMm) {
    sizeMm_ = sizeMm.cwiseMax(10.0);
    update();
}

void ReachPicture::setStylus(const std::array<double, 3>& positionMm, const std::array<double, 4>& orientation) {
    atMm_ = {positionMm[0], positionMm[1], positionMm[2]};
    const core::Quat turn(orientation[0], orientation[1], orientation[2], orientation[3]);
    tailMm_ = atMm_ + kStylusMm * (turn * core::Vec3::UnitZ());
    update();
}

void ReachPicture::paintEvent(QPaintEvent* /*event*/) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const Tones tones = tonesOf(palette());
    const double half = width() / 2.0;
    for (int side = 0; side < 2; ++side) {
        // Front: x to the right, y up. Above: x to the right, z down, to the user.
        const int up = side == 0 ? 1 : 2;
        const double sign = side == 0 ? -1.0 : 1.0;
        const QRectF room(side * half + 6, 6, half - 12, height() - 12 - fontMetrics().height());
        const double scale = std::min(room.width() / (1.3 * sizeMm_.x()), room.height() / (1.3 * sizeMm_[up]));
        const auto at = [&](const core::Vec3& p) {
            return room.center() + QPointF(scale * p.x(), sign * scale * p[up]);
        };
        painter.setPen(QPen(tones.line, 1.5));
        painter.drawRect(QRectF(room.center() - QPointF(scale * sizeMm_.x() / 2, scale * sizeMm_[up] / 2),
                                QSizeF(scale * sizeMm_.x(), scale * sizeMm_[up])));
        painter.setClipRect(room.adjusted(-4, -4, 4, 4));
        painter.setPen(QPen(palette().color(QPalette::WindowText), 3, Qt::SolidLine, Qt::RoundCap));
        painter.drawLine(at(atMm_), at(tailMm_));
        painter.setPen(Qt::NoPen);
        painter.setBrush(tones.force);
        painter.drawEllipse(at(atMm_), 5, 5);
        painter.setBrush(Qt::NoBrush);
        painter.setClipping(false);
        painter.setPen(tones.quiet);
        painter.drawText(QRectF(side * half, height() - fontMetrics().height() - 2, half, fontMetrics().height()),
                         Qt::AlignCenter, side == 0 ? tr("From the front") : tr("From above"));
    }
}

LiveBox::LiveBox(QWidget* parent) : QWidget(parent) {
    setObjectName(QStringLiteral("deviceLive"));
    setAccessibleName(tr("How the device is doing"));
    auto* column = new QVBoxLayout(this);
    column->addWidget(reach_ = new ReachPicture(this));
    gauge_ = new ForceGauge(this);
    gauge_->setObjectName(QStringLiteral("deviceForce"));
    gauge_->setAccessibleName(tr("Force on the hand"));
    gauge_->setToolTip(tr("What the device pushes the hand with. The line is the highest of the last two seconds."));
    gauge_->setDetail(Detail::laboratory);
    column->addWidget(gauge_);
    auto* grid = new QGridLayout;
    grid->setColumnStretch(1, 1);
    column->addLayout(grid);
    column->addStretch(1);
    model_ = row(grid, "deviceModel", tr("Device"), tr("As its maker calls it, and the version of its software"));
    pose_ = row(grid, "devicePose", tr("Place"), tr("Of the stylus: to the right, up, and to the user"));
    buttons_ = row(grid, "deviceButtons", tr("Buttons"), tr("The upper one cuts; the lower one, held, undoes"));
    force_ = row(grid, "deviceForceText", tr("Force sent"), tr("To the right, up, and to the user; after all limits"));
    temperature_ = row(grid, "deviceTemperature", tr("Motors"),
                       tr("Warmth as the device tells it, and as the thermal budget counts it"));
    servo_ = row(grid, "deviceServo", tr("Servo"), tr("How often the device's own loop asks for a force"));
    late_ = row(grid, "deviceLate", tr("Lateness"), tr("How late the force loop begins, of 100 ticks the latest"));
    scheduling_ = row(grid, "deviceScheduling", tr("Real time"),
                      tr("What the machine grants the force loop: without real time some ticks come late"));
    energy_ = row(grid, "deviceEnergy", tr("Passivity"), tr("How often the controller had to take energy out"));
    trouble_ = row(grid, "deviceTrouble", tr("Trouble"), tr("Why it gives no force"));
    clear();
}

QLabel* LiveBox::row(QGridLayout* grid, const char* object, const QString& name, const QString& tip) {
    const int at = grid->rowCount();
    auto* title = new QuietLabel(name, this);
    title->setToolTip(tip);
    grid->addWidget(title, at, 0, Qt::AlignTop);
    auto* value = named(new QLabel(this), object, name, tip);
    value->setWordWrap(true);
    value->setTextInteractionFlags(Qt::TextSelectableByMouse);
    grid->addWidget(value, at, 1);
    return value;
}

void LiveBox::setDevice(const link::DriverInfo& info) {
    info_ = info;
    QStringList parts{QString::fromStdString(info.model)};
    for (const std::string& part : {info.serial, info.version})
        if (!part.empty()) parts << QString::fromStdString(part);
    model_->setText(parts.join(QStringLiteral(" · ")));
    reach_->setReach(info.capability.workspaceMm);
    gauge_->setLimit(info.capability.maxForceN);
    gauge_->setVisible(info.pushes);
}

void LiveBox::setHealth(const safety::Health& health, const QString& trouble) {
    const QLocale locale;
    const auto three = [&locale](const std::array<double, 3>& v, int decimals, const QString& unit) {
        QStringList parts;
        for (const double part : v)
            parts << locale.toString(part, 'f', decimals);
        return parts.join(QStringLiteral("  ")) + QLatin1Char(' ') + unit;
    };
    reach_->setStylus(health.positionMm, health.orientation);
    pose_->setText(three(health.positionMm, 1, tr("mm")));
    QStringList down;
    if ((health.buttons & 1u) != 0) down << tr("upper");
    if ((health.buttons & 2u) != 0) down << tr("lower");
    for (int bit = 2; bit < 32; ++bit)
        if ((health.buttons >> bit & 1u) != 0) down << tr("number %1").arg(bit + 1);
    if (health.clutched) down << tr("clutch held");
    buttons_->setText(down.isEmpty() ? tr("none pressed") : down.join(QStringLiteral(", ")));
    force_->setText(info_.pushes ? three(health.sentN, 2, tr("N")) : tr("gives no force"));
    timeS_ += 1.0 / 30.0;
    gauge_->setForce(lengthOf(health.sentN), timeS_, health.gate.clamped);
    const auto percent = [&locale](double share) { return locale.toString(100.0 * share, 'f', 0); };
    temperature_->setText(
        health.gate.motorTemperature >= 0.0f
            ? tr("%1 % of what is allowed; budget %2 % used")
                  .arg(percent(static_cast<double>(health.gate.motorTemperature)), percent(health.shaping.heat))
            : tr("not told; budget %1 % used").arg(percent(health.shaping.heat)));
    servo_->setText(tr("%1 Hz (%2 by design), frames: %3")
                        .arg(locale.toString(health.servoHz, 'f', 0), locale.toString(info_.servoHz, 'f', 0),
                             locale.toString(qulonglong{health.frames})));
    energy_->setText(tr("controller engaged in ticks: %1").arg(locale.toString(qulonglong{health.shaping.engaged})));
    trouble_->setText(trouble.isEmpty() ? tr("none") : trouble);
    QPalette tinted = palette();
    if (!trouble.isEmpty()) tinted.setColor(QPalette::WindowText, tonesOf(tinted).bad);
    trouble_->setPalette(tinted);
}

void LiveBox::setTick(const simulation::LiveSessionStatus& status) {
    const QLocale locale;
    late_->setText(tr("p99 %1 µs; late ticks: %2, missed: %3")
                       .arg(locale.toString(status.latenessUs.p99, 'f', 0),
                            locale.toString(qulonglong{status.lateTicks}),
                            locale.toString(qulonglong{status.missedPeriods})));
    scheduling_->setText(QString::fromStdString(status.scheduling.text()));
}

void LiveBox::clear() {
    for (QLabel* label : {pose_, buttons_, force_, temperature_, servo_, late_, scheduling_, energy_, trouble_})
        label->setText(QStringLiteral("-"));
    model_->setText(tr("Mouse and keyboard"));
    gauge_->hide();
}

}  // namespace handpiece::desktop
