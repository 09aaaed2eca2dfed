// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// News of one brick's triangles, from whoever keeps the surface up to whoever draws it.

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "handpiece/senses/surface/brick_mesh.h"

namespace handpiece::surface {

/// sRGB, and 255 where the surface is as it was scanned; all 0 elsewhere.
using ScanColour = std::array<std::uint8_t, 4>;

/// The triangles of one brick, as handed over, in the frame of the tooth worked on. A null mesh: the brick has none
/// (any more).
struct BrickUpdate {
    std::uint32_t id = 0;                                            ///< tooth::BrickId: which brick of which tooth
    bool isUncut = false;                                            ///< it is as before any cut
    std::shared_ptr<const BrickMesh> mesh;                           ///< full detail
    std::shared_ptr<const BrickMesh> coarse;                         ///< level 2, for an eye in motion; null: none
    std::shared_ptr<const std::vector<float>> removedDepthMm;        ///< by vertex of `mesh`; null: not asked for
    std::shared_ptr<const std::vector<ScanColour>> colours{};        ///< by vertex of `mesh`; null: none were scanned
    std::shared_ptr<const std::vector<ScanColour>> coarseColours{};  ///< likewise of `coarse`
};

}  // namespace handpiece::surface
