// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Uniform cubic B-splines: as smooth as curvature, never beyond their control values. Private to this room.

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace handpiece::dentition {

/// Weights of the four control values about a place on a spline: `first` - 1 ... `first` + 2.
struct SplineTaps {
    std::size_t first;
    std::array<double, 4> value, slope, bend;
};

/// At `x` in [0, count - 1].
[[nodiscard]] inline SplineTaps splineTaps(double x, std::size_t count) {
    const double held = std::clamp(x, 0.0, static_cast<double>(count - 1));
    const std::size_t first = std::min(static_cast<std::size_t>(held), count - 2);
    const double t = held - static_cast<double>(first), s = 1.0 - t;
    return {first,
            {s * s * s / 6.0, (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0, (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0,
             t * t * t / 6.0},
            {-0.5 * s * s, -2.0 * t + 1.5 * t * t, 2.0 * s - 1.5 * s * s, 0.5 * t * t},
            {s, 3.0 * t - 2.0, 3.0 * s - 2.0, t}};
}

/// The spline through which it ends at its first and last control value: those beyond are mirrored there.
template <class Value, class At>
[[nodiscard]] Value splined(const SplineTaps& taps, const std::array<double, 4>& weights, std::size_t count,
                            const At& at) {
    const std::size_t i = taps.first;
    const Value before = i > 0 ? Value(at(i - 1)) : Value(2.0 * at(0) - at(1));
    const Value after = i + 2 < count ? Value(at(i + 2)) : Value(2.0 * at(count - 1) - at(count - 2));
    return weights[0] * before + weights[1] * at(i) + weights[2] * at(i + 1) + weights[3] * after;
}

}  // namespace handpiece::dentition
