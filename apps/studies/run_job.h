// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// One run of the haptic loop on the simulated device: from names to a motion, from a motion to samples.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "handpiece/tick/contact/method.h"
#include "handpiece/tick/device/motion.h"
#include "handpiece/tick/device/simulated_device.h"
#include "handpiece/tick/force/parameters.h"
#include "handpiece/tick/loop/loop_run.h"
#include "studies/csv.h"

namespace handpiece::studies {

struct RunSettings {
    double rateHz = 1000.0;
    double durationS = 0.0;  ///< 0: as long as the motion
    bool realTime = false;
    device::SimulatedDeviceSettings device;
    force::Parameters parameters = force::defaultParameters();
    instrument::Drive drive;
    /// Gives the device instead of a simulated arm of `device`, once; empty: none.
    std::function<std::unique_ptr<device::Device>()> takeDevice;
    /// Ends the run before its duration; asked after each tick. Empty: nothing does.
    std::function<bool()> isDone;
    bool controller = false;  ///< of a simulated arm: stability::Shaper on its force
};

/// What a run comes to, gathered sample by sample.
struct RunSummary {
    double durationS = 0.0, peakForceN = 0.0, deepestMm = 0.0, contactS = 0.0, largestAreaMm2 = 0.0;
    std::uint64_t samples = 0, limitedTicks = 0, slopeLimitedTicks = 0, faultTicks = 0, truncatedTicks = 0;
    bool touched = false, stopped = false;  ///< stopped: by Ctrl-C
    std::array<double, cases::kTissueCount> removedMm3{};
    double leastRpm = 0.0, mostRpm = 0.0, worstCutUs = 0.0;  ///< speed while cutting
    std::uint64_t cuttingTicks = 0, stalledTicks = 0, outOfBricksTicks = 0;
    loop::RunReport report;
    void take(const messages::HapticSample& sample, double periodS);
};

/// The poses in a CSV file of t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz. Throws core::Error with the line of whatever could not
/// be moved along: times that do not rise, steps wider than the device's workspace or faster than the loop believes.
[[nodiscard]] device::Motion readMotion(const std::string& file, const device::Capability& capability, double rateHz);
/// The same from a table of these columns, in this order.
[[nodiscard]] device::Motion readMotion(const CsvTable& table, const device::Capability& capability, double rateHz);

/// Runs `motion`; `listener` gets each sample in order, may throw. Ends early, cleanly, when cancelled().
RunSummary runLoop(const RunSettings& settings, const device::Motion& motion, std::unique_ptr<contact::Method> method,
                   const loop::Listener& listener);
/// The same for a tooth that is cut: `listener` may give the loop commands (undo), `bricks` hears what was cut.
using LoopListener = std::function<void(loop::HapticLoop&, const messages::HapticSample&)>;
RunSummary runLoop(const RunSettings& settings, const device::Motion& motion, loop::Work work,
                   const LoopListener& listener, const loop::BrickListener& bricks);

/// runLoop() with all samples kept: about 0.4 kB each.
struct RunRecord {
    RunSummary summary;
    std::vector<messages::HapticSample> samples;
};
[[nodiscard]] RunRecord recordRun(const RunSettings& settings, const device::Motion& motion,
                                  std::unique_ptr<contact::Method> method);

/// Length of a sample's commanded force [N].
[[nodiscard]] double forceOf(const messages::HapticSample& sample);

}  // namespace handpiece::studies
