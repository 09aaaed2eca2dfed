// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Closes the holes of a mesh whose vertices are manifold. Only repair.cpp includes it.

#include <vector>

#include "handpiece/base/geometry/repair.h"

namespace handpiece::geometry {

/// Adds faces (and where nothing else will do a vertex) until no edge is open; the holes, largest perimeter first.
/// Small loops get the triangulation of least area (Barequet & Sharir 1995), longer ones are first cut along their
/// shortest chords. Every vertex must belong to one fan of faces and neighbours must agree in orientation.
std::vector<ClosedHole> closeHoles(TriangleMesh& mesh);

}  // namespace handpiece::geometry
