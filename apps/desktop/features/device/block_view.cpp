// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/device/block_view.h"

#include <QPainter>
#include <cmath>

#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"
#include "handpiece/base/core/vec.h"

namespace handpiece::desktop {
namespace {

constexpr double kAboveMm = 9.0, kBesideMm = 3.0, kShankMm = 9.0, kForceMmPerN = 3.0;

}  // namespace

BlockView::BlockView(double halfMm, double depthMm, QWidget* parent)
    : QWidget(parent), halfMm_(halfMm), depthMm_(depthMm) {
    named(this, "feelPicture", tr("The block and the bur"),
          tr("The block from the side, the bur where it rests, and the force on the hand as a line"));
}

void BlockView::setSample(const messages::HapticSample& sample) {
    sample_ = sample;
    setAccessibleDescription(sample.depthMm > 0.0 ? tr("touching") : tr("in the air"));
    update();
}

void BlockView::paintEvent(QPaintEvent* /*event*/) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const Tones tones = tonesOf(palette());
    const double scale =
        std::min(width() / (2.0 * (halfMm_ + kBesideMm)), height() / (kAboveMm + depthMm_ + 0.5 * kBesideMm));
    const QPointF origin(width() / 2.0, scale * kAboveMm);
    const auto at = [&](double x, double z) { return origin + QPointF(scale * x, -scale * z); };
    painter.setPen(QPen(tones.line, 1.5));
    painter.setBrush(mixed(palette().color(QPalette::Base), tones.quiet, 0.18));
    painter.drawRect(QRectF(at(-halfMm_, 0.0), at(halfMm_, -depthMm_)));
    if (sample_.tick == 0) return;
    const auto& q = sample_.proxyOrientation;
    const core::Vec3 shank = kShankMm * (core::Quat(q[0], q[1], q[2], q[3]) * core::Vec3::UnitZ());
    const double x = sample_.proxyPositionMm[0], z = sample_.proxyPositionMm[2];
    painter.setPen(
        QPen(palette().color(QPalette::WindowText), std::max(3.0, 0.9 * scale), Qt::SolidLine, Qt::RoundCap));
    painter.drawLine(at(x, z + 0.5), at(x + shank.x(), z + 0.5 + shank.z()));
    if (std::hypot(sample_.forceN[0], sample_.forceN[2]) > 0.02) {
        painter.setPen(QPen(tones.force, 3, Qt::SolidLine, Qt::RoundCap));
        painter.drawLine(at(x, z), at(x + kForceMmPerN * sample_.forceN[0], z + kForceMmPerN * sample_.forceN[2]));
    }
}

}  // namespace handpiece::desktop
