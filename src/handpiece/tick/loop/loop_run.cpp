// SPDX-License-Identifier: Apache-2.0
// Runs beside the tick, not in it: starts its thread and feeds a listener.
#include "handpiece/tick/loop/loop_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <thread>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/realtime_thread.h"

namespace handpiece::loop {
namespace {

constexpr double kMaxDurationS = 24 * 3600;

Spread spreadOf(std::vector<float> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const auto at = [&](double q) {
        return static_cast<double>(values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))]);
    };
    return {at(0.5), at(0.99), at(0.999), values.back()};
}

/// Gathers work and lateness of the samples on their way to the listener.
class Statistics {
  public:
    explicit Statistics(const Listener& listener)
        : each_([this, &listener](const messages::HapticSample& sample) {
              workUs_.push_back(sample.workUs);
              lateUs_.push_back(sample.lateUs);
              if (listener) listener(sample);
          }) {}
    [[nodiscard]] const Listener& each() const { return each_; }
    [[nodiscard]] RunReport report(HapticLoop& loop, rt::SchedulingGrant scheduling) const {
        return {loop.count(), std::move(scheduling), loop.samples().overflowCount(), spreadOf(workUs_),
                spreadOf(lateUs_)};
    }

  private:
    Listener each_;
    std::vector<float> workUs_, lateUs_;
};

std::uint64_t ticksFor(const HapticLoop& loop, double durationS) {
    if (!(durationS > 0.0 && durationS <= kMaxDurationS)) {
        throw core::Error(fmt::format("a run of {} s", durationS), "duration", "give a time above zero, up to a day");
    }
    return static_cast<std::uint64_t>(std::llround(durationS * loop.settings().rateHz)) + 1;  // both ends
}

/// Ticks in a thread of its own, while this one attends to it.
rt::SchedulingGrant tickOnClock(HapticLoop& loop, std::uint64_t ticks, bool realTime, const Attend& attend) {
    rt::PeriodicClock clock(std::llround(1e9 * loop.periodS()), std::llround(1e3 * loop.settings().spinUs));
    loop.beginRun();
    std::atomic<bool> done{false};
    const auto body = [&] {
        clock.start();
        for (std::uint64_t served = 0; served < ticks && !loop.stopRequested();) {
            const rt::Beat beat = clock.wait();
            served += static_cast<std::uint64_t>(beat.periods);
            loop.tick(beat);
        }
        done.store(true, std::memory_order_release);
    };
    rt::SchedulingGrant scheduling;
    try {
        std::unique_ptr<rt::RealtimeThread> privileged;
        std::jthread plain;
        if (realTime) {
            privileged = std::make_unique<rt::RealtimeThread>(body);
        } else {
            plain = std::jthread(body);
        }
        try {
            while (!done.load(std::memory_order_acquire)) {
                attend(privileged ? privileged->keepRealTime() : scheduling);
                std::this_thread::sleep_for(std::chrono::milliseconds(2));
            }
            if (privileged) scheduling = privileged->grant();
        } catch (...) {
            loop.requestStop();  // the listener failed: let the tick end before its loop goes
            throw;
        }
    } catch (...) {
        loop.release();
        throw;
    }
    loop.release();
    return scheduling;
}

}  // namespace

RunReport runSimulated(HapticLoop& loop, double durationS, const Listener& listener, const BrickListener& bricks) {
    const std::uint64_t ticks = ticksFor(loop, durationS);
    Statistics statistics(listener);
    loop.beginRun();
    for (std::uint64_t i = 0; i < ticks && !loop.stopRequested(); ++i) {
        loop.tick(rt::Beat{});
        loop.fetch(statistics.each(), bricks);
    }
    rt::SchedulingGrant none;
    none.told = config::phrase("scheduling.simulated");
    return statistics.report(loop, std::move(none));
}

RunReport runRealTime(HapticLoop& loop, double durationS, const Listener& listener, const BrickListener& bricks) {
    const std::uint64_t ticks = ticksFor(loop, durationS);
    Statistics statistics(listener);
    rt::SchedulingGrant scheduling =
        tickOnClock(loop, ticks, true, [&](const rt::SchedulingGrant&) { loop.fetch(statistics.each(), bricks); });
    loop.fetch(statistics.each(), bricks);
    return statistics.report(loop, std::move(scheduling));
}

void runAttended(HapticLoop& loop, bool realTime, const Attend& attend) {
    (void)tickOnClock(loop, std::numeric_limits<std::uint64_t>::max(), realTime, attend);
}

}  // namespace handpiece::loop
