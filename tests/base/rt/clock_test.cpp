// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/rt/clock.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <time.h>

#include "handpiece/base/core/error.h"

namespace handpiece::rt::clock_test {
namespace {

/// How often this thread has given up its processor of its own accord.
long waits() {
    rusage usage{};
    getrusage(RUSAGE_THREAD, &usage);
    return usage.ru_nvcsw;
}

std::int64_t cpuNs() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return t.tv_sec * std::int64_t{1'000'000'000} + t.tv_nsec;
}

TEST(PeriodicClock, beatsAtMultiplesOfThePeriodAndNeverEarly) {
    PeriodicClock clock(1'000'000, 100'000);
    clock.start();
    std::int64_t last = 0;
    for (int i = 0; i < 50; ++i) {
        const Beat beat = clock.wait();
        EXPECT_GE(beat.lateNs, 0);
        EXPECT_GE(monotonicNs(), beat.nominalNs);
        if (last != 0) {
            EXPECT_EQ(beat.nominalNs - last, beat.periods * clock.periodNs());
        }
        last = beat.nominalNs;
    }
}

TEST(PeriodicClock, leavesOutWholePeriodsWorkedThroughAndSaysSo) {
    PeriodicClock clock(1'000'000);
    clock.start();
    const Beat first = clock.wait();
    while (monotonicNs() < first.nominalNs + 5'300'000) {
    }
    const Beat late = clock.wait();
    EXPECT_GE(late.periods, 5);
    EXPECT_EQ((late.nominalNs - first.nominalNs) / clock.periodNs(), late.periods);
    EXPECT_GE(late.lateNs, 0);
}

// Linux counts what a real-time thread runs since it last waited, and takes real time from it at 100 ms.
TEST(PeriodicClock, whoIsAlwaysBehindWaitsAllTheSame) {
    for (const std::int64_t spinNs : {0, 240'000}) {
        PeriodicClock clock(250'000, spinNs);
        clock.start();
        const long before = waits();
        const std::int64_t begun = cpuNs();
        std::int64_t last = 0;
        while (cpuNs() - begun < 400'000'000) {
            const std::int64_t end = cpuNs() + 400'000;
            while (cpuNs() < end) {
            }
            const Beat beat = clock.wait();
            if (last != 0) {
                EXPECT_EQ(beat.nominalNs - last, beat.periods * clock.periodNs());
            }
            EXPECT_GE(beat.lateNs, 0);
            last = beat.nominalNs;
        }
        EXPECT_GE(waits() - before, 8) << "a rest each 50 ms at least";
    }
}

TEST(PeriodicClock, refusesPeriodsThatCannotBeKept) {
    EXPECT_THROW(PeriodicClock(0), core::Error);
    EXPECT_THROW(PeriodicClock(-5), core::Error);
    EXPECT_THROW(PeriodicClock(1'000), core::Error);
    EXPECT_THROW(PeriodicClock(20'000'000'000), core::Error);
    EXPECT_THROW(PeriodicClock(1'000'000, 1'000'000), core::Error);
}

}  // namespace
}  // namespace handpiece::rt::clock_test
