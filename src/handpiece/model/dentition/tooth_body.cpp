// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/tooth_body.h"

#include <algorithm>

#include "handpiece/base/geometry/mesh_edges.h"

namespace handpiece::dentition {
namespace {

using core::Pose;
using core::Vec3;

/// A vertex may lie so deep in the other tooth and still be found, however close another one is.
constexpr double kDepthSeenMm = 1.5;

void closest(const ToothBody& of, const Pose& ofPose, const ToothBody& to, const Pose& toPose, Gap& best,
             std::size_t& closestPoint) {
    const core::Mat3 turn = (toPose.orientation.conjugate() * ofPose.orientation).toRotationMatrix();
    const Vec3 shift = toPose.applyInverse(ofPose.positionMm);
    const auto isBeyond = [&](const Vec3& p, double bound) {
        return ((p - to.box.max).array() > bound).any() || ((to.box.min - p).array() > bound).any();
    };
    const auto look = [&](std::size_t i, std::uint32_t seed) {
        const Vec3 p = turn * of.points[i] + shift;
        const double bound = std::max(best.distanceMm, 0.0);
        if (isBeyond(p, bound)) return;
        const geometry::NearestPoint n = to.tree.nearest(p, std::max(bound, kDepthSeenMm), seed);
        if (n.triangle == geometry::kNoTriangle) return;
        const double distance = to.tree.side(p, n) * n.distanceMm;
        if (distance < best.distanceMm) best = {distance, toPose.apply(0.5 * (p + n.pointMm))}, closestPoint = i;
    };
    look(closestPoint, geometry::kNoTriangle);
    for (const ToothBody::Cluster& c : of.clusters) {
        // No point of it is nearer, or deeper, than its middle less its radius.
        const Vec3 centre = turn * c.centre + shift;
        const double reach = std::max(best.distanceMm, 0.0) + c.radiusMm;
        if (isBeyond(centre, reach)) continue;
        const geometry::NearestPoint middle = to.tree.nearest(centre, std::max(reach, kDepthSeenMm + c.radiusMm));
        if (middle.triangle == geometry::kNoTriangle ||
            to.tree.side(centre, middle) * middle.distanceMm - c.radiusMm > best.distanceMm)
            continue;
        for (std::size_t i = c.begin; i < c.end; ++i)
            look(i, middle.triangle);
    }
}

/// Fewer faces than this are larger than what a contact is measured by.
constexpr std::size_t kFineFaces = 50000;
constexpr std::size_t kInCluster = 48;

void addClusters(std::vector<Vec3>& points, std::size_t begin, std::size_t end,
                 std::vector<ToothBody::Cluster>& clusters) {
    core::Box box;
    for (std::size_t i = begin; i < end; ++i)
        box.extend(points[i]);
    if (end - begin > kInCluster) {
        int axis = 0;
        box.size().maxCoeff(&axis);
        const std::size_t middle = begin + (end - begin) / 2;
        const auto at = [&](std::size_t i) { return points.begin() + static_cast<std::ptrdiff_t>(i); };
        std::nth_element(at(begin), at(middle), at(end),
                         [axis](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; });
        addClusters(points, begin, middle, clusters);
        addClusters(points, middle, end, clusters);
        return;
    }
    ToothBody::Cluster c{begin, end, box.centre(), 0.0};
    for (std::size_t i = begin; i < end; ++i)
        c.radiusMm = std::max(c.radiusMm, (points[i] - c.centre).norm());
    clusters.push_back(c);
}

}  // namespace

ToothBody::ToothBody(const geometry::TriangleMesh& outer)
    : mesh(outer), tree(outer), box(outer.bounds()), points(outer.vertices) {
    if (outer.triangles.size() < kFineFaces)
        for (const geometry::Triangle& t : outer.triangles)
            for (std::size_t e = 0; e < 3; ++e)
                if (const std::uint32_t a = t[e], b = t[(e + 1) % 3]; a < b)
                    points.push_back(0.5 * (outer.vertices[a] + outer.vertices[b]));
    addClusters(points, 0, points.size(), clusters);
}

Gap gapBetween(const ToothBody& a, const Pose& aPose, const ToothBody& b, const Pose& bPose, double boundMm,
               GapHint* hint) {
    GapHint none;
    GapHint& at = hint ? *hint : none;
    Gap best{boundMm, Vec3::Zero()};
    closest(a, aPose, b, bPose, best, at.pointOfA);
    closest(b, bPose, a, aPose, best, at.pointOfB);
    return best;
}

geometry::TriangleMesh largestShell(const geometry::TriangleMesh& mesh) {
    geometry::DisjointSets shells(mesh.vertices.size());
    for (const geometry::Triangle& t : mesh.triangles)
        for (const std::uint32_t v : {t[1], t[2]})
            shells.join(t[0], v);
    std::vector<std::size_t> faces(mesh.vertices.size(), 0);
    for (const geometry::Triangle& t : mesh.triangles)
        ++faces[shells.find(t[0])];
    const auto largest = static_cast<std::uint32_t>(std::max_element(faces.begin(), faces.end()) - faces.begin());
    geometry::TriangleMesh kept;
    std::vector<std::uint32_t> index(mesh.vertices.size(), 0);
    for (std::uint32_t v = 0; v < index.size(); ++v)
        if (shells.find(v) == largest) {
            index[v] = static_cast<std::uint32_t>(kept.vertices.size());
            kept.vertices.push_back(mesh.vertices[v]);
        }
    for (const geometry::Triangle& t : mesh.triangles)
        if (shells.find(t[0]) == largest) kept.triangles.push_back({index[t[0]], index[t[1]], index[t[2]]});
    return kept;
}

}  // namespace handpiece::dentition
