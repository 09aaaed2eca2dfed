// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A 64-bit content hash for cache keys and state hashes. Not for secrets. The same bits on every machine.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

namespace handpiece::core {

/// Mixes values into one 64-bit number; order matters. Little-endian by definition.
/// Method: 8 bytes at a time through the multiply-and-fold of wyhash (Wang Yi, public domain).
class Hasher {
  public:
    void add(std::span<const std::byte> data) noexcept {
        std::size_t i = 0;
        for (; i + 8 <= data.size(); i += 8) {
            std::uint64_t word;
            std::memcpy(&word, data.data() + i, 8);
            mix(word);
        }
        std::uint64_t tail = 0;
        if (i < data.size()) std::memcpy(&tail, data.data() + i, data.size() - i);
        mix(tail ^ (std::uint64_t{data.size()} << 56));
    }
    void add(std::string_view text) noexcept { add(std::as_bytes(std::span(text))); }
    template <class T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T>
    void add(T value) noexcept {
        std::uint64_t word = 0;
        std::memcpy(&word, &value, sizeof value);
        mix(word);
    }
    [[nodiscard]] std::uint64_t value() const noexcept {
        return fold(state_ ^ 0x9E3779B97F4A7C15ull, 0xD6E8FEB86659FD93ull);
    }

  private:
    static std::uint64_t fold(std::uint64_t a, std::uint64_t b) noexcept {
        const std::uint64_t aLow = a & 0xffffffffu, aHigh = a >> 32, bLow = b & 0xffffffffu, bHigh = b >> 32;
        const std::uint64_t low = aLow * bLow, m1 = aHigh * bLow + (low >> 32), m2 = aLow * bHigh + (m1 & 0xffffffffu);
        return (a * b) ^ (aHigh * bHigh + (m1 >> 32) + (m2 >> 32));
    }
    void mix(std::uint64_t word) noexcept {
        state_ = fold(state_ ^ word ^ 0xA0761D6478BD642Full, 0xE7037ED1A0B428DBull + ++count_);
    }

    std::uint64_t state_ = 0x2D358DCCAA6C78A5ull;
    std::uint64_t count_ = 0;
};

}  // namespace handpiece::core
