// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a check records of a device, frame by frame and tick by tick, before anything is judged. Private to this room.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "handpiece/base/rt/realtime_thread.h"
#include "handpiece/devices/fidelity/fidelity.h"
#include "handpiece/devices/safety/guarded_device.h"

namespace handpiece::fidelity {

/// One frame of the device's servo.
struct FrameRecord {
    std::int64_t readNs = 0, atNs = 0;  ///< when its pose was read; when it asked for a force
    std::array<double, 3> positionMm{}, sentN{};
    float motorTemperature = -1.0f;
    link::DeviceFault trouble = link::DeviceFault::none;
};

struct TickRecord {
    std::int64_t atNs = 0, lateNs = 0;
    std::int64_t ageNs = -1;  ///< of the newest frame then; below 0: none yet
    std::int32_t periods = 1;
};

/// A step of the force, up along the device's +y.
struct Pulse {
    std::int64_t commandedNs = 0;
    double fromN = 0.0, toN = 0.0;
};

/// When what happens, from the first frame on.
struct Plan {
    double restS = 0.0, warmUpS = 0.0;  ///< without force; with a tenth of it, until the gate has faded in
    double everyS = 0.2, pulseS = 0.06;
    double pulseN = 0.0, biasN = 0.0;
    int pulses = 0;
    [[nodiscard]] double forceAt(double timeS) const noexcept;
};
[[nodiscard]] Plan planFor(const CheckSettings& settings, const device::Capability& capability);

struct Recording {
    link::DriverInfo info;
    CheckSettings settings;
    Plan plan;
    std::vector<FrameRecord> frames;
    std::vector<TickRecord> ticks;
    std::vector<Pulse> pulses;
    safety::Health health;  ///< at the end
    double gateTimeoutS = 0.004, maxSlopeNPerS = 0.0;
    link::CalibrationState calibration = link::CalibrationState::notNeeded;
    std::string calibrationStep;
    rt::SchedulingGrant grant;
    std::uint64_t lost = 0;    ///< records that did not fit
    std::int64_t startNs = 0;  ///< first frame
};

/// Percentiles of a list, which it sorts.
struct Quantiles {
    double p50 = 0, p99 = 0, p999 = 0, worst = 0;
};
[[nodiscard]] Quantiles quantilesOf(std::vector<double> values);

/// How long from a force sent until the arm is seen to move, over all pulses.
struct Delay {
    bool measured = false;
    double seconds = 0.0, uncertaintyS = 0.0;
    double pathMm = 0.0;  ///< that a pulse moved it
    config::Phrase why;   ///< when it was not measured
};
[[nodiscard]] Delay roundTripOf(const Recording& recording);

/// Steps of the encoders and the noise of a pose at rest.
struct Rest {
    bool moved = false;    ///< it was not at rest
    double noiseMm = 0.0;  ///< root mean square about its mean over 50 ms, worst axis
    double stepMm = -1.0;  ///< smallest change between two frames; below 0: too few changes
};
[[nodiscard]] Rest restOf(const Recording& recording);

/// Everything of a recording, judged.
[[nodiscard]] Report judge(const Recording& recording);

/// Of this machine: one line, nothing personal.
[[nodiscard]] std::string machineLine(const rt::SchedulingGrant& grant);
[[nodiscard]] Finding governorFinding();
[[nodiscard]] Finding usbFinding(const std::string& driver);

}  // namespace handpiece::fidelity
