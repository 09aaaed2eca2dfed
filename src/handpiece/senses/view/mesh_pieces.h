// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Meshes made ready to be drawn: normals, and cut into small pieces that can be left out alone. Private to this room.

#include <vector>

#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/base/geometry/vertex_colours.h"
#include "handpiece/model/case/tissue.h"
#include "handpiece/senses/surface/brick_update.h"
#include "handpiece/senses/view/mesh_pool.h"

namespace handpiece::view {

/// As it comes from the surface. `removedDepthMm`, `scanned`: by vertex, or null.
[[nodiscard]] MeshPiece pieceOf(const surface::BrickMesh& mesh, const std::vector<float>* removedDepthMm,
                                const std::vector<surface::ScanColour>* scanned);

/// How far each vertex of a gingiva lies from its margin, straight [mm]: the margin is the sharp edge where it
/// turns into the teeth's sockets. 0 everywhere for what has no such edge, as lips and scans.
[[nodiscard]] std::vector<float> underMarginMm(const geometry::TriangleMesh& gingiva);

/// Smooth but across edges sharper than `creaseRad`. Cut by a grid of `cellMm` (0: by number of vertices alone).
/// Vertices of gingiva hold how far they are under its margin where a tooth's hold what was removed. `colours`: as a
/// scanner saw it, by vertex; or empty.
[[nodiscard]] std::vector<MeshPiece> piecesOf(const geometry::TriangleMesh& mesh, cases::Tissue tissue,
                                              double creaseRad, double cellMm,
                                              const geometry::VertexColours& colours = {});

}  // namespace handpiece::view
