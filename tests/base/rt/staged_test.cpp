// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/rt/staged.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace handpiece::rt::staged_test {
namespace {

struct Counted {
    explicit Counted(int n) : number(n) { ++alive; }
    ~Counted() {
        --alive;
        freedOn = std::this_thread::get_id();
    }
    int number;
    static inline std::atomic<int> alive{0};
    static inline std::thread::id freedOn;
};

TEST(Staged, swapsOnlyWhenSomethingWasStaged) {
    {
        Staged<Counted> staged(std::make_unique<Counted>(1));
        EXPECT_FALSE(staged.swap());
        EXPECT_EQ(staged.current()->number, 1);
        staged.stage(std::make_unique<Counted>(2));
        staged.stage(std::make_unique<Counted>(3));  // 2 was never taken: freed at once
        EXPECT_EQ(Counted::alive, 2);
        EXPECT_TRUE(staged.swap());
        EXPECT_FALSE(staged.swap());
        EXPECT_EQ(staged.current()->number, 3);
        EXPECT_EQ(Counted::alive, 2);  // 1 waits to be collected
        staged.collect();
        EXPECT_EQ(Counted::alive, 1);
    }
    EXPECT_EQ(Counted::alive, 0);
}

TEST(Staged, replacesManyTimes) {
    Staged<Counted> staged(std::make_unique<Counted>(0));
    for (int i = 1; i < 100; ++i) {
        staged.stage(std::make_unique<Counted>(i));
        staged.swap();
    }
    EXPECT_EQ(staged.current()->number, 99);
}

TEST(Staged, freesNothingOnTheTickBetweenThreads) {
    {
        Staged<Counted> staged(std::make_unique<Counted>(0));
        std::atomic<bool> stop{false};
        int last = 0;
        bool backwards = false;
        std::thread tick([&] {
            while (!stop.load(std::memory_order_acquire)) {
                staged.swap();
                const int number = staged.current()->number;
                backwards = backwards || number < last;
                last = number;
                std::this_thread::yield();
            }
        });
        const std::thread::id tickId = tick.get_id();
        bool freedByTick = false;
        for (int i = 1; i <= 20'000; ++i) {
            staged.stage(std::make_unique<Counted>(i));
            freedByTick = freedByTick || Counted::freedOn == tickId;
        }
        stop.store(true, std::memory_order_release);
        tick.join();
        EXPECT_FALSE(backwards);
        EXPECT_FALSE(freedByTick);
        EXPECT_LE(Counted::alive, 2 + 17);
    }
    EXPECT_EQ(Counted::alive, 0);
}

}  // namespace
}  // namespace handpiece::rt::staged_test
