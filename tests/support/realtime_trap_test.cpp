// SPDX-License-Identifier: Apache-2.0
#include "support/realtime_trap.h"

#include <gtest/gtest.h>

#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace handpiece::test::realtime_trap_test {
namespace {

class RealtimeTrapTest : public testing::Test {
  protected:
    void SetUp() override {
        if (!RealtimeTrap::isActive()) GTEST_SKIP() << "the sanitizers own malloc: the trap is off";
    }
};

TEST_F(RealtimeTrapTest, seesAnAllocationAndItsRelease) {
    const RealtimeTrap trap;
    {
        const std::unique_ptr<int> p(new int(3));
        asm volatile("" : : "g"(p.get()) : "memory");
    }
    EXPECT_EQ(trap.allocations(), 2u);
    EXPECT_EQ(trap.locks(), 0u);
}

TEST_F(RealtimeTrapTest, seesALock) {
    std::mutex mutex;
    const RealtimeTrap trap;
    { const std::lock_guard lock(mutex); }
    EXPECT_EQ(trap.locks(), 1u);
}

TEST_F(RealtimeTrapTest, seesASleepAndAFile) {
    const RealtimeTrap trap;
    std::this_thread::sleep_for(std::chrono::microseconds(1));
    EXPECT_EQ(trap.waitsAndFiles(), 1u);
}

TEST_F(RealtimeTrapTest, leavesArithmeticAndOtherThreadsAlone) {
    const RealtimeTrap trap;
    volatile double x = 2.0;
    x = x * x;
    EXPECT_EQ(trap.total(), 0u);
}

TEST_F(RealtimeTrapTest, isQuietWhenDisarmed) {
    { const RealtimeTrap trap; }
    const std::vector<int> v(100);
    const RealtimeTrap trap;
    EXPECT_EQ(trap.total(), 0u);
    EXPECT_EQ(v.size(), 100u);
}

}  // namespace
}  // namespace handpiece::test::realtime_trap_test
