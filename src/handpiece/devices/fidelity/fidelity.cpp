// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/fidelity/fidelity.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/base/rt/second.h"
#include "handpiece/base/rt/spsc_queue.h"
#include "handpiece/devices/fidelity/recording.h"
#include "handpiece/devices/link/passing_driver.h"

namespace handpiece::fidelity {
namespace {

using core::Vec3;
using rt::kNsPerS;
constexpr double kFirstFrameS = 5.0;      // a device that tells no pose in this time tells none
constexpr double kWarmUpS = 0.5;          // the gate's fade-in and something
constexpr double kPulseN = 0.8;           // under what an Omni-class arm may hold for long (0.88 N [R])
constexpr std::size_t kQueue = 1u << 16;  // of frames: 16 s at 4 kHz before the reader must come

/// Between guard and driver: every frame and the gate's answer to it, on their way, untouched.
class Tap final : public link::PassingDriver {
  public:
    Tap(std::unique_ptr<link::Driver> driver, std::function<std::int64_t()> nowNs)
        : PassingDriver(std::move(driver)), nowNs_(std::move(nowNs)), frames(kQueue) {}

    [[nodiscard]] link::DriverCommand exchange(const link::DriverReading& reading) noexcept override {
        FrameRecord record;
        record.atNs = nowNs_();
        const link::DriverCommand answer = PassingDriver::exchange(reading);
        record.readNs = reading.timeNs;
        record.positionMm = reading.positionMm;
        record.sentN = answer.forceN;
        record.motorTemperature = reading.motorTemperature;
        record.trouble = reading.trouble;
        (void)frames.tryPush(record);
        newestNs.store(reading.timeNs, std::memory_order_release);
        return answer;
    }

  private:
    std::function<std::int64_t()> nowNs_;

  public:
    rt::SpscQueue<FrameRecord> frames;
    std::atomic<std::int64_t> newestNs{0};  // of a reading; 0: none yet
};

/// The tick's side: reads, commands what the plan says, notes when.
class Ticker {
  public:
    Ticker(safety::GuardedDevice& device, Tap& tap, const Plan& plan, double periodS,
           std::function<std::int64_t()> nowNs)
        : device_(device), tap_(tap), plan_(plan), periodS_(periodS), nowNs_(std::move(nowNs)) {}

    /// True while there is more to do; afterwards nothing is noted any more.
    bool tick(double durationS, std::int64_t lateNs, std::int64_t periods) noexcept {
        (void)device_.read(periodS_ * static_cast<double>(periods));
        const std::int64_t now = nowNs_(), newest = tap_.newestNs.load(std::memory_order_acquire);
        if (firstNs_ == 0 && newest != 0) firstNs_ = now;
        const double timeS = firstNs_ == 0 ? 0.0 : static_cast<double>(now - firstNs_) / kNsPerS;
        const double forceN = firstNs_ == 0 ? 0.0 : plan_.forceAt(timeS);
        if (forceN > lastN_ && forceN >= plan_.pulseN && plan_.pulses > 0) (void)pulses.tryPush({now, lastN_, forceN});
        lastN_ = forceN;
        device_.command(Vec3(0.0, forceN, 0.0), Vec3::Zero());
        if (firstNs_ != 0 && timeS < durationS)
            (void)ticks.tryPush(
                {now, lateNs, now - newest, static_cast<std::int32_t>(std::min<std::int64_t>(periods, 1 << 30))});
        elapsedS.store(timeS, std::memory_order_relaxed);
        return timeS < durationS;
    }

    rt::SpscQueue<TickRecord> ticks{kQueue};
    rt::SpscQueue<Pulse> pulses{1024};
    std::atomic<double> elapsedS{0.0};
    std::atomic<bool> stop{false}, ended{false};

  private:
    safety::GuardedDevice& device_;
    Tap& tap_;
    const Plan& plan_;
    double periodS_;
    std::function<std::int64_t()> nowNs_;
    std::int64_t firstNs_ = 0;
    double lastN_ = 0.0;
};

template <class T>
void drain(rt::SpscQueue<T>& from, std::vector<T>& to) {
    T item;
    while (from.tryPop(item))
        to.push_back(item);
}

void validate(const CheckSettings& s) {
    const double least = s.push ? 2.0 : 1.0;
    if (!(s.durationS >= least && s.durationS <= 600.0))
        throw core::Error(fmt::format("a check of {:.6g} s", s.durationS), "duration",
                          fmt::format("give {:.0f} to 600 s", least));
    if (!(s.rateHz >= 100.0 && s.rateHz <= 10000.0))
        throw core::Error(fmt::format("a tick of {:.6g} Hz", s.rateHz), "rate", "give 100 to 10000");
}

}  // namespace

double Plan::forceAt(double timeS) const noexcept {
    const double since = timeS - restS;
    if (pulses == 0 || since < 0.0) return 0.0;
    const double after = since - warmUpS;
    if (after < 0.0) return biasN;
    const int which = static_cast<int>(after / everyS);
    if (which >= pulses) return 0.0;
    return after - which * everyS < pulseS ? pulseN : biasN;
}

Plan planFor(const CheckSettings& settings, const device::Capability& capability) {
    Plan plan;
    plan.restS = settings.durationS;
    if (!settings.push) return plan;
    plan.restS = std::clamp(0.3 * settings.durationS, 0.6, 4.0);
    plan.warmUpS = kWarmUpS;
    plan.pulseN = std::min({kPulseN, 0.5 * capability.maxForceN, capability.continuousForceN});
    plan.biasN = 0.1 * plan.pulseN;
    plan.pulses = static_cast<int>((settings.durationS - plan.restS - plan.warmUpS) / plan.everyS);
    return plan;
}

Report check(std::unique_ptr<link::Driver> driver, const CheckSettings& settings, const core::Progress& progress) {
    validate(settings);
    const auto say = [&](const std::string& sentence) {
        if (settings.announce) settings.announce(sentence);
    };
    Recording recording;
    recording.info = driver->info();
    recording.settings = settings;
    if (!recording.info.pushes) recording.settings.push = false;
    recording.plan = planFor(recording.settings, recording.info.capability);
    const Plan& plan = recording.plan;
    const std::function<std::int64_t()> nowNs = settings.nowNs ? settings.nowNs : &rt::monotonicNs;

    auto tapped = std::make_unique<Tap>(std::move(driver), nowNs);
    Tap& tap = *tapped;
    safety::GuardSettings guard;
    // A device that cannot push has a record with no force: any limit does, nothing is sent.
    if (recording.info.pushes) guard.gate = safety::gateSettingsFor(recording.info.capability);
    guard.shaping.passivityController = guard.shaping.frictionCompensation = guard.shaping.thermalBudget = false;
    guard.shaping.maxForceN = std::max(recording.info.capability.maxForceN, 1e-3);
    guard.shaping.continuousForceN = std::max(recording.info.capability.continuousForceN, 1e-3);
    guard.clutchButton = -1;
    guard.nowNs = settings.nowNs;
    guard.advance = settings.advance;
    recording.gateTimeoutS = guard.gate.readingTimeoutS;
    recording.maxSlopeNPerS = guard.gate.maxSlopeNPerS;
    say(recording.settings.push
            ? fmt::format("For {:.1f} s leave the device alone: its noise at rest is measured.", plan.restS)
            : fmt::format("For {:.1f} s leave the device alone; it will not push.", plan.restS));
    safety::GuardedDevice device(std::move(tapped), guard);
    Ticker ticker(device, tap, plan, 1.0 / settings.rateHz, nowNs);
    const double periodS = 1.0 / settings.rateHz;

    const auto fetch = [&] {
        drain(tap.frames, recording.frames);
        drain(ticker.ticks, recording.ticks);
        drain(ticker.pulses, recording.pulses);
    };
    bool announced = !recording.settings.push;
    const auto attend = [&](double elapsedS) {
        if (!announced && elapsedS >= plan.restS - 0.3) {
            announced = true;
            say(fmt::format("Now it pushes upwards with {:.2g} N, {} times for {:.0f} ms: hold the stylus loosely.",
                            plan.pulseN, plan.pulses, 1e3 * plan.pulseS));
        }
        fetch();
        core::report(progress, std::min(1.0, elapsedS / settings.durationS));
    };
    const auto requireFrames = [&](double waitedS) {
        if (!recording.frames.empty() || waitedS < kFirstFrameS) return;
        throw core::Error(fmt::format("the device told no pose within {:.0f} s", kFirstFrameS), recording.info.model,
                          "switch it off and on, and close other programs that use it")
            .as("no-reading", {recording.info.model});
    };

    if (settings.advance) {
        const auto most = static_cast<std::int64_t>((settings.durationS + kFirstFrameS + 1.0) * settings.rateHz);
        for (std::int64_t i = 0; i < most && ticker.tick(settings.durationS, 0, 1); ++i)
            if (i % 256 == 0) {
                attend(ticker.elapsedS);
                requireFrames(static_cast<double>(i) * periodS);
            }
        recording.grant.told = config::phrase("scheduling.simulated");
    } else {
        const std::int64_t startNs = rt::monotonicNs();
        rt::RealtimeThread thread([&] {
            rt::PeriodicClock clock(static_cast<std::int64_t>(periodS * kNsPerS));
            clock.start();
            // On after the end, without force: how the device is doing is read while the simulation still runs.
            while (!ticker.stop.load(std::memory_order_relaxed)) {
                const rt::Beat beat = clock.wait();
                if (!ticker.tick(settings.durationS, beat.lateNs, beat.periods))
                    ticker.ended.store(true, std::memory_order_release);
            }
        });
        recording.grant = thread.grant();
        // What progress or announce throws ends the ticks before the device goes.
        struct Stopper {
            Ticker& ticker;
            rt::RealtimeThread& thread;
            ~Stopper() {
                ticker.stop.store(true, std::memory_order_relaxed);
                thread.join();
            }
        } stopper{ticker, thread};
        while (!ticker.ended.load(std::memory_order_acquire)) {
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
            attend(ticker.elapsedS);
            requireFrames(static_cast<double>(rt::monotonicNs() - startNs) / kNsPerS);
        }
        recording.health = device.health()->read();
    }
    if (settings.advance) recording.health = device.health()->read();
    recording.calibration = device.calibration();
    if (recording.calibration == link::CalibrationState::wanted ||
        recording.calibration == link::CalibrationState::wantedByHand)
        recording.calibrationStep = device.calibrationStep();
    fetch();
    recording.lost = tap.frames.overflowCount() + ticker.ticks.overflowCount() + ticker.pulses.overflowCount();
    if (recording.frames.empty()) requireFrames(kFirstFrameS);
    recording.startNs = recording.frames.front().atNs;
    return judge(recording);
}

}  // namespace handpiece::fidelity
