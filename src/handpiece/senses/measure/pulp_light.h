// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How a remaining thickness of dentine is to be taken: one measure for every reading and picture.

namespace handpiece::measure {

/// Remaining dentine thickness [mm] from which on the lamp is green, and under which it is red. The defaults: of 0.5 mm
/// and more no pulp showed injury (Murray et al., Int Endod J 36, 2003), and down to 0.25 mm odontoblasts kept their
/// number (Murray et al., Am J Dent 15, 2002); both in sound young teeth with class V cavities, read as abstracts only.
/// A school sets its own (docs/settings.md): many teach 1 mm and more.
struct PulpLimits {
    double goodMm = 0.5, leastMm = 0.25;
    friend bool operator==(const PulpLimits&, const PulpLimits&) = default;
};

/// As thick as is asked for; thinner; thinner than the least.
enum class PulpLight { good, near, harmed };

[[nodiscard]] constexpr PulpLight pulpLight(double leftMm, const PulpLimits& limits = {}) noexcept {
    if (leftMm >= limits.goodMm) return PulpLight::good;
    return leftMm >= limits.leastMm ? PulpLight::near : PulpLight::harmed;
}

}  // namespace handpiece::measure
