// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A bounded queue from one thread to one other. Full is a fact that is counted, never a reason to wait.

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/rt/triple_buffer.h"

namespace handpiece::rt {

/// One producer thread, one consumer thread. Wait-free on both sides; memory is taken, and written to so that it is
/// there, once, at construction.
template <class T>
requires std::is_trivially_copyable_v<T>
class SpscQueue {
  public:
    /// Holds at least `capacity` items (rounded up to a power of two).
    explicit SpscQueue(std::size_t capacity)
        : mask_(std::bit_ceil(capacity < 2 ? std::size_t{2} : capacity) - 1), items_(new T[mask_ + 1]()) {}

    /// False, and one more in overflowCount(), when the queue is full. Producer only.
    bool tryPush(const T& item) noexcept HANDPIECE_REALTIME {
        const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
        if (tail - headSeen_ > mask_) {
            headSeen_ = head_.load(std::memory_order_acquire);
            if (tail - headSeen_ > mask_) {
                overflow_.store(overflow_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
                return false;
            }
        }
        items_[tail & mask_] = item;
        tail_.store(tail + 1, std::memory_order_release);
        return true;
    }

    /// False when the queue is empty. Consumer only.
    bool tryPop(T& item) noexcept HANDPIECE_REALTIME {
        const std::uint64_t head = head_.load(std::memory_order_relaxed);
        if (head == tailSeen_) {
            tailSeen_ = tail_.load(std::memory_order_acquire);
            if (head == tailSeen_) return false;
        }
        item = items_[head & mask_];
        head_.store(head + 1, std::memory_order_release);
        return true;
    }

    [[nodiscard]] std::size_t capacity() const noexcept { return mask_ + 1; }
    /// Items that did not fit since construction. Any thread.
    [[nodiscard]] std::uint64_t overflowCount() const noexcept { return overflow_.load(std::memory_order_relaxed); }

  private:
    const std::size_t mask_;
    const std::unique_ptr<T[]> items_;
    alignas(kCacheLineBytes) std::atomic<std::uint64_t> tail_{0};
    std::uint64_t headSeen_ = 0;  // the producer's last look at head_
    std::atomic<std::uint64_t> overflow_{0};
    alignas(kCacheLineBytes) std::atomic<std::uint64_t> head_{0};
    std::uint64_t tailSeen_ = 0;  // the consumer's last look at tail_
};

}  // namespace handpiece::rt
