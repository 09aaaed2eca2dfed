// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What is added to the force on its way to the hand: the knock of a strike and the hum of the bur.

#include "handpiece/base/core/realtime.h"
#include "handpiece/tick/force/contact_transient.h"
#include "handpiece/tick/force/cutting_vibration.h"
#include "handpiece/tick/force/force_model.h"

namespace handpiece::force {

/// What the bur was doing a tick ago.
struct BurAtWork {
    double speedRpm = 0.0;
    double feedMmS = 0.0;
};

/// Adds to a force that ForceModel has made, after it and outside of it: the load that cuts, the torque and the next
/// tick's force know nothing of it. The sum stays within the device's force and slope, and the knock never makes it
/// pull. Switched off it hands the force on, bit for bit. One thread.
class EventBasedForce {
  public:
    EventBasedForce(const Limits& limits, double rateHz) noexcept;

    /// The force to send instead of `command.forceN`. `feel` has made that command for `touch`.
    [[nodiscard]] const core::Vec3& add(const ForceModel& feel, const Touch& touch, const ForceCommand& command,
                                        const BurAtWork& bur, double periodS) noexcept HANDPIECE_REALTIME;

    [[nodiscard]] const core::Vec3& forceN() const noexcept { return forceN_; }
    [[nodiscard]] bool forceLimited() const noexcept { return forceLimited_; }
    [[nodiscard]] bool slopeLimited() const noexcept { return slopeLimited_; }
    /// Amplitude of the hum now, for what can only shake.
    [[nodiscard]] double vibrationN() const noexcept { return hum_.amplitudeN(); }

  private:
    Limits limits_;
    ContactTransient knock_;
    BurHum hum_;
    core::Vec3 forceN_ = core::Vec3::Zero();
    bool forceLimited_ = false, slopeLimited_ = false, adding_ = false;
};

}  // namespace handpiece::force
