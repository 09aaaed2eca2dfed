// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/rt/clock.h"

#include <gtest/gtest.h>

#include "handpiece/base/core/error.h"

namespace handpiece::rt {
namespace {

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

TEST(PeriodicClock, refusesPeriodsThatCannotBeKept) {
    EXPECT_THROW(PeriodicClock(0), core::Error);
    EXPECT_THROW(PeriodicClock(-5), core::Error);
    EXPECT_THROW(PeriodicClock(1'000), core::Error);
    EXPECT_THROW(PeriodicClock(20'000'000'000), core::Error);
    EXPECT_THROW(PeriodicClock(1'000'000, 1'000'000), core::Error);
}

}  // namespace
}  // namespace handpiece::rt
