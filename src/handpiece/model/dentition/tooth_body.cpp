// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/tooth_body.h"

#include <algorithm>

namespace handpiece::dentition {
namespace {

using core::Pose;
using core::Vec3;

/// A vertex may lie so deep in the other tooth and still be found, however close another one is.
constexpr double kDepthSeenMm = 1.5;

void closest(const ToothBody& of, const Pose& ofPose, const ToothBody& to, const Pose& toPose, Gap& best) {
    const core::Mat3 turn = (toPose.orientation.conjugate() * ofPose.orientation).toRotationMatrix();
    const Vec3 shift = toPose.applyInverse(ofPose.positionMm);
    for (const Vec3& point : of.points) {
        const Vec3 p = turn * point + shift;
        const double bound = std::max(best.distanceMm, 0.0);
        if (((p - to.box.max).array() > bound).any() || ((to.box.min - p).array() > bound).any()) continue;
        const geometry::NearestPoint n = to.tree.nearest(p, std::max(bound, kDepthSeenMm));
        if (n.triangle == geometry::kNoTriangle) continue;
        const double distance = to.tree.side(p, n) * n.distanceMm;
        if (distance < best.distanceMm) best = {distance, toPose.apply(0.5 * (p + n.pointMm))};
    }
}

/// Fewer faces than this are larger than what a contact is measured by.
constexpr std::size_t kFineFaces = 50000;

}  // namespace

ToothBody::ToothBody(const geometry::TriangleMesh& outer)
    : mesh(outer), tree(outer), box(outer.bounds()), points(outer.vertices) {
    if (outer.triangles.size() >= kFineFaces) return;
    for (const geometry::Triangle& t : outer.triangles)
        for (std::size_t e = 0; e < 3; ++e)
            if (const std::uint32_t a = t[e], b = t[(e + 1) % 3]; a < b)
                points.push_back(0.5 * (outer.vertices[a] + outer.vertices[b]));
}

Gap gapBetween(const ToothBody& a, const Pose& aPose, const ToothBody& b, const Pose& bPose, double boundMm) {
    Gap best{boundMm, Vec3::Zero()};
    closest(a, aPose, b, bPose, best);
    closest(b, bPose, a, aPose, best);
    return best;
}

}  // namespace handpiece::dentition
