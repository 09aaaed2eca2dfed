// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Faults while a molar is cut: the whole chain from the simulated arm to the tooth and back, and a judge of every
/// force that reaches the arm.

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "handpiece/devices/safety/injector.h"

namespace handpiece::safety {

/// Every frame as the device saw it: what it was sent, and when.
struct Sent {
    std::int64_t timeNs = 0;    ///< of the reading
    std::int64_t passedNs = 0;  ///< when the gate answered it; older while a servo stands
    std::array<double, 3> forceN{};
};

struct StormSettings {
    std::string faults;
    double durationS = 0.0;  ///< 0: until a second after the last fault
    bool realTime = false;   ///< threads and wall clock, else virtual time
    double servoHz = 1000.0, tickHz = 1000.0;
    double slopeNPerS = 700.0;      ///< of the device: so low that it is met
    std::filesystem::path session;  ///< empty: none is recorded
};

struct Storm {
    std::vector<FaultOutcome> outcomes;
    GateOutput output;
    std::vector<Sent> sent;
    double removedMm3 = 0.0, forcedS = 0.0;  ///< cut; time with a force of more than half a newton
    std::uint64_t ticks = 0, relaxed = 0, troubles = 0;
    double largestN = 3.3, slopeNPerS = 0.0;  ///< the device's limits
};

/// Cuts a lower molar, coarse but real, with these faults.
[[nodiscard]] Storm cutInAStorm(const StormSettings& settings);

/// What is wrong with what the device was sent; empty: nothing. In every sample within the force; rising within the
/// slope; zero from 10 ms after a fault's beginning to its end.
[[nodiscard]] std::vector<std::string> judge(const Storm& storm);

/// One line a kind: how many, force before, largest after, p50, p99 and worst time to zero.
[[nodiscard]] std::string table(const Storm& storm);

}  // namespace handpiece::safety
