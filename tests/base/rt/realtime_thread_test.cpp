// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/rt/realtime_thread.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>
#include <thread>

namespace handpiece::rt {
namespace {

TEST(RealtimeThread, runsItsBodyAndSaysWhatItWasGranted) {
    std::atomic<int> policy{-1};
    std::thread::id id;
    RealtimeThread thread([&] {
        id = std::this_thread::get_id();
        policy = sched_getscheduler(0);
    });
    thread.join();
    EXPECT_NE(id, std::this_thread::get_id());
    const SchedulingGrant& grant = thread.grant();
    EXPECT_EQ(grant.realTime, policy == SCHED_FIFO);
    EXPECT_EQ(grant.line.rfind("real-time scheduling: ", 0), 0u) << grant.line;
    EXPECT_EQ(grant.line.find("not permitted") == std::string::npos, grant.realTime) << grant.line;
    EXPECT_EQ(grant.line.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace handpiece::rt
