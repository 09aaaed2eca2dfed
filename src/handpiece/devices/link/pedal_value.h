// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a foot does, from the thread that reads its pedal to the tick.

#include <atomic>
#include <cstdint>

#include "handpiece/base/core/realtime.h"

namespace handpiece::link {

/// The latest value of a pedal and when it was read. One writer, any readers; nobody waits.
class PedalValue {
  public:
    static constexpr std::int64_t kKeepsNs = 250'000'000;  ///< an older value is that of a lost pedal

    /// 0..1; what is no number is none.
    void write(float value, std::int64_t nowNs) noexcept HANDPIECE_REALTIME {
        value_.store(value > 0.0f ? (value < 1.0f ? value : 1.0f) : 0.0f, std::memory_order_relaxed);
        timeNs_.store(nowNs, std::memory_order_release);
    }
    /// 0 when there is no pedal, when it is lost and when its reader stands.
    [[nodiscard]] float read(std::int64_t nowNs) const noexcept HANDPIECE_REALTIME {
        const std::int64_t at = timeNs_.load(std::memory_order_acquire);
        return at != 0 && nowNs - at < kKeepsNs ? value_.load(std::memory_order_relaxed) : 0.0f;
    }

  private:
    std::atomic<float> value_{0.0f};
    std::atomic<std::int64_t> timeNs_{0};
};

}  // namespace handpiece::link
