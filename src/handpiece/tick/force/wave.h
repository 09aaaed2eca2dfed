// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Sine and decay in plain arithmetic: the same bits on every machine, which the C library does not promise.

#include <cmath>

#include "handpiece/base/core/realtime.h"

namespace handpiece::force {

/// sin(2 pi turns), within 1e-7.
[[nodiscard]] inline double sineOfTurns(double turns) noexcept HANDPIECE_REALTIME {
    double u = turns - std::floor(turns + 0.5);  // -0.5..0.5
    if (u > 0.25) u = 0.5 - u;
    if (u < -0.25) u = -0.5 - u;
    const double x = 6.283185307179586 * u, x2 = x * x;
    return x * (1.0 - x2 / 6.0 * (1.0 - x2 / 20.0 * (1.0 - x2 / 42.0 * (1.0 - x2 / 72.0 * (1.0 - x2 / 110.0)))));
}

/// exp(-x) for x >= 0, within 0.001 up to x = 1 and never above one or below zero.
[[nodiscard]] inline double decayOver(double x) noexcept HANDPIECE_REALTIME {
    return (1.0 - x / 2.0 + x * x / 12.0) / (1.0 + x / 2.0 + x * x / 12.0);
}

}  // namespace handpiece::force
