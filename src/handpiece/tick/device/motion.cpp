// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/device/motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/rotation.h"

namespace handpiece::device {
namespace {

using core::Pose;
using core::Vec3;

double positive(double value, const char* what) {
    if (!(value > 0.0) || !std::isfinite(value)) {
        throw core::Error(fmt::format("{} is {}", what, value), "motion", "give a number above zero");
    }
    return value;
}

Vec3 unit(const Vec3& direction) {
    const double length = direction.norm();
    if (!(length > 1e-9) || !std::isfinite(length)) throw core::Error("the direction has no length", "motion");
    return direction / length;
}

/// Builds a motion leg by leg.
class Path {
  public:
    explicit Path(const Pose& start) { poses_.push_back({0.0, start, 0.0}); }
    void lineTo(const Vec3& position, double speedMmS) {
        TimedPose next = poses_.back();
        const double length = (position - next.burInTooth.positionMm).norm();
        if (length <= 0.0) return;
        next.timeS += length / positive(speedMmS, "speed");
        next.burInTooth.positionMm = position;
        poses_.push_back(next);
    }
    void dwell(double seconds) {
        if (seconds == 0.0) return;
        TimedPose next = poses_.back();
        next.timeS += positive(seconds, "dwell");
        poses_.push_back(next);
    }
    Motion finish() { return Motion(std::move(poses_)); }

  private:
    std::vector<TimedPose> poses_;
};

}  // namespace

Motion::Motion(std::vector<TimedPose> poses) : poses_(std::move(poses)) {
    if (poses_.empty()) throw core::Error("no pose", "motion", "give at least one timed pose");
    for (std::size_t i = 0; i < poses_.size(); ++i) {
        const TimedPose& p = poses_[i];
        const std::string where = fmt::format("motion, pose {}", i + 1);
        if (!std::isfinite(p.timeS)) throw core::Error("the time is not finite", where);
        if (!p.burInTooth.isValid()) {
            throw core::Error("not a finite position with a unit quaternion", where,
                              "positions in mm, quaternions as w x y z");
        }
        if (!(p.pedal >= 0.0 && p.pedal <= 1.0)) throw core::Error(fmt::format("pedal {}", p.pedal), where, "0 to 1");
        if (i > 0 && !(p.timeS > poses_[i - 1].timeS)) {
            throw core::Error(fmt::format("time {} s does not follow {} s", p.timeS, poses_[i - 1].timeS), where,
                              "sort the poses by time, each time once");
        }
    }
}

TimedPose Motion::at(double timeS) const noexcept {
    if (!(timeS > poses_.front().timeS)) return poses_.front();
    if (timeS >= poses_.back().timeS) return poses_.back();
    const auto next =
        std::upper_bound(poses_.begin(), poses_.end(), timeS, [](double t, const TimedPose& p) { return t < p.timeS; });
    const TimedPose &a = *(next - 1), &b = *next;
    const double s = (timeS - a.timeS) / (b.timeS - a.timeS);
    TimedPose result;
    result.timeS = timeS;
    result.burInTooth.positionMm = a.burInTooth.positionMm + s * (b.burInTooth.positionMm - a.burInTooth.positionMm);
    result.burInTooth.orientation =
        core::interpolated(a.burInTooth.orientation, s, b.burInTooth.orientation).normalized();
    result.pedal = a.pedal + s * (b.pedal - a.pedal);
    return result;
}

Motion hold(const Pose& at, double durationS) {
    Path path(at);
    path.dwell(positive(durationS, "duration"));
    return path.finish();
}

Motion drop(const Pose& start, const Vec3& direction, double distanceMm, double speedMmS, double dwellS) {
    Path path(start);
    path.lineTo(start.positionMm + positive(distanceMm, "distance") * unit(direction), speedMmS);
    path.dwell(dwellS);
    return path.finish();
}

Motion press(const Pose& start, const Vec3& direction, double distanceMm, double speedMmS, double dwellS) {
    Path path(start);
    path.lineTo(start.positionMm + positive(distanceMm, "distance") * unit(direction), speedMmS);
    path.dwell(dwellS);
    path.lineTo(start.positionMm, speedMmS);
    return path.finish();
}

Motion slide(const Pose& start, const Vec3& direction, double distanceMm, const Vec3& slideMm, double speedMmS) {
    Path path(start);
    const Vec3 in = positive(distanceMm, "distance") * unit(direction);
    path.lineTo(start.positionMm + in, speedMmS);
    path.lineTo(start.positionMm + in + slideMm, speedMmS);
    path.lineTo(start.positionMm + slideMm, speedMmS);
    return path.finish();
}

Motion drag(const std::vector<Vec3>& surfacePointsMm, const core::Quat& orientation, const Vec3& direction,
            double depthMm, double clearanceMm, double speedMmS) {
    if (surfacePointsMm.size() < 2) throw core::Error("a drag needs two points or more", "motion");
    const Vec3 in = unit(direction);
    Path path({surfacePointsMm.front() - positive(clearanceMm, "clearance") * in, orientation});
    for (const Vec3& p : surfacePointsMm)
        path.lineTo(p + depthMm * in, speedMmS);
    path.lineTo(surfacePointsMm.back() - clearanceMm * in, speedMmS);
    return path.finish();
}

Motion closedLoop(const Pose& start, const Vec3& firstAxis, const Vec3& secondAxis, double radiusMm, double speedMmS,
                  int turns) {
    if (turns < 1) throw core::Error(fmt::format("{} turns", turns), "motion", "one or more");
    const Vec3 a = unit(firstAxis), b = unit(secondAxis - secondAxis.dot(a) * a);
    positive(radiusMm, "radius");
    constexpr int kPointsPerTurn = 720;
    Path path(start);
    for (int i = 1; i <= turns * kPointsPerTurn; ++i) {
        const double angle = 2.0 * std::numbers::pi * (i % kPointsPerTurn) / kPointsPerTurn;
        path.lineTo(start.positionMm + radiusMm * ((core::cos(angle) - 1.0) * a + core::sin(angle) * b), speedMmS);
    }
    return path.finish();
}

}  // namespace handpiece::device
