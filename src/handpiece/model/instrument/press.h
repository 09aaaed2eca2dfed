// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a load on the bur is called, by what turns the bur; why: docs/physics.md#what-a-load-is-called.

#include <string_view>

namespace handpiece::instrument {

/// Loads [N] from which on a press is light, as usual, firm and hard; under the first it is very light. They are the
/// hand's, whatever a device could give.
struct PressLimits {
    double lightN, usualN, firmN, hardN;
};
/// Of a drive by name; one that is not known counts as a turbine.
[[nodiscard]] constexpr PressLimits pressLimitsOf(std::string_view drive) noexcept {
    if (drive == "speed-increasing") return {0.6, 1.0, 1.6, 2.4};
    if (drive == "low-speed") return {0.5, 0.9, 1.8, 2.6};
    return {0.4, 0.7, 1.3, 2.0};
}

}  // namespace handpiece::instrument
