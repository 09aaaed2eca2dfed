// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The latest value from one thread to one other: neither ever waits, and what nobody read is overwritten.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "handpiece/base/core/realtime.h"

namespace handpiece::rt {

/// x86-64 prefetches lines in pairs: two apart keeps writer and reader from sharing one.
inline constexpr std::size_t kCacheLineBytes = 128;

/// One writer thread, one reader thread. Wait-free on both sides; T is copied by value.
template <class T>
requires std::is_trivially_copyable_v<T>
class TripleBuffer {
  public:
    explicit TripleBuffer(const T& initial = T{}) noexcept {
        for (Slot& slot : slots_)
            slot.value = initial;
    }

    /// Replaces the latest value. Writer's thread only.
    void write(const T& value) noexcept HANDPIECE_REALTIME {
        slots_[back_].value = value;
        back_ = shared_.exchange(static_cast<std::uint8_t>(back_ | kFresh), std::memory_order_acq_rel) & kIndex;
    }

    /// The latest value; the same one again when nothing new was written. Reader's thread only.
    const T& read() noexcept HANDPIECE_REALTIME {
        if (shared_.load(std::memory_order_relaxed) & kFresh) {
            front_ = shared_.exchange(front_, std::memory_order_acq_rel) & kIndex;
        }
        return slots_[front_].value;
    }

    /// True when read() would give something not read before. Reader's thread only.
    [[nodiscard]] bool hasNews() const noexcept { return (shared_.load(std::memory_order_acquire) & kFresh) != 0; }

  private:
    static constexpr std::uint8_t kIndex = 3, kFresh = 4;
    struct alignas(kCacheLineBytes) Slot {
        T value;
    };
    std::array<Slot, 3> slots_;
    alignas(kCacheLineBytes) std::atomic<std::uint8_t> shared_{1};
    alignas(kCacheLineBytes) std::uint8_t back_ = 0;   // the writer's
    alignas(kCacheLineBytes) std::uint8_t front_ = 2;  // the reader's
};

}  // namespace handpiece::rt
