// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/input/line_of_sight.h"

#include <algorithm>

namespace handpiece::input {
namespace {

using core::Vec3;

constexpr int kMaxLooks = 200;         // on the way to what is met
constexpr double kLookMm = 0.3;        // in which the way through the tooth is looked at
constexpr double kInStrokeMm = 0.005;  // nearer than this the stroke's surface is touched
constexpr double kLeastCosine = 0.5;   // of bur and line of sight: beyond it the bur works with its side

}  // namespace

std::optional<double> Leading::meet(const LineOfSight& s, double fromMm, double offMm, double farMm) const {
    double at = fromMm;
    for (int i = 0; i < kMaxLooks && at < farMm; ++i) {
        const double left = clearMm(s.at(at)) - offMm;
        if (left < kNearMm) return at;
        at += left;
    }
    return {};
}

LineOfSight Leading::alongRay(const view::Ray& ray, double hoverMm, double farMm) const {
    LineOfSight s;
    s.ray = ray;
    s.hoverAt = meet(s, 0.0, hoverMm, farMm);
    if (s.hoverAt) s.touchAt = meet(s, *s.hoverAt, 0.0, farMm);
    if (s.touchAt) {
        const Clearance met = feel_.ofBur(poseAt(s.at(*s.touchAt)));
        s.what = met.what;
        s.isTooth = met.isTooth;
    }
    return s;
}

double Leading::wayOutMm(const Vec3& tipMm, const Vec3& direction, double offMm) const {
    double way = 0.0;
    for (int i = 0; i < kMaxLooks && way < 2.0 * kReachMm; ++i) {
        const double missing = offMm - clearMm(tipMm + way * direction);
        if (missing < kNearMm) break;
        way += std::max(missing, 5.0 * kNearMm);
    }
    return way;
}

/// Along the bur, as one measures; a bur that works with its side hardly comes out that way, and there the way in
/// counts.
double Leading::stopEndMm(const LineOfSight& s, double stopMm) const {
    double end = stopMm;
    const double mostMm = 3.0 * stopMm;
    for (int i = 0; i < 8 && end < mostMm && clearMm(s.at(*s.touchAt + end)) < 0.0; ++i) {
        const double missing = stopMm - wayOutMm(s.at(*s.touchAt + end), axis(), 0.0);
        if (missing < 5.0 * kNearMm) break;
        end = std::min(end + missing, mostMm);
    }
    return end;
}

/// To where the bur is deepest in the tooth: beyond it would come out at the other side, or run down along a wall.
double Leading::deepestMm(const LineOfSight& s) const {
    double deepest = 0.0, end = 0.0;
    for (double way = 0.0; way <= kReachMm; way += kLookMm) {
        const double depth = -clearMm(s.at(*s.touchAt + way));
        if (depth > deepest) {
            deepest = depth;
            end = way;
        } else if (depth < deepest - kLookMm) {
            break;
        }
    }
    return std::min(end + kLookMm, kReachMm);
}

void Leading::findEnd(LineOfSight& s, const DepthLimits& limits) const {
    const double end = limits.stopMm ? stopEndMm(s, *limits.stopMm) : deepestMm(s);
    s.end = limits.stopMm ? LineOfSight::End::atStop : LineOfSight::End::through;
    s.endAt = *s.touchAt + end;
    s.passAt = *s.touchAt;
    if (!limits.perPassMm) return;
    double at = *s.touchAt;
    // Of another tooth, and of gingiva, only the uncut surface is known.
    for (int i = 0; s.what == 0 && i < kMaxLooks && at < *s.touchAt + kReachMm; ++i) {
        const double left = feel_.inStrokeMm(poseAt(s.at(at)));
        if (left < kInStrokeMm) break;
        at += left;
    }
    s.passAt = at;
    const double passEnd = at + *limits.perPassMm / std::clamp(-s.ray.direction.dot(axis()), kLeastCosine, 1.0);
    if (passEnd >= s.endAt) return;
    s.endAt = passEnd;
    s.end = LineOfSight::End::passDone;
}

}  // namespace handpiece::input
