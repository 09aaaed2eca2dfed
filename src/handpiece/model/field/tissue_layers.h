// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// One brick of a tissue map in the making: distances to the parts at its nodes in, tissues and layers out.

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "handpiece/model/field/tissue_map.h"

namespace handpiece::field {

/// A part near a brick and the signed distances [mm] to it at the brick's nodes.
struct NearPart {
    cases::Tissue tissue;
    std::array<float, kBrickValues> distanceMm;
};

/// The layers of a brick of several tissues.
struct BrickLayers {
    cases::Tissue rest = cases::Tissue::none;
    std::vector<cases::Tissue> tissues;  ///< of the layers, the one that wins first
    std::vector<std::int8_t> values;
    std::array<std::uint8_t, kBrickValues> nodes{};
};

/// What a brick is made of: one tissue, or layers.
struct LayeredBrick {
    cases::Tissue uniform = cases::Tissue::none;
    std::unique_ptr<BrickLayers> layers;
};

/// `parts` by falling priority. Where a node lies in none of them: of `rest`, or (`nearest`) of the part whose surface
/// is nearest.
[[nodiscard]] LayeredBrick layeredBrick(const std::vector<NearPart>& parts, cases::Tissue rest, bool nearest,
                                        double unitMm);

}  // namespace handpiece::field
