// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The Falcon's three arms: where the grip is for the angles of the cranks, and what the motors do to the grip.
///
/// Each arm is a crank of length `a` that turns in a plane through the device's axis, and a parallelogram between
/// crank and grip that keeps the grip level. In the arm's frame (u out from the axis, v across, w to the user) the end
/// of the arm is at q = grip + (c - r, f - s, 0) from the crank's pivot, and
///     (q_u - a cos t)^2 + (q_w - a sin t)^2 = (d + e + sqrt(b^2 - q_v^2))^2
/// for the crank's angle t. Everything here follows from that one line. Frame: +x right, +y up, +z to the user; its
/// origin lies on the axis, in the plane of the pivots. Lengths as measured for open-source drivers; unchecked.

#include <array>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"

namespace handpiece::drivers::falcon {

inline constexpr double kCrankMm = 60.0;              // a
inline constexpr double kParallelogramMm = 102.5;     // b
inline constexpr double kGripOutMm = 14.0;            // c
inline constexpr double kJointMm = 11.25;             // d = e
inline constexpr double kGripAcrossMm = -25.0;        // f
inline constexpr double kPivotOutMm = 37.233758;      // r
inline constexpr double kPivotAcrossMm = -27.330909;  // s
/// Of the arms, from +x about +z: top, right, left.
inline constexpr std::array<double, 3> kArmAtDeg{105.0, -15.0, -135.0};

/// Encoder: 320 slots, four counts each, on a shaft of 14.25 mm that drives a crank's sector of 110 mm.
inline constexpr double kDegPerCount = 14.25 / 110.0 * 360.0 / (320.0 * 4.0);
inline constexpr double kDegAtZero = 35.0;
[[nodiscard]] double crankOf(int count) noexcept;        ///< rad
[[nodiscard]] double countOf(double crankRad) noexcept;  ///< not rounded

/// The middle of the workspace, where the driver puts its origin.
[[nodiscard]] core::Vec3 middleMm() noexcept;

/// Crank angles for a place of the grip. False outside of what the arms reach.
[[nodiscard]] bool inverse(const core::Vec3& gripMm, core::Vec3& cranksRad) noexcept HANDPIECE_REALTIME;

/// Place of the grip for crank angles, from a place nearby (in, out). False when there is none, `gripMm` is unchanged
/// then.
[[nodiscard]] bool forward(const core::Vec3& cranksRad, core::Vec3& gripMm) noexcept HANDPIECE_REALTIME;

/// Torques about the cranks [N mm] that push the grip with a force: by virtual work, torque . d crank = force . d grip.
/// False where the arms are stretched and no torque does it.
[[nodiscard]] bool torquesFor(const core::Vec3& gripMm, const core::Vec3& cranksRad, const core::Vec3& forceN,
                              core::Vec3& torqueNmm) noexcept HANDPIECE_REALTIME;

}  // namespace handpiece::drivers::falcon
