// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Where gingiva has been cut, for pictures of it. Nothing of the tooth, and no force, depends on it.

#include <atomic>
#include <cstdint>
#include <mutex>
#include <vector>

#include "handpiece/base/messages/gingiva_cut.h"
#include "handpiece/base/messages/haptic_sample.h"

namespace handpiece::instrument {
class Bur;
}

namespace handpiece::simulation {

/// Fed with every sample, so that a replay has the same cuts. Any thread.
class GingivaCuts {
  public:
    /// Of more a mouth is red all over.
    static constexpr std::size_t kMost = 300;

    /// Samples by rising time; what is no later than the last cut is known.
    void hear(const messages::HapticSample& sample, const instrument::Bur& bur);
    /// It is whole again.
    void clear();
    [[nodiscard]] std::vector<messages::GingivaCut> all() const;
    [[nodiscard]] bool isEmpty() const;
    /// Another number when all() is another.
    [[nodiscard]] std::uint64_t version() const noexcept { return version_.load(std::memory_order_acquire); }

  private:
    mutable std::mutex mutex_;
    std::vector<messages::GingivaCut> cuts_;
    std::atomic<std::uint64_t> version_{0};
};

}  // namespace handpiece::simulation
