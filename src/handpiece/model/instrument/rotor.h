// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What turns the bur: an air turbine or a low-speed handpiece, its torque, its inertia, its pedal.

#include <string>
#include <string_view>
#include <vector>

#include "handpiece/base/core/realtime.h"

namespace handpiece::instrument {

/// Torque falls in a straight line from stall to free speed (Dyson & Darvell 1999). docs/physics.md#turbine.
struct Drive {
    std::string name = "turbine";
    std::string description;
    double freeSpeedRpm = 400000;
    double stallTorqueNmm = 1.2;
    double inertiaNmmS2 = 1e-5;
    double bearingTorqueNmm = 0.2;  ///< that stops the rotor when the air is off
};
/// "turbine" (high speed), "weak-turbine", "low-speed" (1:1), "speed-increasing" (1:5).
[[nodiscard]] const std::vector<Drive>& drives();
/// Throws core::Error naming the drives there are.
[[nodiscard]] const Drive& driveByName(std::string_view name);
/// Throws core::Error naming the value that is not finite or not above zero.
void validate(const Drive& drive);

/// The speed of the bur. One thread; the same inputs, the same bits.
class Rotor {
  public:
    explicit Rotor(const Drive& drive) noexcept;
    /// Lets `periodS` pass: J w' = stall x pedal x (1 - w / free) - bearing x (1 - pedal) - load; solved exactly for
    /// constant load, so any period is stable; never turns backwards. `pedal` 0..1 is the air (stall and free speed are
    /// those of full air, bearing included); without it the bearing stops the rotor. Plain arithmetic only: the same
    /// bits on every machine.
    void step(double pedal, double loadTorqueNmm, double periodS) noexcept HANDPIECE_REALTIME;
    void setDrive(const Drive& drive) noexcept HANDPIECE_REALTIME;
    /// To go on from a record. Throws core::Error unless it is finite and from 0 to 10^6 or the free speed: after a
    /// change of drive it may turn faster than that. Not from the tick.
    void setSpeedRpm(double rpm);
    [[nodiscard]] double speedRadS() const noexcept { return speedRadS_; }
    [[nodiscard]] double speedRpm() const noexcept;
    /// The load is more than the drive can turn against and the bur stands.
    [[nodiscard]] bool stalled() const noexcept { return stalled_; }

  private:
    double freeRadS_ = 0.0, stallNmm_ = 0.0, inertia_ = 1.0, bearingNmm_ = 0.0, speedRadS_ = 0.0;
    bool stalled_ = false;
};

}  // namespace handpiece::instrument
