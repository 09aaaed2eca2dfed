// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Believes a device's pose, or not: any doubt ends in zero force, ramped, and a flag.

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"

namespace handpiece::force {

inline constexpr double kMaxJumpMm = 20.0;    ///< in one tick: 20 m/s at 1 kHz
inline constexpr double kReleaseS = 0.01;     ///< from full force to none after a fault
inline constexpr double kClearAfterS = 0.05;  ///< a pose is believed again after this long without doubt

/// Watches the poses of one device. A pose that is not finite or no rotation, that jumped, or that the driver reports
/// lost starts a fault: gain() falls to zero within kReleaseS, stays there until the poses have been good for
/// kClearAfterS, then rises to one over the fade-in. One thread.
class PoseGuard {
  public:
    /// Looks at the pose of this tick.
    void look(const core::Pose& read, bool lost, double periodS, double fadeInS) noexcept HANDPIECE_REALTIME;

    /// The last pose that can be worked with: always finite.
    [[nodiscard]] const core::Pose& pose() const noexcept { return pose_; }
    [[nodiscard]] double gain() const noexcept { return gain_; }     ///< of the force, 0..1
    [[nodiscard]] bool invalidNow() const noexcept { return bad_; }  ///< this tick's pose is not believed
    [[nodiscard]] bool faulted() const noexcept { return fault_; }   ///< force goes to zero or is held there
    /// True in the tick in which a pose is believed for the first time, or again: what depends on the way here starts
    /// anew.
    [[nodiscard]] bool startsAnew() const noexcept { return startsAnew_; }
    /// Lets a new start fade in from nothing (a bur that starts inside a tooth).
    void fadeIn() noexcept { gain_ = 0.0; }

  private:
    core::Pose pose_, lastValid_;
    bool seen_ = false, started_ = false, bad_ = false, fault_ = false, startsAnew_ = false;
    double goodS_ = 0.0, gain_ = 1.0;
};

}  // namespace handpiece::force
