// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How a remaining thickness of dentine is to be taken: one measure for every reading and picture.

namespace handpiece::measure {

/// Dentine left over the pulp at which a pulp stays quiet, and below which it suffers [mm]. Of common teaching,
/// recalled; not checked against a primary source.
inline constexpr double kPulpSafeMm = 0.5, kPulpHarmedMm = 0.25;

/// Enough is left; little; too little.
enum class PulpLight { good, near, harmed };

[[nodiscard]] constexpr PulpLight pulpLight(double leftMm) noexcept {
    if (leftMm >= kPulpSafeMm) return PulpLight::good;
    return leftMm >= kPulpHarmedMm ? PulpLight::near : PulpLight::harmed;
}

}  // namespace handpiece::measure
