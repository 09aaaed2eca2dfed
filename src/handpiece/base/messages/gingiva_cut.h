// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Where a turning bur was in gingiva: what a picture shows as a wound. Plain data.

#include <array>
#include <cstddef>

namespace handpiece::messages {

inline constexpr std::size_t kBurStations = 9;

struct GingivaCut {
    double timeS = 0.0;
    std::array<double, 3> tipMm{};                       ///< of the bur, tooth frame
    std::array<double, 3> axis{0, 0, 1};                 ///< from the tip to the shank, unit, tooth frame
    double lengthMm = 0.0;                               ///< of the bur's head
    std::array<double, kBurStations> stationRadiusMm{};  ///< of it, evenly from the tip to its end

    bool operator==(const GingivaCut&) const = default;
};

}  // namespace handpiece::messages
