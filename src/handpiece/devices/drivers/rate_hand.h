// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A pose out of a deflection: what a SpaceMouse's cap and a gamepad's sticks steer.

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/devices/link/driver.h"

namespace handpiece::drivers {

struct RateHandSettings {
    double speedMmS = 60.0, turnRadS = 1.2;           ///< at full deflection
    double deadZone = 0.05;                           ///< of a deflection, of 1
    core::Vec3 reachMm = core::Vec3::Constant(60.0);  ///< it goes no farther from the middle, axis by axis
    double mostTurnRad = 1.4;                         ///< and is turned no farther
    double returnMmS = 40.0, returnRadS = 0.8;        ///< on its way back to the middle
};

/// Plain arithmetic in the time it is told; device frame.
class RateHand {
  public:
    explicit RateHand(const RateHandSettings& settings) noexcept : settings_(settings) {}

    /// Lets `dtS` pass with the deflections (-1..1 on each axis; more is 1, what is no number is none), or on the way
    /// back to the middle. A machine that slept makes one step of 50 ms, no leap.
    void step(const core::Vec3& move, const core::Vec3& turn, bool goHome, double dtS) noexcept HANDPIECE_REALTIME;
    /// Its pose, as a device's.
    void tell(link::DriverReading& reading) const noexcept HANDPIECE_REALTIME;
    [[nodiscard]] const core::Vec3& positionMm() const noexcept { return positionMm_; }
    [[nodiscard]] const core::Quat& orientation() const noexcept { return orientation_; }

  private:
    RateHandSettings settings_;
    core::Vec3 positionMm_ = core::Vec3::Zero();
    core::Quat orientation_ = core::Quat::Identity();
};

}  // namespace handpiece::drivers
