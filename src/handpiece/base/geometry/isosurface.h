// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Closed triangle surfaces from functions and grids.

#include <functional>
#include <span>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::geometry {

/// A function of space, negative inside. Pure: called from several threads, the same point gives the same value.
using ScalarFunction = std::function<double(const core::Vec3&)>;

struct IsosurfaceSettings {
    double spacingMm = 0.1;  ///< edge of a sampling cell
    double lipschitz = 1.0;  ///< |f(p) - f(q)| <= lipschitz |p - q|; lets the empty space be skipped
    /// How steep f mostly is, below `lipschitz`: less is asked then, and where the surface leaves what was looked at it
    /// is followed. Only a shell of its own that is steeper all around can be missed. 0: the bound.
    double usualSlope = 0.0;
    int relaxations = 2;         ///< rounds of evening out the triangles along the surface
    bool project = true;         ///< Newton steps onto f = 0; off leaves the vertices on the cells' edges
    bool keepGradients = false;  ///< after the first: a quarter of the samples, microns off where f has an edge
};

/// The surface f = 0 within `box`, closed and two-manifold whatever f is, counter-clockwise from outside (f > 0).
///
/// Marching cubes with the inside corners of ambiguous faces kept apart. The outermost layer of nodes counts as
/// outside, so a solid that sticks out of the box is cut off within a cell or two of it. Empty when f is nowhere
/// negative on the nodes. In parallel; the same bytes at any thread count. Throws core::Error for a bad box, spacing or
/// bound, and when the bound proves wrong.
[[nodiscard]] TriangleMesh isosurface(const core::Box& box, const ScalarFunction& f, const IsosurfaceSettings& settings,
                                      const core::Progress& progress = {});

/// Samples on a regular grid, x fastest; negative inside.
struct ScalarGrid {
    core::Vec3 originMm = core::Vec3::Zero();
    double spacingMm = 1.0;
    std::array<std::uint32_t, 3> nodes{};
    std::span<const float> values;
};

/// The surface where the trilinear grid is zero; a layer of outside is put around the grid, so it is always closed.
[[nodiscard]] TriangleMesh isosurface(const ScalarGrid& grid, const core::Progress& progress = {});

}  // namespace handpiece::geometry
