// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/rate_hand.h"

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/rotation.h"

namespace handpiece::drivers {
namespace {

using core::Quat;
using core::Vec3;

constexpr double kMaxStepS = 0.05;

/// Nothing within the dead zone, then slowly at first: fine work is done near the middle.
Vec3 shaped(const Vec3& deflection, double deadZone) noexcept {
    Vec3 out = Vec3::Zero();
    for (int i = 0; i < 3; ++i) {
        const double size = std::abs(deflection[i]);
        if (!(size > deadZone)) continue;
        const double d = (std::min(size, 1.0) - deadZone) / (1.0 - deadZone);
        out[i] = std::copysign(d * (0.3 + 0.7 * d * d), deflection[i]);
    }
    return out;
}

}  // namespace

void RateHand::step(const Vec3& move, const Vec3& turn, bool goHome, double dtS) noexcept {
    const double dt = dtS > 0.0 ? std::min(dtS, kMaxStepS) : 0.0;
    if (goHome) {
        const double far = positionMm_.norm(), angle = core::angleBetween(orientation_, Quat::Identity());
        const double step = settings_.returnMmS * dt, bit = settings_.returnRadS * dt;
        positionMm_ = far > step ? Vec3(positionMm_ * (1.0 - step / far)) : Vec3(Vec3::Zero());
        orientation_ = angle > bit ? core::interpolated(orientation_, bit / angle, Quat::Identity()).normalized()
                                   : Quat::Identity();
        return;
    }
    positionMm_ += settings_.speedMmS * dt * shaped(move, settings_.deadZone);
    positionMm_ = positionMm_.cwiseMax(-settings_.reachMm).cwiseMin(settings_.reachMm);
    const Vec3 w = settings_.turnRadS * dt * shaped(turn, settings_.deadZone);
    if (w.isZero()) return;
    // About the axes of the room, as a cap is turned.
    const Quat next = (core::rotationAbout(w.normalized(), w.norm()) * orientation_).normalized();
    const double angle = core::angleBetween(next, Quat::Identity());
    orientation_ = angle > settings_.mostTurnRad
                       ? core::interpolated(Quat::Identity(), settings_.mostTurnRad / angle, next)
                       : next;
}

void RateHand::tell(link::DriverReading& reading) const noexcept {
    reading.positionMm = core::toArray(positionMm_);
    reading.orientation = {orientation_.w(), orientation_.x(), orientation_.y(), orientation_.z()};
}

}  // namespace handpiece::drivers
