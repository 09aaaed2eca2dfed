// SPDX-License-Identifier: Apache-2.0
#include "handpiece/assess/zones/cavity.h"

#include <algorithm>
#include <limits>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"

namespace handpiece::zones {
namespace {

using core::Vec2;
using core::Vec3;

/// One cavity with what is the same for all places.
struct Ready {
    Cavity cavity;
    double tangent, cosine;
};

double pastFloor(const Cavity& cavity, const Vec3& p, const Vec3& q, const geometry::TriangleTree* whole) {
    const double lowest = cavity.floor.heightMm - q.z();
    if (cavity.floor.kind == Floor::Kind::flat) return lowest;
    const double depth = -whole->signedDistance(p);
    if (cavity.floor.kind == Floor::Kind::near) return std::max(lowest, depth - cavity.floor.depthMm);
    if (depth <= 0.0) return std::max(lowest, -cavity.floor.depthMm);
    const geometry::RayMeeting out = whole->firstMeeting(p, cavity.inTooth.orientation * Vec3::UnitZ());
    const double along = out.triangle == geometry::kNoTriangle ? kFarMm : out.distanceMm;
    return std::max(lowest, along - cavity.floor.depthMm);
}

}  // namespace

TargetFunction targetOf(std::vector<Cavity> cavities, const geometry::TriangleTree* whole) {
    if (cavities.empty()) throw core::Error("there is nothing to take away", "target", "give a preparation");
    std::vector<Ready> ready;
    for (Cavity& cavity : cavities) {
        if (cavity.outline.isEmpty())
            throw core::Error("the outline is empty", "target", "give one that lies on the tooth");
        if (cavity.floor.kind != Floor::Kind::flat && whole == nullptr)
            throw core::Error("this floor follows a surface, and there is none", "target", "give a flat floor");
        ready.push_back({std::move(cavity), core::tan(cavity.wallRad), core::cos(cavity.wallRad)});
    }
    return [ready = std::move(ready), whole](const Vec3& p) {
        PastTarget least{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
        for (const Ready& r : ready) {
            const Vec3 q = r.cavity.inTooth.applyInverse(p);
            const double base = r.cavity.floor.kind == Floor::Kind::flat ? r.cavity.floor.heightMm : 0.0;
            const double wall =
                (r.cavity.outline.distanceMm(Vec2(q.x(), q.y())) - (q.z() - base) * r.tangent) * r.cosine;
            const PastTarget past{wall, pastFloor(r.cavity, p, q, whole)};
            if (past.distanceMm() < least.distanceMm()) least = past;
        }
        return least;
    };
}

core::Box boundsOf(const std::vector<Cavity>& cavities, double topMm) {
    core::Box box;
    for (const Cavity& cavity : cavities) {
        const auto [low, high] = cavity.outline.bounds();
        const bool isFlat = cavity.floor.kind == Floor::Kind::flat;
        const double bottom = isFlat ? cavity.floor.heightMm : -topMm, top = isFlat ? bottom + topMm : topMm;
        const double wider = std::max(core::tan(cavity.wallRad), 0.0) * (top - bottom);
        for (int i = 0; i < 8; ++i)
            box.extend(cavity.inTooth.apply(Vec3((i & 1) != 0 ? high.x() + wider : low.x() - wider,
                                                 (i & 2) != 0 ? high.y() + wider : low.y() - wider,
                                                 (i & 4) != 0 ? top : bottom)));
    }
    return box;
}

}  // namespace handpiece::zones
