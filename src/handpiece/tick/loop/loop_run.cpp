// SPDX-License-Identifier: Apache-2.0
// Everything about the loop that happens outside the tick.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <thread>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/realtime_thread.h"
#include "handpiece/tick/device/capability.h"
#include "handpiece/tick/loop/haptic_loop.h"

namespace handpiece::loop {
namespace {

constexpr double kMinRateHz = 100, kMaxRateHz = 10000;
constexpr double kMaxDurationS = 24 * 3600;

double checkedPeriodS(double rateHz) {
    if (!(rateHz >= kMinRateHz && rateHz <= kMaxRateHz)) {
        throw core::Error(fmt::format("a rate of {} Hz cannot be run", rateHz), "rate",
                          "choose 1000, 2000, 4000 or 8000");
    }
    return 1.0 / rateHz;
}

template <class T>
std::unique_ptr<T> required(std::unique_ptr<T> p, const char* what) {
    if (!p) throw core::Error(fmt::format("there is no {}", what), "haptic loop");
    return p;
}

Work checked(Work work) {
    if (!work.method) throw core::Error("there is no contact method", "haptic loop");
    return work;
}

force::Limits limitsOf(const device::Capability& c) {
    return {c.maxForceN, c.maxStiffnessNPerMm, c.maxDampingNSPerMm, c.maxForceSlopeNPerS, c.maxTorqueNmm};
}

Spread spreadOf(std::vector<float> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const auto at = [&](double q) {
        return static_cast<double>(values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))]);
    };
    return {at(0.5), at(0.99), at(0.999), values.back()};
}

}  // namespace

/// Gathers work and lateness of the samples on their way to the listener.
class HapticLoop::Statistics {
  public:
    explicit Statistics(const Listener& listener)
        : each_([this, &listener](const messages::HapticSample& sample) {
              workUs_.push_back(sample.workUs);
              lateUs_.push_back(sample.lateUs);
              if (listener) listener(sample);
          }) {}
    [[nodiscard]] const Listener& each() const { return each_; }
    [[nodiscard]] Spread workUs() const { return spreadOf(workUs_); }
    [[nodiscard]] Spread lateUs() const { return spreadOf(lateUs_); }

  private:
    Listener each_;
    std::vector<float> workUs_, lateUs_;
};

HapticLoop::HapticLoop(const LoopSettings& settings, std::unique_ptr<device::Device> device,
                       std::unique_ptr<contact::Method> method, const force::Parameters& parameters)
    : HapticLoop(settings, std::move(device), Work{std::move(method), nullptr}, parameters) {}

HapticLoop::HapticLoop(const LoopSettings& settings, std::unique_ptr<device::Device> device, Work work,
                       const force::Parameters& parameters, const instrument::Drive& drive)
    : settings_(settings),
      periodS_(checkedPeriodS(settings.rateHz)),
      device_(required(std::move(device), "device")),
      work_(std::make_unique<Command<Work>>(Command<Work>{checked(std::move(work))})),
      parameters_(std::make_unique<Command<force::Parameters>>(Command<force::Parameters>{parameters})),
      drive_(std::make_unique<Command<instrument::Drive>>(Command<instrument::Drive>{drive})),
      restore_(nullptr),
      force_(limitsOf(device_->capability()), parameters),
      eventForce_(limitsOf(device_->capability()), settings.rateHz),
      rotor_(drive),
      samples_(settings.queueCapacity),
      bricks_(settings.brickCapacity) {
    device::validate(device_->capability());
    instrument::validate(drive);
}

std::uint64_t HapticLoop::setParameters(const force::Parameters& parameters) {
    validate(parameters);
    parameters_.stage(
        std::make_unique<Command<force::Parameters>>(Command<force::Parameters>{parameters, ++commands_}));
    return commands_;
}

std::uint64_t HapticLoop::setDrive(const instrument::Drive& drive) {
    instrument::validate(drive);
    drive_.stage(std::make_unique<Command<instrument::Drive>>(Command<instrument::Drive>{drive, ++commands_}));
    return commands_;
}

std::uint64_t HapticLoop::setWork(Work work) {
    if (restoring())
        throw core::Error("an undo is still being put in place", "haptic loop", "change bur or tooth after it");
    work_.stage(std::make_unique<Command<Work>>(Command<Work>{checked(std::move(work)), ++commands_}));
    return commands_;
}

std::uint64_t HapticLoop::setMethod(std::unique_ptr<contact::Method> method) {
    return setWork({std::move(method), nullptr});
}

std::uint64_t HapticLoop::restore(tooth::StateDelta change) {
    if (restoring())
        throw core::Error("an earlier undo is still being put in place", "haptic loop", "wait until it is done");
    restoring_.store(true, std::memory_order_release);
    restore_.stage(std::make_unique<Command<Restore>>(Command<Restore>{{std::move(change), 0}, ++commands_}));
    return commands_;
}

std::uint64_t HapticLoop::ticksFor(double durationS) {
    if (!(durationS > 0.0 && durationS <= kMaxDurationS)) {
        throw core::Error(fmt::format("a run of {} s", durationS), "duration", "give a time above zero, up to a day");
    }
    stop_.store(false, std::memory_order_relaxed);
    ticksDone_ = lateTicks_ = missedPeriods_ = 0;
    return static_cast<std::uint64_t>(std::llround(durationS * settings_.rateHz)) + 1;  // both ends
}

RunReport HapticLoop::finish(const Statistics& statistics, std::string scheduling) const {
    RunReport report;
    report.scheduling = std::move(scheduling);
    report.ticks = ticksDone_;
    report.lateTicks = lateTicks_;
    report.missedPeriods = missedPeriods_;
    report.queueOverflow = samples_.overflowCount();
    report.workUs = statistics.workUs();
    report.latenessUs = statistics.lateUs();
    return report;
}

RunReport HapticLoop::runSimulated(double durationS, const Listener& listener, const BrickListener& bricks) {
    const std::uint64_t ticks = ticksFor(durationS);
    Statistics statistics(listener);
    for (std::uint64_t i = 0; i < ticks && !stop_.load(std::memory_order_relaxed); ++i) {
        tick(rt::Beat{});
        fetch(statistics.each(), bricks);
    }
    return finish(statistics, "simulated time: as fast as possible");
}

void HapticLoop::fetch(const Listener& listener, const BrickListener& bricks) {
    messages::HapticSample sample;
    while (samples_.tryPop(sample)) {
        for (; bricks && fetchedBricks_ < sample.handedBricks && bricks_.tryPop(fetched_); ++fetchedBricks_)
            bricks(fetched_);
        if (listener) listener(sample);
    }
}

/// Ticks in a thread of its own, while this one attends to it.
std::string HapticLoop::tickOnClock(std::uint64_t ticks, bool realTime, const Attend& attend) {
    rt::PeriodicClock clock(std::llround(1e9 * periodS_), std::llround(1e3 * settings_.spinUs));
    std::atomic<bool> done{false};
    const auto body = [&] {
        clock.start();
        for (std::uint64_t served = 0; served < ticks && !stop_.load(std::memory_order_relaxed);) {
            const rt::Beat beat = clock.wait();
            served += static_cast<std::uint64_t>(beat.periods);
            tick(beat);
        }
        done.store(true, std::memory_order_release);
    };
    std::string scheduling = "no real-time scheduling was asked for";
    const auto released = [this] { device_->command(core::Vec3::Zero(), core::Vec3::Zero()); };
    try {
        std::unique_ptr<rt::RealtimeThread> privileged;
        std::jthread plain;
        if (realTime) {
            privileged = std::make_unique<rt::RealtimeThread>(body);
            scheduling = privileged->grant().line;
        } else {
            plain = std::jthread(body);
        }
        try {
            while (!done.load(std::memory_order_acquire)) {
                attend(scheduling);
                std::this_thread::sleep_for(std::chrono::milliseconds(2));
            }
        } catch (...) {
            requestStop();  // the listener failed: let the tick end before its loop goes
            throw;
        }
    } catch (...) {
        released();
        throw;
    }
    released();
    return scheduling;
}

RunReport HapticLoop::runRealTime(double durationS, const Listener& listener, const BrickListener& bricks) {
    const std::uint64_t ticks = ticksFor(durationS);
    Statistics statistics(listener);
    std::string scheduling = tickOnClock(ticks, true, [&](const std::string&) { fetch(statistics.each(), bricks); });
    fetch(statistics.each(), bricks);
    return finish(statistics, std::move(scheduling));
}

void HapticLoop::runAttended(bool realTime, const Attend& attend) {
    stop_.store(false, std::memory_order_relaxed);
    ticksDone_ = lateTicks_ = missedPeriods_ = 0;
    (void)tickOnClock(std::numeric_limits<std::uint64_t>::max(), realTime, attend);
}

}  // namespace handpiece::loop
