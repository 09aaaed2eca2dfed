// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/rt/clock.h"

#include <fmt/format.h>
#include <time.h>

#include <cerrno>

#include "handpiece/base/core/error.h"

namespace handpiece::rt {
namespace {

constexpr std::int64_t kNsPerS = 1'000'000'000;
// A fifth of what a thread may run without a pause. A wait that is over before the thread has left its processor is
// none: of 20 us 3 % on a virtual machine, of 50 .7, of 100 .04.
constexpr std::int64_t kMostWithoutRestNs = 20'000'000;
constexpr std::int64_t kRestNs = 100'000;

void sleepUntil(std::int64_t ns) noexcept {
    const timespec until{static_cast<time_t>(ns / kNsPerS), static_cast<long>(ns % kNsPerS)};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
}

}  // namespace

std::int64_t monotonicNs() noexcept {
    timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return static_cast<std::int64_t>(t.tv_sec) * kNsPerS + t.tv_nsec;
}

PeriodicClock::PeriodicClock(std::int64_t periodNs, std::int64_t spinNs) : periodNs_(periodNs), spinNs_(spinNs) {
    if (periodNs < 10'000 || periodNs > 10 * kNsPerS) {
        throw core::Error(fmt::format("a period of {} ns cannot be kept", periodNs), "clock", "ask for 10 us to 10 s");
    }
    if (spinNs < 0 || spinNs >= periodNs) {
        throw core::Error(fmt::format("spinning for {} ns of a period of {} ns", spinNs, periodNs), "clock",
                          "spin for less than the period");
    }
}

void PeriodicClock::start() noexcept {
    restedNs_ = monotonicNs();
    nextNs_ = restedNs_ + periodNs_;
}

Beat PeriodicClock::wait() noexcept {
    Beat beat;
    std::int64_t now = monotonicNs();
    if (now - restedNs_ > kMostWithoutRestNs && now + kRestNs / 2 > nextNs_ - spinNs_) {
        sleepUntil(now + kRestNs);
        restedNs_ = now = monotonicNs();
    }
    // A beat that is late by less than a period is still served; only whole missed periods are left out.
    if (now >= nextNs_ + periodNs_) {
        const std::int64_t missed = (now - nextNs_) / periodNs_;
        beat.periods += missed;
        nextNs_ += missed * periodNs_;
    }
    const std::int64_t wakeNs = nextNs_ - spinNs_;
    if (now < wakeNs) {
        sleepUntil(wakeNs);
        if (wakeNs - now >= kRestNs / 2) restedNs_ = wakeNs;
    }
    do {
        now = monotonicNs();
    } while (now < nextNs_);
    beat.nominalNs = nextNs_;
    beat.lateNs = now - nextNs_;
    nextNs_ += periodNs_;
    return beat;
}

}  // namespace handpiece::rt
