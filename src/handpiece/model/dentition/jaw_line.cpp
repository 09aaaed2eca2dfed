// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/jaw_line.h"

#include <algorithm>
#include <array>

#include "handpiece/model/dentition/spline.h"
#include "handpiece/model/dentition/surfaces.h"

namespace handpiece::dentition {
namespace {

using core::Vec2;
using core::Vec3;

constexpr double kTopUnderCrestMm = 3.0, kTopRoundedMm = 2.5;
/// Half its width: of the neck, and so much more a millimetre down.
constexpr double kShareOfNeck = 0.85, kWidens = 0.10, kWidensToMm = 15.0;
constexpr double kFollowsLeanMm = 14.0;

}  // namespace

JawLine::JawLine(std::span<const Stander> teeth, double up) : up_(up), highest_(-1e9) {
    for (const Stander& s : teeth) {
        const Vec3 lean = s.axis() / std::max(0.5, s.axis().z() * up);
        const Vec3& neck = s.pose().positionMm;
        roots_.push_back({neck.head<2>(), lean.head<2>(), neck.z() * up, s.halfNeckMm()});
        highest_ = std::max(highest_, roots_.back().heightMm);
    }
    // A jaw follows roots that lean each their own way only on the whole, or its line would cross itself at their tips.
    for (int round = 0; round < 3; ++round) {
        std::vector<Root> rough = roots_;
        for (std::size_t i = 1; i + 1 < roots_.size(); ++i)
            roots_[i].lean = 0.25 * rough[i - 1].lean + 0.5 * rough[i].lean + 0.25 * rough[i + 1].lean;
    }
}

double JawLine::least(const Vec3& p) const {
    return kTopUnderCrestMm - (highest_ - kCrestUnderCervixMm - up_ * p.z());
}

double JawLine::at(const Vec3& p) const {
    const std::size_t count = roots_.size();
    const double height = up_ * p.z();
    const Vec2 from = p.head<2>();
    const auto centre = [&](std::size_t i) -> Vec2 {
        const Root& r = roots_[i];
        return r.neck - std::clamp(r.heightMm - height, 0.0, kFollowsLeanMm) * r.lean;
    };
    // Nearest of the chords from axis to axis, then the nearest place of the curve about it.
    double nearest = 1e18, x = 0.0;
    Vec2 a = centre(0);
    for (std::size_t i = 0; i + 1 < count; ++i) {
        const Vec2 b = centre(i + 1), along = b - a;
        const double t = std::clamp((from - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
        const double away = (from - a - t * along).squaredNorm();
        if (away < nearest) nearest = away, x = static_cast<double>(i) + t;
        a = b;
    }
    Vec2 at = Vec2::Zero();
    SplineTaps taps = splineTaps(x, count);
    constexpr int kSteps = 4;
    for (int i = 0;; ++i) {
        at = splined<Vec2>(taps, taps.value, count, centre);
        if (i == kSteps) break;
        const Vec2 slope = splined<Vec2>(taps, taps.slope, count, centre);
        const Vec2 bend = splined<Vec2>(taps, taps.bend, count, centre);
        const double speed = slope.squaredNorm();
        const double step = (from - at).dot(slope) / std::max(0.4 * speed, speed - (from - at).dot(bend));
        x = std::clamp(x + std::clamp(step, -0.5, 0.5), 0.0, static_cast<double>(count - 1));
        taps = splineTaps(x, count);
    }
    const double neck = splined<double>(taps, taps.value, count, [&](std::size_t i) { return roots_[i].heightMm; });
    const double half = splined<double>(taps, taps.value, count, [&](std::size_t i) { return roots_[i].halfMm; });
    const double deep = neck - kCrestUnderCervixMm - height;
    const double width = kShareOfNeck * half + kWidens * std::clamp(deep, 0.0, kWidensToMm);
    return smoothMax((from - at).norm() - width, kTopUnderCrestMm - deep, kTopRoundedMm);
}

}  // namespace handpiece::dentition
