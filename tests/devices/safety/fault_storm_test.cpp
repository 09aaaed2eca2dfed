// SPDX-License-Identifier: Apache-2.0
// A thousand faults while a tooth is cut (HANDPIECE_FAULTS=1000; fewer by default), and some with real threads.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "handpiece/record/session/session_reader.h"
#include "storm.h"
#include "support/random.h"

namespace handpiece::safety::fault_storm_test {
namespace {

TEST(FaultStorm, whileCuttingEveryFaultEndsInZeroForce) {
    const char* asked = std::getenv("HANDPIECE_FAULTS");
    const long count = asked ? std::strtol(asked, nullptr, 10) : 200;
    const test::TemporaryFolder folder;
    StormSettings settings;
    settings.faults = "random:" + std::to_string(count) + ":every=0.4:from=1:seed=" + std::to_string(test::seed());
    settings.session = folder.path() / "storm.h5";
    const Storm storm = cutInAStorm(settings);
    std::printf(
        "  %zu faults in %.0f s of cutting, %.2f mm3 gone, %.0f s under more than 0.5 N, %llu troubles told\n%s",
        storm.outcomes.size(), static_cast<double>(storm.ticks) / settings.tickHz, storm.removedMm3, storm.forcedS,
        static_cast<unsigned long long>(storm.troubles), table(storm).c_str());
    ASSERT_EQ(storm.outcomes.size(), static_cast<std::size_t>(count));
    for (const std::string& wrong : judge(storm))
        ADD_FAILURE() << wrong;
    // It was a storm over a hand that pushed and cut.
    std::size_t pushing = 0;
    for (const FaultOutcome& outcome : storm.outcomes) {
        pushing += outcome.forceBeforeN > 0.3;
        if (!outcome.told) continue;
        EXPECT_GE(outcome.toZeroS, 0.0) << nameOf(outcome.fault.kind);
        EXPECT_LE(outcome.toZeroS, 0.010) << nameOf(outcome.fault.kind);
    }
    EXPECT_GT(pushing, storm.outcomes.size() / 3);
    EXPECT_GT(storm.removedMm3, 0.05);
    EXPECT_GT(storm.relaxed, 0u);
    EXPECT_LE(storm.output.largestN, storm.largestN);

    const session::SessionReader reader(settings.session);
    EXPECT_TRUE(reader.isComplete());
    ASSERT_EQ(reader.size(), storm.ticks);
    std::uint64_t faulted = 0;
    for (std::uint64_t first = 0; first < reader.size(); first += 10000) {
        for (const session::Record& record : reader.records(first, 10000)) {
            const session::Inputs inputs = session::inputsOf(record);
            ASSERT_TRUE(std::isfinite(inputs.positionMm[0] + inputs.positionMm[1] + inputs.positionMm[2]));
            ASSERT_LE(std::hypot(record.forceN[0], record.forceN[1], record.forceN[2]), 3.3f * 1.00001f);
            faulted += (record.flags & messages::kFault) != 0;
        }
    }
    EXPECT_GT(faulted, 0u);
}

TEST(FaultStorm, atOtherRatesAsWell) {
    for (const auto& [servoHz, tickHz] : {std::pair{4000.0, 1000.0}, {1000.0, 4000.0}, {500.0, 1000.0}}) {
        SCOPED_TRACE(servoHz);
        StormSettings settings;
        settings.servoHz = servoHz;
        settings.tickHz = tickHz;
        settings.faults = "random:8:every=0.5:from=0.8:seed=" + std::to_string(test::seed() + 1);
        const Storm storm = cutInAStorm(settings);
        std::printf("  servo %.0f Hz, tick %.0f Hz\n%s", servoHz, tickHz, table(storm).c_str());
        for (const std::string& wrong : judge(storm))
            ADD_FAILURE() << wrong;
    }
}

TEST(FaultStorm, withThreadsAndAWallClock) {
    // Judged by the gate's own stamps: what a busy machine does to the threads is one more fault. A servo that stands
    // is relaxed by the watchdog's thread, whose own luck is not judged: so no stalls here.
    const test::TemporaryFolder folder;
    StormSettings settings;
    settings.realTime = true;
    settings.faults = "random:6:every=0.45:from=0.9:kinds=unplug+nan+jump+error+garbage+hot+drop+tick:seed=" +
                      std::to_string(test::seed() + 2);
    settings.session = folder.path() / "storm.h5";
    const Storm storm = cutInAStorm(settings);
    std::printf("  %llu ticks, %llu troubles told, servo found standing %llu times\n%s",
                static_cast<unsigned long long>(storm.ticks), static_cast<unsigned long long>(storm.troubles),
                static_cast<unsigned long long>(storm.relaxed), table(storm).c_str());
    for (const std::string& wrong : judge(storm))
        ADD_FAILURE() << wrong;
    EXPECT_GE(storm.outcomes.size(), 1u);
    const session::SessionReader reader(settings.session);
    EXPECT_EQ(reader.size(), storm.ticks);
}

}  // namespace
}  // namespace handpiece::safety::fault_storm_test
