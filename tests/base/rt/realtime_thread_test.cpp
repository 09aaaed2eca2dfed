// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/rt/realtime_thread.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "handpiece/base/rt/clock.h"

namespace handpiece::rt::realtime_thread_test {
namespace {

bool hasRealTime() {
    const int policy = sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
    return policy == SCHED_FIFO || policy == SCHED_RR;
}

TEST(RealtimeThread, runsItsBodyAndSaysWhatItWasGranted) {
    std::atomic<bool> realTime{false};
    std::thread::id id;
    RealtimeThread thread([&] {
        id = std::this_thread::get_id();
        realTime = hasRealTime();
    });
    thread.join();
    EXPECT_NE(id, std::this_thread::get_id());
    const SchedulingGrant& grant = thread.grant();
    EXPECT_NE(grant.scheduling, Scheduling::notAsked);
    EXPECT_EQ(grant.realTime(), realTime);
    EXPECT_EQ(grant.line().rfind("real-time scheduling: ", 0) == 0, grant.realTime()) << grant.line();
    EXPECT_EQ(grant.line().find('\n'), std::string::npos);
    EXPECT_FALSE(thread.lostRealTime());
}

// For three times as long as a thread may run without a pause. A wait of a microsecond is over before it has begun.
TEST(RealtimeThread, whoseTicksLeaveNoTimeToWaitKeepsRealTime) {
    for (const std::int64_t leftNs : {-150'000, 1'500}) {
        bool realTime = false;
        RealtimeThread thread([&] {
            PeriodicClock clock(250'000);
            clock.start();
            const std::int64_t end = monotonicNs() + 300'000'000;
            while (monotonicNs() < end) {
                const Beat beat = clock.wait();
                const std::int64_t tickEnd = beat.nominalNs + (leftNs < 0 ? beat.lateNs : 0) + 250'000 - leftNs;
                while (monotonicNs() < tickEnd) {
                }
            }
            realTime = hasRealTime();
        });
        thread.join();
        if (!thread.grant().realTime()) GTEST_SKIP() << thread.grant().line();
        EXPECT_TRUE(realTime) << leftNs;
    }
}

// The rlimit's hard value would end this program a tenth of a second after the soft one.
TEST(RealtimeThread, whatRunsWithoutAPauseLosesRealTimeAndNothingElse) {
    std::atomic<bool> started{false}, stop{false}, realTime{true};
    RealtimeThread thread([&] {
        const std::int64_t end = monotonicNs() + 10'000'000'000;
        realTime = hasRealTime();
        started = true;
        while (!stop && monotonicNs() < end)
            if (!hasRealTime()) break;
        realTime = hasRealTime();
        while (!stop)
            std::this_thread::yield();
    });
    if (!thread.grant().realTime()) {
        stop = true;
        GTEST_SKIP() << thread.grant().line();
    }
    while (!thread.lostRealTime() && realTime)
        std::this_thread::yield();
    EXPECT_TRUE(thread.lostRealTime());
    // What comes after has its own chance, and the limit that guards it.
    RealtimeThread next([] {});
    EXPECT_TRUE(next.grant().realTime());
    rlimit limit{};
    ASSERT_EQ(getrlimit(RLIMIT_RTTIME, &limit), 0);
    EXPECT_EQ(limit.rlim_cur, 100'000u);
    stop = true;
}

TEST(RealtimeThread, whatWasTakenBackIsAskedForAgain) {
    std::atomic<bool> stop{false};
    RealtimeThread thread([&] {
        while (hasRealTime() && !stop) {
        }
        while (!stop)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
    });
    if (!thread.grant().realTime()) {
        stop = true;
        GTEST_SKIP() << thread.grant().line();
    }
    const std::string first = config::words()(thread.grant().told);
    bool wasLost = false;
    for (int i = 0; i < 1000 && !(wasLost && thread.grant().realTime()); ++i) {
        if (!thread.keepRealTime().realTime()) wasLost = true;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_TRUE(wasLost);
    EXPECT_TRUE(thread.grant().realTime()) << thread.grant().line();
    EXPECT_FALSE(thread.lostRealTime());
    EXPECT_EQ(thread.grant().timesTakenBack, 1);
    EXPECT_EQ(thread.grant().text(), first + "; times it was taken back: 1");
    stop = true;
}

TEST(RealtimeThreadDeathTest, asksForNothingUnderALimitThatWouldEndTheProgram) {
    const auto run = [] {
        const rlimit hard{50'000, 50'000};
        if (setrlimit(RLIMIT_RTTIME, &hard) != 0) std::exit(2);
        RealtimeThread thread([] {
            const std::int64_t end = monotonicNs() + 200'000'000;
            while (monotonicNs() < end) {
            }
        });
        thread.join();
        std::fputs(thread.grant().line().c_str(), stderr);
        std::exit(thread.grant().realTime() ? 1 : 0);
    };
    EXPECT_EXIT(run(), testing::ExitedWithCode(0), "RLIMIT_RTTIME is 50000 us");
}

}  // namespace
}  // namespace handpiece::rt::realtime_thread_test
