// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The last thing between a computed force and a person's hand. Lives in the driver's servo thread, so it watches the
/// tick, its own device and the force at once; every doubt ends in zero force.

#include <cstdint>

#include "handpiece/base/core/realtime.h"
#include "handpiece/devices/link/driver.h"

namespace handpiece::safety {

struct GateSettings {
    double maxForceN = 3.3, maxTorqueNmm = 0.0, maxSlopeNPerS = 5000.0;  ///< the device's record
    double maxTorqueSlopeNmmPerS = 1e5;  ///< from none to the largest as fast as the force
    double fadeInS = 0.3;                ///< from zero, at the first force after start and after every pause or trouble
    double commandTimeoutS = 0.004;      ///< a command older than this is none: the simulation stands
    double readingTimeoutS = 0.004;      ///< two readings farther apart than this: the device stood
    double releaseS = 0.004;             ///< from any force to zero once in doubt; with the timeouts under 10 ms
    double maxSpeedMmS = 5000.0;         ///< a pose that moved faster has jumped
    double clearAfterS = 0.05;           ///< without doubt, before a force is let through again
    double warmFrom = 0.8, hotFrom = 0.98;  ///< of motorTemperature: force fades from one to the other
};
/// From a capability, the rest as above; the reading timeout of a servo slower than 625 Hz is 2.5 of its periods.
/// Throws core::Error for values out of range.
[[nodiscard]] GateSettings gateSettingsFor(const device::Capability& capability);
/// Throws core::Error naming the value.
void validate(const GateSettings& settings);

/// What the gate did, for everybody else; plain.
struct GateStatus {
    link::DeviceFault trouble = link::DeviceFault::starting;  ///< now
    link::DeviceFault last = link::DeviceFault::none;         ///< the newest one there was
    std::int32_t vendorCode = 0;
    std::uint64_t troubles = 0;  ///< how many there have been since the start
    std::int64_t troubleSinceNs = 0;
    double gain = 0.0;  ///< 0..1 of the force that is let through
    bool clamped = false, slopeLimited = false;
    float motorTemperature = -1.0f;
};

/// One device's gate. One thread (the driver's). Its answer to each reading is within the limits, whatever comes in.
///
/// While all is well: force and torque clamped, faded in and out, and changed no faster than their slope times the time
/// since the exchange before. In doubt: from the force that was, straight to zero within releaseS (the slope does not
/// stretch that), and zero until there was no doubt for clearAfterS; then the next force fades in. Of a servo slower
/// than 1/releaseS the first answer in doubt is zero.
class Gate {
  public:
    explicit Gate(const GateSettings& settings) noexcept;
    /// What may be sent now for the latest command, at a reading. `nowNs` is rt::monotonicNs() or a test's own time.
    [[nodiscard]] link::DriverCommand pass(const link::DriverReading& reading, const link::DriverCommand& latest,
                                           std::int64_t nowNs) noexcept HANDPIECE_REALTIME;
    [[nodiscard]] const GateStatus& status() const noexcept { return status_; }

  private:
    [[nodiscard]] link::DeviceFault judge(const link::DriverReading& reading, const link::DriverCommand& latest,
                                          std::int64_t nowNs) noexcept;
    [[nodiscard]] link::DeviceFault judgePose(const link::DriverReading& reading, double elapsedS) noexcept;
    [[nodiscard]] link::DeviceFault judgeCommand(const link::DriverCommand& latest, std::int64_t nowNs) noexcept;
    void believe(link::DeviceFault found, const link::DriverReading& reading, std::int64_t nowNs) noexcept;
    [[nodiscard]] link::DriverCommand released(double elapsedS) noexcept;
    [[nodiscard]] link::DriverCommand let(const link::DriverCommand& latest, float temperature,
                                          double elapsedS) noexcept;

    GateSettings settings_;
    GateStatus status_;
    link::DriverReading lastReading_;  // the last whose pose is made of numbers
    link::DriverCommand sent_, held_;  // held: what was sent when the doubt began
    std::int64_t lastNs_ = 0, wellSinceNs_ = 0, frameSinceNs_ = 0, commandSinceNs_ = 0;
    std::uint64_t frame_ = 0, number_ = 0;
    double fade_ = 0.0, release_ = 0.0;
    bool any_ = false, well_ = false, fading_ = false, posed_ = false;
};

}  // namespace handpiece::safety
