// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the surface keeps of a brick. Private to this room.

#include <memory>
#include <vector>

#include "handpiece/senses/surface/brick_contour.h"
#include "handpiece/senses/surface/brick_mesh.h"

namespace handpiece::surface {

struct BrickState {
    BrickContour contour;
    // Where detail is less: what stands for each vertex of the contour.
    std::vector<SheetVertex> coarse;
    std::vector<std::uint16_t> coarseOf;
    int level = 0;
    std::uint8_t uses = 0;  ///< bit s: the mesh has vertices of the neighbour in slot s (see TriangleList)
    std::shared_ptr<const BrickMesh> mesh;

    [[nodiscard]] const std::vector<SheetVertex>& shown(bool fine) const {
        return fine || level == 0 ? contour.vertices : coarse;
    }
};

}  // namespace handpiece::surface
