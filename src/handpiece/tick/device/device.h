// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A haptic device as the tick sees it: a pose to read, a force to command, and a record of what it can do.

#include <cstdint>
#include <string>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"

namespace handpiece::device {

/// What a device can do. Force is limited by it, always.
struct Capability {
    std::string name;
    double maxForceN = 3.3;  ///< peak
    double continuousForceN = 0.88;
    double maxStiffnessNPerMm = 0.5;  ///< rendered stably without help
    double maxDampingNSPerMm = 0.005;
    double maxForceSlopeNPerS = 5000;  ///< largest change of the commanded force
    double maxTorqueNmm = 0.0;         ///< 0: no torque axes
    double encoderStepMm = 0.055;
    core::Vec3 workspaceMm{160, 120, 70};
    int sensedAxes = 6, drivenAxes = 3;
    double rateHz = 1000;
};

enum class ReadStatus : std::uint8_t { ok, lost };

/// A simulated hand takes the handpiece out of the mouth and brings it in again: on the way it touches nothing, without
/// force, and until it is clear. A button, since those are recorded to the bit and replayed. No device's own.
inline constexpr std::uint32_t kRegripsButton = 1u << 31;

/// The handpiece's pose as the device reports it.
struct Reading {
    core::Pose burInTooth;
    double pedal = 0.0;         ///< 0..1
    std::uint32_t buttons = 0;  ///< bit 0: the upper one
    ReadStatus status = ReadStatus::ok;
};

class Device {
  public:
    virtual ~Device() = default;
    [[nodiscard]] virtual const Capability& capability() const noexcept = 0;
    /// Called once at the start of each tick of `periodS`.
    virtual Reading read(double periodS) noexcept HANDPIECE_REALTIME = 0;
    /// Force on the hand [N] and torque about the grip [N mm], tooth frame; holds until the next call.
    virtual void command(const core::Vec3& forceN, const core::Vec3& torqueNmm) noexcept HANDPIECE_REALTIME = 0;
    /// Amplitude of the bur's hum [N], which is in the force already: for what has no force but can shake. Each tick,
    /// after command().
    virtual void vibrate(double amplitudeN) noexcept HANDPIECE_REALTIME { (void)amplitudeN; }
    /// Where the bur rests and with what force the whole instrument bears on what it meets there [N], wherever that is:
    /// for a simulated hand, which watches its tip as a person does. Each tick, before command().
    virtual void watch(const core::Vec3& tipMm, const core::Vec3& bearingN) noexcept HANDPIECE_REALTIME {
        (void)tipMm;
        (void)bearingN;
    }
    /// For records: where the device truly is and what force acts on it now. Real devices return what they know.
    virtual core::Vec3 truePositionMm() const noexcept = 0;
    virtual core::Vec3 appliedForceN() const noexcept = 0;
};

}  // namespace handpiece::device
