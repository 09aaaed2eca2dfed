// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the simulated hand intends: timed poses of the bur, and the built-in ones.

#include <vector>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"

namespace handpiece::device {

struct TimedPose {
    double timeS = 0.0;
    core::Pose burInTooth;
    double pedal = 0.0;  ///< 0..1
};

/// Timed poses, straight lines and even turning in between; the first and the last pose hold before and after.
/// Immutable; safe to share between threads.
class Motion {
  public:
    /// Throws core::Error when empty, not finite, not a rotation, not rising in time, or a pedal outside 0..1.
    explicit Motion(std::vector<TimedPose> poses);

    /// Where the hand wants the bur at `timeS`. Never allocates; the logarithm of the number of poses.
    [[nodiscard]] TimedPose at(double timeS) const noexcept HANDPIECE_REALTIME;
    [[nodiscard]] double durationS() const noexcept { return poses_.back().timeS; }
    [[nodiscard]] const std::vector<TimedPose>& poses() const noexcept { return poses_; }

  private:
    std::vector<TimedPose> poses_;
};

// The built-in motions. Speeds in mm/s and durations in seconds must be positive: core::Error otherwise.

/// Stays at a pose.
[[nodiscard]] Motion hold(const core::Pose& at, double durationS);
/// Moves `distanceMm` along `direction` at `speedMmS` and dwells there.
[[nodiscard]] Motion drop(const core::Pose& start, const core::Vec3& direction, double distanceMm, double speedMmS,
                          double dwellS);
/// In along `direction`, dwells, and out again the same way.
[[nodiscard]] Motion press(const core::Pose& start, const core::Vec3& direction, double distanceMm, double speedMmS,
                           double dwellS);
/// In along `direction`, then sideways by `slideMm`, then out: a stroke along a wall.
[[nodiscard]] Motion slide(const core::Pose& start, const core::Vec3& direction, double distanceMm,
                           const core::Vec3& slideMm, double speedMmS);
/// Along the points at constant speed, every one pressed `depthMm` along `direction`, entered and left from
/// `clearanceMm` before it: a drag across cusp and fissure when the points lie on the surface.
[[nodiscard]] Motion drag(const std::vector<core::Vec3>& surfacePointsMm, const core::Quat& orientation,
                          const core::Vec3& direction, double depthMm, double clearanceMm, double speedMmS);
/// `turns` circles of radius `radiusMm` through the start pose, in the plane spanned by the two directions.
[[nodiscard]] Motion closedLoop(const core::Pose& start, const core::Vec3& firstAxis, const core::Vec3& secondAxis,
                                double radiusMm, double speedMmS, int turns);

}  // namespace handpiece::device
