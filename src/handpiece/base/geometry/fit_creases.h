// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Vertices and edges along the creases of a surface that was sampled on a grid.

#include "handpiece/base/geometry/isosurface.h"

namespace handpiece::geometry {

/// Marching cubes lays its triangles across a valley or a ridge as they come: its line becomes a row of teeth as large
/// as a cell. Where the triangles of `mesh`, of the surface f = 0 at cells of `spacingMm`, bend, vertices go to where
/// the planes of their triangles meet, and edges are turned to run along the crease (after Ohtake & Belyaev 2002,
/// "Dual/ primal mesh optimization for polygonized implicit surfaces"). Closed and two-manifold stay so, and no
/// triangle turns over. Elsewhere nothing changes and f is not asked. In parallel; the same bytes at any thread count.
void fitCreases(TriangleMesh& mesh, const ScalarFunction& f, double spacingMm);

}  // namespace handpiece::geometry
