// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/field_depth.h"

#include <algorithm>
#include <cmath>

namespace handpiece::contact {

using core::Vec3;
using instrument::MedialBall;

namespace {

constexpr int kStarts = 4, kClimbSteps = 24, kProjections = 3;
constexpr double kSlopeStepMm = 2e-4;
constexpr double kFinalStepMm = 2e-6;

}  // namespace

FieldDepth::FieldDepth(const tooth::ToothField& field, const instrument::Bur& bur) : field_(field), bur_(bur) {
    for (const instrument::MedialCurve& curve : bur.medialAxis())
        if (curve.onAxis) axis_.insert(axis_.end(), curve.balls.begin(), curve.balls.end());
    std::sort(axis_.begin(), axis_.end(), [](const MedialBall& a, const MedialBall& b) { return a.zMm < b.zMm; });
}

double FieldDepth::radiusAt(double z) const noexcept {
    auto high = std::upper_bound(axis_.begin(), axis_.end(), z,
                                 [](double value, const MedialBall& b) { return value < b.zMm; });
    if (high == axis_.begin()) return axis_.front().radiusMm;
    if (high == axis_.end()) return axis_.back().radiusMm;
    const MedialBall &a = *(high - 1), &b = *high;
    return a.radiusMm + (b.radiusMm - a.radiusMm) * (z - a.zMm) / (b.zMm - a.zMm);
}

void FieldDepth::search(const core::Pose& burInTooth, const ConstraintSet& touching, BallDepth& best) const noexcept {
    if (!axis_.empty()) searchAxis(burInTooth, best);
    int starts = 0;
    for (const Constraint& c : touching) {
        if (starts == kStarts) break;
        // The next ones start beside those before them: only other walls are worth a climb.
        bool near = false;
        for (int i = 0; i < starts && !near; ++i)
            near = (touching[static_cast<std::size_t>(i)].pointMm - c.pointMm).norm() < 0.1;
        if (near && starts > 0 && &c != touching.begin()) continue;
        ++starts;
        climbSurface(burInTooth, c.pointMm - c.gapMm * c.normal, best);
        // A rim in the tooth: the bur's own surface point is the ball of no radius.
        if (-c.gapMm > best.depthMm) best = {-c.gapMm, c.pointMm, c.pointMm - c.gapMm * c.normal, 0, 0, c.gapMm < 0.0};
    }
}

void FieldDepth::searchAxis(const core::Pose& burInTooth, BallDepth& best) const noexcept {
    const Vec3 axis = burInTooth.orientation * Vec3::UnitZ();
    const double low = axis_.front().zMm, high = axis_.back().zMm;
    // Outside the band the field only bounds the distance; there the climbs over the surface decide.
    const auto depthAt = [&](double z) {
        const Vec3 c = burInTooth.positionMm + z * axis;
        const double d = field_.distance(c);
        return d > 0.0 && !field_.isFine(c) ? -1e30 : radiusAt(z) - d;
    };
    const int steps = std::clamp(static_cast<int>(std::ceil((high - low) / field_.settings().voxelMm)), 1, 256);
    double top = low, topDepth = depthAt(low);
    for (int i = 1; i <= steps; ++i) {
        const double z = low + (high - low) * i / steps, d = depthAt(z);
        if (d > topDepth) {
            top = z;
            topDepth = d;
        }
    }
    if (topDepth < -1e29) return;
    for (double step = 0.5 * (high - low) / steps; step > kFinalStepMm; step *= 0.5)
        for (const double z : {std::max(low, top - step), std::min(high, top + step)}) {
            const double d = depthAt(z);
            if (d > topDepth) {
                top = z;
                topDepth = d;
            }
        }
    if (topDepth <= best.depthMm) return;
    const Vec3 c = burInTooth.positionMm + top * axis;
    const double d = field_.distance(c);
    best = {topDepth, c, c - d * field_.normal(c), 0, 0, d < 0.0};
}

bool FieldDepth::projectToSurface(Vec3& q, Vec3& normal) const noexcept {
    for (int i = 0; i < kProjections; ++i) {
        normal = field_.normal(q);
        if (normal.isZero()) return false;
        q -= field_.distance(q) * normal;
    }
    return true;
}

/// The deepest point of the tooth's surface in the bur, nearby: along the slope of the bur's distance.
void FieldDepth::climbSurface(const core::Pose& burInTooth, const Vec3& start, BallDepth& best) const noexcept {
    const core::Mat3 toBur = burInTooth.orientation.toRotationMatrix().transpose();
    const auto depthOf = [&](const Vec3& q) { return -bur_.signedDistance(toBur * (q - burInTooth.positionMm)); };
    Vec3 q = start, normal;
    if (!projectToSurface(q, normal)) return;
    double here = depthOf(q), stride = 0.3 * bur_.maxRadiusMm();
    for (int i = 0; i < kClimbSteps; ++i) {
        const Vec3 s = normal.unitOrthogonal(), t = normal.cross(s);
        const Vec3 slope = ((depthOf(q + kSlopeStepMm * s) - depthOf(q - kSlopeStepMm * s)) * s +
                            (depthOf(q + kSlopeStepMm * t) - depthOf(q - kSlopeStepMm * t)) * t) /
                           (2.0 * kSlopeStepMm);
        bool moved = false;
        while (!moved && stride * slope.norm() > kFinalStepMm) {
            Vec3 next = q + stride * slope, nextNormal;
            const bool valid = projectToSurface(next, nextNormal);
            const double depth = valid ? depthOf(next) : -1e30;
            if (depth > here) {
                q = next;
                normal = nextNormal;
                here = depth;
                stride *= 1.5;
                moved = true;
            } else {
                stride *= 0.4;
            }
        }
        if (!moved) break;
    }
    if (here <= best.depthMm) return;
    // The ball that holds q lies across the bur's slope from it.
    Vec3 slope;
    for (int k = 0; k < 3; ++k)
        slope[k] = (depthOf(q + kSlopeStepMm * Vec3::Unit(k)) - depthOf(q - kSlopeStepMm * Vec3::Unit(k))) /
                   (2.0 * kSlopeStepMm);
    best = {here, q + 1e-3 * slope, q, 0, 0, slope.dot(normal) < 0.0};
}

}  // namespace handpiece::contact
