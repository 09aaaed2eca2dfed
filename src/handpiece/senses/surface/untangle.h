// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Mends places where a closed mesh passes through itself. Private to this room.

#include <memory>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/senses/surface/brick_source.h"
#include "handpiece/senses/surface/brick_state.h"

namespace handpiece::surface {

/// Pulls vertices of faces that cross others back into their cells, and from there towards the mean of their crossings,
/// until no two faces cross, for a bounded number of rounds; the rest stays as it is. `mesh` is the bricks' at full
/// detail: their vertices one after the other, then those between cells, which do not move. Deterministic at any thread
/// count. Throws core::Error when cancelled.
void untangle(const BrickSource& source, const std::vector<std::unique_ptr<BrickState>>& bricks,
              geometry::TriangleMesh& mesh, const core::Progress& progress);

}  // namespace handpiece::surface
