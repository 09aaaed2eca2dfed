// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The nearest translation that a set of half-spaces allows.

#include <array>
#include <cstdint>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/tick/contact/method.h"

namespace handpiece::force {

/// What project() found: stepMm = wanted + sum of multiplier x normal over the active constraints.
struct Projection {
    core::Vec3 stepMm = core::Vec3::Zero();
    double slackMm = 0.0;  ///< by how much every half-space had to give way; nanometres unless they contradict
    std::array<std::uint8_t, 4> active{};  ///< indices of the constraints that hold the step back
    std::array<double, 4> multiplierMm{};
    int activeCount = 0;
    int iterations = 0;
};

/// Minimises |step - wanted|^2 + slack^2 / e^2 subject to gap_i + n_i . step + slack >= 0. With the default e it is
/// exact to 1e-6 of the distance by which the constraints hold the step back, and the violation is shared evenly where
/// they contradict each other (a bur wedged tighter than the gap). A larger e gives way sooner: no step is longer than
/// 1 / e times the violation that it mends.
///
/// Dual active set (Goldfarb & Idnani 1983) in four dimensions: always solvable, at most kMaxProjectionIterations.
/// The same inputs give the same bits. A microsecond or less.
[[nodiscard]] Projection project(const contact::ConstraintSet& constraints, const core::Vec3& wantedMm,
                                 double e = 1e-3) noexcept HANDPIECE_REALTIME;
inline constexpr int kMaxProjectionIterations = 64;

}  // namespace handpiece::force
