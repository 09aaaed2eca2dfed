// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

#include "handpiece/base/rt/spsc_queue.h"
#include "handpiece/base/rt/triple_buffer.h"

namespace handpiece::rt::queue_test {
namespace {

/// Big enough to be torn when copied by two threads at once.
struct Message {
    std::array<std::uint64_t, 24> words{};

    static Message of(std::uint64_t number) {
        Message m;
        for (std::size_t i = 0; i < m.words.size(); ++i)
            m.words[i] = number * 31 + i;
        return m;
    }
    [[nodiscard]] std::uint64_t number() const { return words[0] / 31; }
    [[nodiscard]] bool isWhole() const {
        for (std::size_t i = 0; i < words.size(); ++i) {
            if (words[i] != words[0] + i) return false;
        }
        return words[0] % 31 == 0;
    }
};

TEST(SpscQueue, holdsItsCapacityAndCountsTheRest) {
    SpscQueue<int> queue(5);
    ASSERT_EQ(queue.capacity(), 8u);
    for (int i = 0; i < 11; ++i)
        EXPECT_EQ(queue.tryPush(i), i < 8);
    EXPECT_EQ(queue.overflowCount(), 3u);
    int value = -1;
    for (int i = 0; i < 8; ++i) {
        ASSERT_TRUE(queue.tryPop(value));
        EXPECT_EQ(value, i);
    }
    EXPECT_FALSE(queue.tryPop(value));
    EXPECT_TRUE(queue.tryPush(99));
    ASSERT_TRUE(queue.tryPop(value));
    EXPECT_EQ(value, 99);
}

TEST(SpscQueue, losesNothingAndKeepsOrderBetweenThreads) {
    constexpr std::uint64_t kCount = 200'000;
    SpscQueue<Message> queue(64);
    std::thread producer([&] {
        for (std::uint64_t i = 0; i < kCount; ++i) {
            while (!queue.tryPush(Message::of(i)))
                std::this_thread::yield();
        }
    });
    std::uint64_t broken = 0, outOfOrder = 0;
    for (std::uint64_t expected = 0; expected < kCount;) {
        Message m;
        if (!queue.tryPop(m)) {
            std::this_thread::yield();
            continue;
        }
        broken += !m.isWhole();
        outOfOrder += m.number() != expected;
        ++expected;
    }
    producer.join();
    EXPECT_EQ(broken, 0u);
    EXPECT_EQ(outOfOrder, 0u);
}

TEST(SpscQueue, pushedPlusOverflowedIsWhatWasTried) {
    constexpr std::uint64_t kCount = 100'000;
    SpscQueue<std::uint64_t> queue(16);
    std::atomic<bool> done{false};
    std::uint64_t popped = 0, last = 0;
    bool rising = true;
    std::thread consumer([&] {
        std::uint64_t value = 0;
        for (bool finished = false; !finished;) {
            finished = done.load(std::memory_order_acquire);
            while (queue.tryPop(value)) {
                rising = rising && value > last;
                last = value;
                ++popped;
            }
            std::this_thread::yield();
        }
    });
    for (std::uint64_t i = 1; i <= kCount; ++i)
        queue.tryPush(i);
    done.store(true, std::memory_order_release);
    consumer.join();
    EXPECT_EQ(popped + queue.overflowCount(), kCount);
    EXPECT_TRUE(rising);
}

TEST(TripleBuffer, readsTheLatestWholeValue) {
    constexpr std::uint64_t kCount = 200'000;
    TripleBuffer<Message> buffer(Message::of(0));
    EXPECT_FALSE(buffer.hasNews());
    std::thread writer([&] {
        for (std::uint64_t i = 1; i <= kCount; ++i)
            buffer.write(Message::of(i));
    });
    std::uint64_t last = 0, broken = 0, backwards = 0;
    while (last < kCount) {
        const Message& m = buffer.read();
        broken += !m.isWhole();
        backwards += m.number() < last;
        last = m.number();
        std::this_thread::yield();
    }
    writer.join();
    EXPECT_EQ(broken, 0u);
    EXPECT_EQ(backwards, 0u);
    EXPECT_FALSE(buffer.hasNews());
    EXPECT_EQ(buffer.read().number(), kCount);
}

}  // namespace
}  // namespace handpiece::rt::queue_test
