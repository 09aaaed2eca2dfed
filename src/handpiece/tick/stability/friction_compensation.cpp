// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/stability/friction_compensation.h"

#include <cmath>

namespace handpiece::stability {
namespace {

using core::Vec3;

constexpr double kVelocityTauS = 0.01;
/// One encoder step a filter time is the smallest motion that can be told from rest: the force saturates at thrice it.
constexpr double kSteps = 3.0, kMinMmS = 2.0;

}  // namespace

void FrictionCompensation::set(double frictionN, double share, double encoderStepMm) noexcept {
    forceN_ = share * frictionN;
    saturationMmS_ = std::fmax(kMinMmS, kSteps * encoderStepMm / kVelocityTauS);
}

Vec3 FrictionCompensation::force(const Vec3& positionMm, double periodS, bool fresh) noexcept {
    if (fresh) {
        velocity_.setZero();
    } else {
        velocity_ += periodS / (kVelocityTauS + periodS) * ((positionMm - last_) / periodS - velocity_);
    }
    last_ = positionMm;
    return forceN_ / std::sqrt(velocity_.squaredNorm() + saturationMmS_ * saturationMmS_) * velocity_;
}

}  // namespace handpiece::stability
