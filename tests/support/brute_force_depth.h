// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The reference for contact depth: slow, plain, and sharing nothing with the fast query but the definition.

#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/instrument/bur.h"

namespace handpiece::test {

struct BruteForceResult {
    double depthMm = 0.0;                     ///< - min over x of (phiT(x) + phiB(x)), to about 1e-7 mm
    core::Vec3 pointMm = core::Vec3::Zero();  ///< an x that attains it, tooth frame
};

/// Dense points on the bur's medial region, its surface and the tooth's vertices, exact distances to the triangles,
/// then every promising place refined by shrinking grids. A few milliseconds a pose of a bur; a large solid wants a
/// coarser first look. The tree's mesh must be closed.
[[nodiscard]] BruteForceResult bruteForceDepth(const geometry::TriangleTree& tooth, const instrument::Bur& bur,
                                               const core::Pose& burInTooth, double coarseMm = 0.02);

/// phiT + phiB at one point, tooth frame: the quantity whose minimum is minus the depth.
[[nodiscard]] double summedDistance(const geometry::TriangleTree& tooth, const instrument::Bur& bur,
                                    const core::Pose& burInTooth, const core::Vec3& pointMm);

}  // namespace handpiece::test
