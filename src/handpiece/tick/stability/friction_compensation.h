// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What dry friction of the arm takes from the hand, given back in part.

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"

namespace handpiece::stability {

/// A force along the motion, share x friction x v / sqrt(v^2 + v0^2): nothing at rest, all of it well above v0. The
/// velocity is filtered, so that one encoder step is no push.
class FrictionCompensation {
  public:
    void set(double frictionN, double share, double encoderStepMm) noexcept;
    /// The force to add, at the position just read.
    [[nodiscard]] core::Vec3 force(const core::Vec3& positionMm, double periodS,
                                   bool fresh) noexcept HANDPIECE_REALTIME;

  private:
    double forceN_ = 0.0, saturationMmS_ = 1.0;
    core::Vec3 last_ = core::Vec3::Zero(), velocity_ = core::Vec3::Zero();
};

}  // namespace handpiece::stability
