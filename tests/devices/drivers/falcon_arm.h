// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// One arm of the Falcon, put together from its parts in space and closed by halving an interval: slow, and with
/// nothing in common with the driver's kinematics but the lengths.

#include <cmath>
#include <numbers>

#include "handpiece/base/core/vec.h"

namespace handpiece::test {

/// How much longer the parallelogram would have to be [mm] for a crank at `angle` to hold the grip there.
inline double missingAt(int arm, const core::Vec3& grip, double angle) {
    const double at = (105.0 - 120.0 * arm) * std::numbers::pi / 180.0;
    const core::Vec3 out(std::cos(at), std::sin(at), 0), across(-std::sin(at), std::cos(at), 0), up(0, 0, 1);
    const core::Vec3 pivot = 37.233758 * out - 27.330909 * across;
    const core::Vec3 knee = pivot + 60.0 * (std::cos(angle) * out + std::sin(angle) * up);
    const core::Vec3 end = grip + 14.0 * out - 25.0 * across;
    // The shin is a joint of 11.25 mm, the parallelogram's side, a joint again; joints stay in the crank's plane.
    const core::Vec3 shin = end - knee;
    const double sideways = shin.dot(across);
    const double inPlane = (shin - sideways * across).norm() - 2 * 11.25;
    return std::hypot(inPlane, sideways) - 102.5;
}

/// The crank's angle [rad], knee outwards; not a number where the arm does not reach.
inline double crankAt(int arm, const core::Vec3& grip) {
    // Turning the knee inwards from where it points away from the grip brings it nearer: one change of sign.
    double low = -0.5 * std::numbers::pi, high = low;
    const double from = missingAt(arm, grip, low);
    while (high < std::numbers::pi && missingAt(arm, grip, high) * from > 0)
        high += 0.02;
    if (high >= std::numbers::pi) return std::nan("");
    low = high - 0.02;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (missingAt(arm, grip, middle) * from > 0 ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

inline double countAt(double crankRad) {
    return (crankRad * 180.0 / std::numbers::pi - 35.0) * (1280.0 / 360.0) * 110.0 / 14.25;
}

}  // namespace handpiece::test
