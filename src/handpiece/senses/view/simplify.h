// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Fewer triangles for a patch of the tooth, to within a given distance. Private to this room.

#include <memory>
#include <span>

#include "handpiece/senses/surface/brick_mesh.h"
#include "handpiece/senses/view/mesh_pool.h"

namespace handpiece::view {

struct Simplified {
    MeshPiece piece;
    /// No corner of the given triangles lies farther from the new ones [mm].
    float errorMm = 0.0f;
};

/// The bricks' triangles as one mesh with fewer. Points on its rim stay, and so do those on edges of the solid and
/// where tissues meet: patches simplified each by itself still fit each other and the whole bricks beside them, bit for
/// bit. The others are taken out one after the other while all that were taken out lie within `mostMm` of what is left
/// and no triangle turns away from the normals of its corners. What stays keeps its place and normal.
[[nodiscard]] Simplified simplified(std::span<const std::shared_ptr<const surface::BrickMesh>> meshes, float mostMm);

}  // namespace handpiece::view
