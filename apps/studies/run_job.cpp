// SPDX-License-Identifier: Apache-2.0
#include "studies/run_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/tick/force/pose_guard.h"
#include "studies/progress_bar.h"
#include "studies/shaped_device.h"

namespace handpiece::studies {

double forceOf(const messages::HapticSample& s) {
    return std::sqrt(s.forceN[0] * s.forceN[0] + s.forceN[1] * s.forceN[1] + s.forceN[2] * s.forceN[2]);
}

void RunSummary::take(const messages::HapticSample& s, double periodS) {
    ++samples;
    durationS = s.timeS;
    peakForceN = std::max(peakForceN, forceOf(s));
    deepestMm = samples == 1 ? s.depthMm : std::max(deepestMm, s.depthMm);
    largestAreaMm2 = std::max(largestAreaMm2, s.contactAreaMm2);
    if (s.depthMm > 0.0) {
        touched = true;
        contactS += periodS;
    }
    limitedTicks += (s.flags & messages::kForceLimited) != 0;
    slopeLimitedTicks += (s.flags & messages::kSlopeLimited) != 0;
    faultTicks += (s.flags & (messages::kInvalidPose | messages::kFault)) != 0;
    removedMm3 = s.removedMm3;
    worstCutUs = std::max(worstCutUs, static_cast<double>(s.cutUs));
    stalledTicks += (s.flags & messages::kStalled) != 0;
    outOfBricksTicks += (s.flags & messages::kOutOfBricks) != 0;
    if ((s.flags & messages::kCutting) != 0) {
        leastRpm = cuttingTicks == 0 ? s.speedRpm : std::min(leastRpm, s.speedRpm);
        mostRpm = std::max(mostRpm, s.speedRpm);
        ++cuttingTicks;
    }
    truncatedTicks += s.contactStatus == static_cast<std::uint8_t>(contact::Status::truncated);
}

device::Motion readMotion(const std::string& file, const device::Capability& capability, double rateHz) {
    return readMotion(readCsv(file, {"t_s", "x_mm", "y_mm", "z_mm", "qw", "qx", "qy", "qz"}), capability, rateHz);
}

device::Motion readMotion(const CsvTable& table, const device::Capability& capability, double rateHz) {
    const double reachMm = capability.workspaceMm.norm(), fastestMmS = force::kMaxJumpMm * rateHz;
    std::vector<device::TimedPose> poses;
    poses.reserve(table.rows.size());
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        const device::TimedPose pose{table.rows[i][0], poseFrom(table.rows[i], 1, table, i), 0.0};
        if (i == 0) {
            if (pose.timeS < 0.0)
                throw core::Error(fmt::format("line {}: the time is {} s", table.lines[i], pose.timeS), table.source,
                                  "times start at 0 or later");
        } else {
            const device::TimedPose& last = poses.back();
            const double seconds = pose.timeS - last.timeS;
            const double way = (pose.burInTooth.positionMm - last.burInTooth.positionMm).norm();
            if (!(seconds > 0.0))
                throw core::Error(fmt::format("line {}: the time {} s does not come after {} s", table.lines[i],
                                              pose.timeS, last.timeS),
                                  table.source, "order the lines by rising time");
            if (way > reachMm)
                throw core::Error(fmt::format("line {}: a step of {:.6g} mm", table.lines[i], way), table.source,
                                  fmt::format("the device \"{}\" reaches {:.0f} mm from corner to corner; positions "
                                              "are in millimetres",
                                              capability.name, reachMm));
            if (way > fastestMmS * seconds)
                throw core::Error(
                    fmt::format("line {}: {:.6g} mm in {:.6g} s", table.lines[i], way, seconds), table.source,
                    fmt::format("no hand is faster than {:.3g} m/s; times are in seconds", fastestMmS * 1e-3));
        }
        poses.push_back(pose);
    }
    return device::Motion(std::move(poses));
}

namespace {

std::unique_ptr<device::Device> deviceOf(const RunSettings& settings, const device::Motion& motion) {
    if (settings.takeDevice) return settings.takeDevice();
    auto arm = std::make_unique<device::SimulatedDevice>(settings.device, motion);
    if (!settings.controller) return arm;
    stability::ShaperSettings shaping = studies::shaperSettingsFor(settings.device.capability);
    shaping.frictionN = settings.device.frictionN;
    shaping.massKg = settings.device.massKg;
    shaping.delayS = settings.device.delayS + 1.0 / settings.rateHz;
    return std::make_unique<studies::ShapedDevice>(std::move(arm), shaping);
}

}  // namespace

RunSummary runLoop(const RunSettings& settings, const device::Motion& motion, std::unique_ptr<contact::Method> method,
                   const loop::Listener& listener) {
    return runLoop(settings, motion, loop::Work{std::move(method), nullptr},
                   [&](loop::HapticLoop&, const messages::HapticSample& sample) { listener(sample); }, {});
}

RunSummary runLoop(const RunSettings& settings, const device::Motion& motion, loop::Work work,
                   const LoopListener& listener, const loop::BrickListener& bricks) {
    work.method->reset();  // whatever was felt on the way to this run leaves no trace in it
    loop::LoopSettings loopSettings;
    loopSettings.rateHz = settings.rateHz;
    loop::HapticLoop haptic(loopSettings, deviceOf(settings, motion), std::move(work), settings.parameters,
                            settings.drive);
    RunSummary summary;
    const double period = haptic.periodS();
    const loop::Listener each = [&](const messages::HapticSample& sample) {
        summary.take(sample, period);
        listener(haptic, sample);
        if (cancelled() || (settings.isDone && settings.isDone())) haptic.requestStop();
    };
    const double duration = settings.durationS > 0.0 ? settings.durationS : std::max(motion.durationS(), period);
    summary.report =
        settings.realTime ? runRealTime(haptic, duration, each, bricks) : runSimulated(haptic, duration, each, bricks);
    summary.stopped = cancelled();
    return summary;
}

RunRecord recordRun(const RunSettings& settings, const device::Motion& motion,
                    std::unique_ptr<contact::Method> method) {
    RunRecord record;
    record.summary = runLoop(settings, motion, std::move(method),
                             [&](const messages::HapticSample& sample) { record.samples.push_back(sample); });
    return record;
}

}  // namespace handpiece::studies
