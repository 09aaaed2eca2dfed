// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "handpiece/base/core/progress.h"

namespace handpiece::core::parallel_test {
namespace {

TEST(ParallelFor, visitsEveryIndexOnceAtAnyThreadCount) {
    for (const std::size_t threads : {std::size_t{1}, std::size_t{2}, std::size_t{0}}) {
        setThreadCount(threads);
        std::vector<int> visits(10007);
        parallelFor(visits.size(), 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                ++visits[i];
        });
        for (const int v : visits)
            ASSERT_EQ(v, 1);
        if (threads > 0) {
            EXPECT_EQ(threadCount(), threads);
        }
    }
    EXPECT_GE(threadCount(), 1u);
}

TEST(ParallelFor, passesAnExceptionOn) {
    EXPECT_THROW(parallelFor(100, 1,
                             [](std::size_t begin, std::size_t) {
                                 if (begin == 37) throw Error("37");
                             }),
                 Error);
    parallelFor(0, 1, [](std::size_t, std::size_t) { FAIL() << "an empty range has no pieces"; });
}

TEST(ParallelFor, withinAnotherThatIsCancelledIsStillWhole) {
    setThreadCount(4);
    int together = 0;
    for (int round = 0; round < 20; ++round) {
        std::atomic<bool> isEntered = false, isThrown = false, isHalf = false;
        const auto wait = [](const std::atomic<bool>& until) {
            for (int i = 0; i < 200 && !until; ++i)
                std::this_thread::sleep_for(std::chrono::microseconds(100));
        };
        EXPECT_THROW(parallelFor(8, 1,
                                 [&](std::size_t begin, std::size_t) {
                                     if (begin == 0) {
                                         wait(isEntered);
                                         isThrown = true;
                                         throw Error("enough");
                                     }
                                     isEntered = true;
                                     wait(isThrown);
                                     std::this_thread::sleep_for(std::chrono::milliseconds(5));
                                     std::atomic<int> done = 0;
                                     parallelFor(64, 1, [&](std::size_t from, std::size_t to) {
                                         done += static_cast<int>(to - from);
                                     });
                                     if (done != 64) isHalf = true;
                                 }),
                     Error);
        together += isEntered;
        EXPECT_FALSE(isHalf) << round;
    }
    setThreadCount(0);
    EXPECT_GT(together, 0) << "no two threads ever met: it shows nothing";
}

TEST(Progress, cancelsByAnError) {
    EXPECT_NO_THROW(report({}, 0.5));
    EXPECT_NO_THROW(report([](double) { return true; }, 0.5));
    EXPECT_THROW(report([](double) { return false; }, 0.5), Error);
}

}  // namespace
}  // namespace handpiece::core::parallel_test
