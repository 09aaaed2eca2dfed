// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Surfaces held apart: which side of another surface each vertex stays on, and how far. Private to this room.

#include <limits>
#include <span>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/base/geometry/triangle_tree.h"

namespace handpiece::surfacing {

/// What a vertex' signed distance to the other surface [mm] is held to.
struct Bounds {
    double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
};

struct Apart {
    std::size_t moved = 0;   ///< vertices
    double movedMm = 0;      ///< farthest of them
    std::size_t failed = 0;  ///< vertices left that break a bound
    double failedByMm = 0;   ///< by how much at most
    core::Vec3 failedMm = core::Vec3::Zero();
};

/// Moves vertices of `moving` until they keep `onMoving` to `still`, and until the vertices of `still` keep `onStill`
/// to it. Only what lies within `nearMm` of the other surface is looked at, so `still` may be a piece of a surface.
/// No vertex goes farther than `mostMm`. With `strictly`, no face of one may cross the other either.
[[nodiscard]] Apart holdApart(geometry::TriangleMesh& moving, std::span<const Bounds> onMoving,
                              const geometry::TriangleMesh& still, std::span<const Bounds> onStill, double nearMm,
                              double mostMm, int rounds, bool strictly, const core::Progress& progress);

inline constexpr double kMaxStandOutMm = 0.08;  ///< below cases::kCaseToleranceMm

struct DrawnBack {
    std::size_t moved = 0;  ///< vertices
    double movedMm = 0;     ///< farthest of them
    std::size_t left = 0;   ///< vertices that could not be brought back
};
/// Draws back what stands out of the tooth by more than kMaxStandOutMm.
DrawnBack drawBack(geometry::TriangleMesh& tissue, const geometry::TriangleTree& tooth);

/// The faces of a surface with a vertex within about `reachMm` of one of the points.
[[nodiscard]] geometry::TriangleMesh facesNear(const geometry::TriangleMesh& mesh, std::span<const core::Vec3> points,
                                               double reachMm);

}  // namespace handpiece::surfacing
