// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A tooth that others are held against: its surface, ready to be asked for distances. Private to this room.

#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/triangle_tree.h"

namespace handpiece::dentition {

struct ToothBody {
    explicit ToothBody(const geometry::TriangleMesh& outer);
    const geometry::TriangleMesh& mesh;
    geometry::TriangleTree tree;
    core::Box box;
    std::vector<core::Vec3> points;  ///< vertices, and where those lie far apart the edges' middles; cluster by cluster
    /// Points close together, each in the ball.
    struct Cluster {
        std::size_t begin, end;
        core::Vec3 centre;
        double radiusMm;
    };
    std::vector<Cluster> clusters;
};

/// How far apart two surfaces are where they come closest; negative: how deep one is in the other.
struct Gap {
    double distanceMm;
    core::Vec3 pointMm;  ///< half-way, in the frame of the poses
};

/// Which of either's points came closest the last time: looked at first, they bound the search from its beginning.
struct GapHint {
    std::size_t pointOfA = 0, pointOfB = 0;
};

/// Between points of either and the surface of the other: what edges that cross add is far below the triangles' size.
/// No farther than `boundMm`.
[[nodiscard]] Gap gapBetween(const ToothBody& a, const core::Pose& aPose, const ToothBody& b, const core::Pose& bPose,
                             double boundMm, GapHint* hint = nullptr);

/// The shell of the most faces: crumbs and closed-in hollows go.
[[nodiscard]] geometry::TriangleMesh largestShell(const geometry::TriangleMesh& mesh);

}  // namespace handpiece::dentition
