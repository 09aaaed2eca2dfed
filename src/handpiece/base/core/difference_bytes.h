// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Whole numbers as bytes: seven bits a byte, the low ones first; small differences of either sign stay small.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace handpiece::core {

inline void appendDifference(std::vector<std::byte>& bytes, std::int64_t difference) {
    auto rest = (static_cast<std::uint64_t>(difference) << 1) ^ static_cast<std::uint64_t>(difference >> 63);
    for (; rest >= 0x80; rest >>= 7)
        bytes.push_back(static_cast<std::byte>(rest | 0x80));
    bytes.push_back(static_cast<std::byte>(rest));
}

/// The most bytes that one takes.
inline constexpr std::size_t kMaxDifferenceBytes = 9;
/// Takes one from the front of `bytes`, which is shortened by it. None, and nothing is taken, where the bytes end
/// before it does, or it goes on beyond the most.
[[nodiscard]] inline std::optional<std::int64_t> takeDifference(std::span<const std::byte>& bytes) {
    std::uint64_t value = 0;
    std::size_t at = 0;
    while (at < std::min(bytes.size(), kMaxDifferenceBytes)) {
        const auto byte = std::to_integer<std::uint64_t>(bytes[at]);
        value |= (byte & 0x7f) << (7 * at++);
        if (byte >= 0x80) continue;
        bytes = bytes.subspan(at);
        return static_cast<std::int64_t>(value >> 1) ^ -static_cast<std::int64_t>(value & 1);
    }
    return std::nullopt;
}

}  // namespace handpiece::core
