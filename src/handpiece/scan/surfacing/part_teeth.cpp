// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "handpiece/scan/surfacing/nesting.h"
#include "handpiece/scan/surfacing/smoothing.h"
#include "handpiece/scan/surfacing/surfaces.h"

namespace handpiece::surfacing {
namespace {

using core::Vec3;
using geometry::TriangleMesh;

constexpr double kGapMm = 0.01;
constexpr int kPartRounds = 30;
constexpr double kMostVoxels = 1.5;

bool isIn(const core::Box& box, const Vec3& p) {
    return ((p - box.max).array() <= 0.0).all() && ((box.min - p).array() <= 0.0).all();
}

/// Whether a vertex of one is in the other.
bool reachIn(const TriangleMesh& one, const TriangleMesh& other, double withinMm) {
    const core::Box box = other.bounds().grown(withinMm);
    std::vector<Vec3> near;
    std::copy_if(one.vertices.begin(), one.vertices.end(), std::back_inserter(near),
                 [&](const Vec3& p) { return isIn(box, p); });
    if (near.empty()) return false;
    const geometry::TriangleTree tree(other);
    return std::any_of(near.begin(), near.end(), [&](const Vec3& p) { return tree.signedDistance(p) < 0.5 * kGapMm; });
}

}  // namespace

Parted partTeeth(std::span<Surfaces* const> teeth, double voxelMm, const core::Progress& progress) {
    Parted result;
    std::vector<bool> isMoved(teeth.size(), false);
    for (std::size_t i = 0; i < teeth.size(); ++i) {
        core::report(progress, static_cast<double>(i) / static_cast<double>(teeth.size()));
        for (std::size_t j = i + 1; j < teeth.size(); ++j) {
            TriangleMesh &a = teeth[i]->outer.mesh, &b = teeth[j]->outer.mesh;
            const core::Box ofA = a.bounds().grown(voxelMm), ofB = b.bounds();
            if ((ofA.min.array() > ofB.max.array()).any() || (ofB.min.array() > ofA.max.array()).any()) continue;
            if (!reachIn(a, b, voxelMm) && !reachIn(b, a, voxelMm)) continue;
            std::vector<Vec3> near;
            std::copy_if(a.vertices.begin(), a.vertices.end(), std::back_inserter(near),
                         [&](const Vec3& p) { return isIn(ofB.grown(voxelMm), p); });
            if (near.empty()) near.push_back(a.vertices.front());
            const TriangleMesh still = facesNear(b, near, 3.0 * voxelMm);
            const std::vector<Bounds> apart(a.vertices.size(), Bounds{kGapMm, Bounds{}.high}),
                otherApart(still.vertices.size(), Bounds{kGapMm, Bounds{}.high});
            const Apart held =
                holdApart(a, apart, still, otherApart, voxelMm, kMostVoxels * voxelMm, kPartRounds, false, {});
            std::size_t left = 0;
            const double uncrossed = uncross(a, left);
            if (held.moved > 0) isMoved[i] = true;
            teeth[i]->outer.errorBoundMm = std::max(teeth[i]->outer.errorBoundMm, held.movedMm);
            result.movedMm = std::max({result.movedMm, held.movedMm, uncrossed});
        }
        if (!isMoved[i]) continue;
        // What lies in it stays in it.
        const geometry::TriangleTree tooth(teeth[i]->outer.mesh);
        for (Surface& tissue : teeth[i]->tissues)
            if (tissue.tissue != cases::Tissue::pulp)
                tissue.errorBoundMm = std::max(tissue.errorBoundMm, drawBack(tissue.mesh, tooth).movedMm);
    }
    result.teeth = static_cast<std::size_t>(std::count(isMoved.begin(), isMoved.end(), true));
    return result;
}

}  // namespace handpiece::surfacing
