// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How often which duration was seen, over hours in a fixed room.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "handpiece/base/core/portable_math.h"

namespace handpiece::simulation {

/// Durations by share, each to within 1.1 % (its cell, a 32nd of an octave); the largest exact. Any unit from 0.01 to
/// 10^7 of it; what is less counts as the least. One thread.
class Histogram {
  public:
    void add(double value) {
        if (!std::isfinite(value)) return;
        const double place = kCells / std::numbers::ln2 * core::log(std::max(value, kLeast) / kLeast);
        ++cells_[std::min(static_cast<std::size_t>(place), cells_.size() - 1)];
        ++count_;
        most_ = std::max(most_, value);
    }
    [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
    [[nodiscard]] double most() const noexcept { return most_; }
    /// The value below which this share, 0 to 1, of all lie; 0 without any.
    [[nodiscard]] double at(double share) const {
        const double wanted = share * static_cast<double>(count_);
        std::uint64_t seen = 0;
        for (std::size_t i = 0; i < cells_.size(); ++i) {
            seen += cells_[i];
            if (seen > 0 && static_cast<double>(seen) >= wanted)
                return std::min(most_, kLeast * core::pow(2.0, (static_cast<double>(i) + 0.5) / kCells));
        }
        return 0.0;
    }

  private:
    static constexpr double kLeast = 0.01, kCells = 32.0;
    std::array<std::uint64_t, 960> cells_{};  // 30 octaves
    std::uint64_t count_ = 0;
    double most_ = 0.0;
};

}  // namespace handpiece::simulation
