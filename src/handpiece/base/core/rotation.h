// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Rotations that need angles: Eigen's own ask the C library, and would not give the same bits on every machine.

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"

namespace handpiece::core {

/// The shortest rotation that takes the direction of `from` to that of `to`; of opposite directions, one of the half
/// turns. Neither vector may be zero.
[[nodiscard]] Quat rotationBetween(const Vec3& from, const Vec3& to);

/// The turn by `rad` about `axis` (unit).
[[nodiscard]] Quat rotationAbout(const Vec3& axis, double rad) noexcept HANDPIECE_REALTIME;

/// The angle from one rotation to the other, 0 to pi; q and -q are the same one.
[[nodiscard]] double angleBetween(const Quat& a, const Quat& b) noexcept HANDPIECE_REALTIME;

/// No less than any point within `armMm` of the frame's origin moves from one pose to the other.
[[nodiscard]] inline double mostMovedMm(const Pose& from, const Pose& to, double armMm) noexcept HANDPIECE_REALTIME {
    const double cosine = from.orientation.coeffs().dot(to.orientation.coeffs());
    const double turn = 2.0 * std::sqrt(std::max(0.0, 1.0 - cosine * cosine));  // chord of a unit arm
    return (to.positionMm - from.positionMm).norm() + turn * armMm;
}

/// `share` of the way from one rotation to the other, at an even pace, the shorter way round.
[[nodiscard]] Quat interpolated(const Quat& from, double share, const Quat& to) noexcept HANDPIECE_REALTIME;

}  // namespace handpiece::core
