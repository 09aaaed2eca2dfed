// SPDX-License-Identifier: Apache-2.0
#include "storm.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/devices/drivers/simulated_driver.h"
#include "handpiece/devices/link/passing_driver.h"
#include "handpiece/devices/safety/guarded_device.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/record/session/recorder.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/loop/loop_run.h"
#include "support/small_molar.h"

namespace handpiece::safety {
namespace {

using core::Pose;
using core::Quat;
using core::Vec3;

constexpr double kZeroWithinS = 0.010;

/// Writes down what reaches the device, between it and everything else.
class Witness final : public link::PassingDriver {
  public:
    Witness(std::unique_ptr<link::Driver> driver, std::vector<Sent>& sent)
        : PassingDriver(std::move(driver)), sent_(sent) {}
    ~Witness() override { PassingDriver::stop(); }
    [[nodiscard]] link::DriverCommand exchange(const link::DriverReading& reading) noexcept override {
        const link::DriverCommand command = PassingDriver::exchange(reading);
        if (sent_.size() < sent_.capacity()) sent_.push_back({reading.timeNs, command.timeNs, command.forceN});
        return command;
    }

  private:
    std::vector<Sent>& sent_;
};

/// A hand that works its way over the crown: down, a stroke, up, elsewhere. Every third stroke only touches: a bur that
/// cuts gives way, so the larger forces are felt there.
device::Motion strokes(double topMm, double durationS) {
    std::vector<device::TimedPose> poses;
    double t = 0.0, pedal = 1.0;
    const auto go = [&](double forS, double x, double y, double z) {
        t += forS;
        poses.push_back({t, {Vec3(x, y, z), Quat::Identity()}, pedal});
    };
    go(0.0, 0, 0, topMm + 0.5);
    for (int i = 0; t < durationS; ++i) {
        const double x = 3.8 * std::sin(1.7 * i), y = 3.2 * std::sin(2.3 * i + 1.0);
        const double deep = topMm - 4.0 - 6.0 * t / durationS;  // what is cut away is not felt again
        pedal = i % 3 == 2 ? 0.0 : 1.0;
        go(0.1, x, y, topMm + 0.5);
        go(0.15, x, y, deep);
        go(1.2, x + 0.8, y, deep);
        go(1.2, x - 0.4, y + 0.3, deep);
        go(0.15, x, y, topMm + 0.5);
    }
    return device::Motion(std::move(poses));
}

double length(const std::array<double, 3>& v) {
    return std::hypot(v[0], v[1], v[2]);
}

}  // namespace

Storm cutInAStorm(const StormSettings& settings) {
    static const std::shared_ptr<const tooth::ToothModel> base = test::smallMolar(0.12);
    std::vector<Fault> faults = parseFaults(settings.faults);
    const double durationS =
        settings.durationS > 0.0 ? settings.durationS : faults.back().atS + faults.back().lastsS + 1.0;

    drivers::SimulatedSettings simulated;
    simulated.motion = strokes(base->outer.bounds().max.z(), durationS);
    simulated.arm.hand = device::handByName("stiff");
    simulated.arm.subStepS = 1e-4;
    simulated.arm.capability.maxForceSlopeNPerS = settings.slopeNPerS;
    simulated.servoHz = settings.servoHz;
    simulated.stepped = !settings.realTime;
    // Not how the tooth lies by default: what is turned the wrong way would be seen.
    simulated.placing.deviceMm = Vec3(10, -20, 30);
    simulated.placing.toothInDevice = Quat(Eigen::AngleAxisd(-1.3, Vec3(1, 0.2, 0.1).normalized()));

    Storm storm;
    storm.largestN = simulated.arm.capability.maxForceN;
    storm.slopeNPerS = settings.slopeNPerS;
    storm.sent.reserve(static_cast<std::size_t>(1.2 * settings.servoHz * durationS) + 10000);

    GuardSettings guard;
    guard.placing = simulated.placing;
    auto driver = std::make_unique<drivers::SimulatedDriver>(simulated);
    if (drivers::SimulatedDriver* servo = driver.get(); simulated.stepped) {
        guard.nowNs = [servo] { return servo->nowNs(); };
        guard.advance = [servo](double periodS) { servo->step(periodS); };
    }
    guard.gate = gateSettingsFor(driver->info().capability);
    const auto log = std::make_shared<FaultLog>();
    auto device = std::make_unique<GuardedDevice>(
        withFaults(std::make_unique<Witness>(std::move(driver), storm.sent), std::move(faults), log), guard);
    const std::shared_ptr<HealthBoard> health = device->health();

    const auto field = std::make_shared<tooth::ToothState>(base);
    const auto bur = std::make_shared<const instrument::Bur>(instrument::makeBur("round:1.0x1.0"));
    loop::LoopSettings loopSettings;
    loopSettings.rateHz = settings.tickHz;
    std::unique_ptr<session::Recorder> recorder;
    if (!settings.session.empty()) {
        session::SessionInfo info;
        info.rateHz = settings.tickHz;
        info.settings = "{}";
        recorder = std::make_unique<session::Recorder>(settings.session, info);
    }
    {
        loop::HapticLoop haptic(
            loopSettings, std::move(device),
            {contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(field), bur),
             std::make_unique<cutting::Cutter>(field, bur, instrument::CuttingParameters{}, cases::builtInTissues(),
                                               cutting::Cutter::Settings{})},
            force::defaultParameters());
        const loop::Listener listen = [&](const messages::HapticSample& s) {
            storm.removedMm3 = 0.0;
            for (const double v : s.removedMm3)
                storm.removedMm3 += v;
            if (recorder) recorder->pushWaiting(session::recordOf(s));
            ++storm.ticks;
        };
        (void)(settings.realTime ? runRealTime(haptic, durationS, listen) : runSimulated(haptic, durationS, listen));
        const Health end = health->read();
        storm.relaxed = end.relaxed;
        storm.troubles = end.gate.troubles;
    }
    if (recorder) recorder->close();
    storm.outcomes = log->outcomes();
    storm.output = log->output();
    for (const Sent& s : storm.sent)
        storm.forcedS += length(s.forceN) > 0.5 ? 1.0 / settings.servoHz : 0.0;
    return storm;
}

std::vector<std::string> judge(const Storm& storm) {
    std::vector<std::string> wrong;
    const auto tell = [&](std::string what) {
        if (wrong.size() < 10) wrong.push_back(std::move(what));
    };
    std::size_t fault = 0;
    for (std::size_t i = 0; i < storm.sent.size(); ++i) {
        const Sent& now = storm.sent[i];
        const double force = length(now.forceN);
        if (!(force <= storm.largestN * (1.0 + 1e-9))) tell(fmt::format("{} N at sample {}", force, i));
        if (i > 0) {
            const Sent& before = storm.sent[i - 1];
            const double elapsedS = static_cast<double>(now.passedNs - before.passedNs) * 1e-9;
            const double change = std::hypot(now.forceN[0] - before.forceN[0], now.forceN[1] - before.forceN[1],
                                             now.forceN[2] - before.forceN[2]);
            // A release is steeper: it takes a share of the force that was and nothing of its direction.
            const double fell = length(before.forceN) - force;
            const bool release = std::abs(change - fell) < 1e-9;
            if (!release && !(change <= storm.slopeNPerS * elapsedS + 1e-9))
                tell(fmt::format("{} N within {} s at sample {}", change, elapsedS, i));
        }
        while (fault + 1 < storm.outcomes.size() && storm.outcomes[fault + 1].beganNs <= now.timeNs)
            ++fault;
        if (storm.outcomes.empty() || storm.outcomes[fault].beganNs > now.timeNs) continue;
        const FaultOutcome& outcome = storm.outcomes[fault];
        const double sinceS = static_cast<double>(now.timeNs - outcome.beganNs) * 1e-9;
        // 50 ms after its end a force may come again, not sooner; a fault too short to be noticed is none.
        const double untilS = outcome.told ? std::max(outcome.fault.lastsS, kZeroWithinS) + 0.04 : 0.0;
        if (sinceS >= kZeroWithinS && sinceS < untilS && force != 0.0) {
            tell(fmt::format("{} N {:.1f} ms after {} of {:.1f} ms began ({} N before)", force, 1e3 * sinceS,
                             nameOf(outcome.fault.kind), 1e3 * outcome.fault.lastsS, outcome.forceBeforeN));
        }
    }
    return wrong;
}

std::string table(const Storm& storm) {
    std::string text = fmt::format("  {:8} {:>6} {:>6} {:>9} {:>9} | to zero [ms] {:>6} {:>6} {:>6}\n", "fault",
                                   "count", "told", "before N", "largest N", "p50", "p99", "worst");
    const auto line = [&](std::string_view name, const auto& belongs) {
        std::vector<double> toZeroMs;
        double before = 0.0, largest = 0.0;
        std::size_t count = 0, told = 0;
        for (const FaultOutcome& o : storm.outcomes) {
            if (!belongs(o)) continue;
            ++count;
            told += o.told;
            before = std::max(before, o.forceBeforeN);
            largest = std::max(largest, o.largestN);
            if (o.told && o.forceBeforeN > 0.0) toZeroMs.push_back(o.toZeroS < 0.0 ? INFINITY : 1e3 * o.toZeroS);
        }
        if (count == 0) return;
        std::sort(toZeroMs.begin(), toZeroMs.end());
        const auto at = [&](double share) {
            return toZeroMs.empty()
                       ? 0.0
                       : toZeroMs[static_cast<std::size_t>(share * static_cast<double>(toZeroMs.size() - 1))];
        };
        text += fmt::format("  {:8} {:6} {:6} {:9.2f} {:9.2f} | pushing: {:4} {:6.2f} {:6.2f} {:6.2f}\n", name, count,
                            told, before, largest, toZeroMs.size(), at(0.5), at(0.99), at(1.0));
    };
    for (std::size_t k = 0; k < kFaultKinds; ++k) {
        const auto kind = static_cast<FaultKind>(k);
        line(nameOf(kind), [&](const FaultOutcome& o) { return o.fault.kind == kind; });
    }
    line("all", [](const FaultOutcome&) { return true; });
    return text;
}

}  // namespace handpiece::safety
