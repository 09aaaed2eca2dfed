// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Numbers as good as random, the same everywhere (splitmix64, Steele, Lea & Flood 2014).

#include <cstdint>

namespace handpiece::core {

inline constexpr std::uint64_t kSplitMixStep = 0x9E3779B97F4A7C15ull;

/// Bits of a counter.
[[nodiscard]] constexpr std::uint64_t splitMix(std::uint64_t counter) noexcept {
    std::uint64_t z = counter + kSplitMixStep;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
}
/// Those of a state, which goes on to the next.
[[nodiscard]] constexpr std::uint64_t nextSplitMix(std::uint64_t& state) noexcept {
    const std::uint64_t bits = splitMix(state);
    state += kSplitMixStep;
    return bits;
}
/// In [0, 1), in steps of 2^-53.
[[nodiscard]] constexpr double unitOf(std::uint64_t bits) noexcept {
    return static_cast<double>(bits >> 11) * 0x1p-53;
}

}  // namespace handpiece::core
