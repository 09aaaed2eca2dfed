// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Closes the holes of a mesh whose vertices are manifold. Only repair*.cpp include it.

#include <cstdint>
#include <span>
#include <vector>

#include "handpiece/base/geometry/repair.h"

namespace handpiece::geometry {

/// Adds faces (and where nothing else will do a vertex) until no edge is open; the holes, largest perimeter first.
/// Small loops get the triangulation of least area (Barequet & Sharir 1995), longer ones are first cut along their
/// shortest chords. A loop whose faces cross something gets the least area of those faces that cross nothing, where
/// there are such. Every vertex must belong to one fan of faces and neighbours must agree in orientation.
std::vector<ClosedHole> closeHoles(TriangleMesh& mesh);

/// The loops of open edges, vertices in the order in which new faces run along them, by their lowest vertex. Vertices
/// must be manifold as for closeHoles().
[[nodiscard]] std::vector<std::vector<std::uint32_t>> openLoops(const TriangleMesh& mesh);
/// Of faces that stand on the mesh's vertices.
[[nodiscard]] double areaMm2(const TriangleMesh& mesh, std::span<const Triangle> faces);
[[nodiscard]] double perimeterMm(const TriangleMesh& mesh, const std::vector<std::uint32_t>& loop);

}  // namespace handpiece::geometry
