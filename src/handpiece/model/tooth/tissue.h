// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The tissues of a tooth and its surroundings, and what they feel like.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace handpiece::tooth {

enum class Tissue : std::uint8_t { none, enamel, dentine, pulp, caries, cementum, gum, bone, neighbour, restoration };
inline constexpr std::size_t kTissueCount = 10;

/// What a tissue feels like through a device. Stiffness is a fraction of what the device can render stably (its
/// capability record), because enamel is orders of magnitude stiffer than any desktop arm.
struct TissueProperties {
    std::string_view name;
    double stiffnessFraction;            ///< of the device's stiffness limit, 0..1
    double dampingNSPerMm;               ///< Kelvin-Voigt b on the approach [N s/mm]
    std::array<std::uint8_t, 3> colour;  ///< sRGB
    int priority;                        ///< where parts overlap the higher one wins
};

/// docs/physics.md#tissues says where each figure comes from.
[[nodiscard]] const TissueProperties& properties(Tissue tissue);
/// By name ("enamel"); throws core::Error naming the tissues there are.
[[nodiscard]] Tissue tissueByName(std::string_view name);

}  // namespace handpiece::tooth
