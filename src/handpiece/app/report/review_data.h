// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The arrays of a review, packed for a page. docs/review.md has the layout. Private to this room.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace handpiece::report {

/// A byte for every node of a grid, x fastest.
struct Volume {
    std::array<std::int32_t, 3> nodes{};
    std::vector<std::uint8_t> values;

    [[nodiscard]] std::size_t index(int x, int y, int z) const {
        return static_cast<std::size_t>(x) +
               static_cast<std::size_t>(nodes[0]) *
                   (static_cast<std::size_t>(y) + static_cast<std::size_t>(nodes[1]) * static_cast<std::size_t>(z));
    }
};

/// What each value differs by (modulo 256) from the sum of its neighbours before it along the axes, less those that
/// this counts twice: zero wherever values run straight.
[[nodiscard]] std::vector<std::uint8_t> differencesOf(const Volume& volume);
/// What each differs by (modulo 256) from the one before it.
[[nodiscard]] std::vector<std::uint8_t> stepsOf(const std::vector<std::uint8_t>& values);
/// Rows of whole numbers of 16 bits, each as what it differs by from the one before in its row: all low bytes of a row,
/// then all high ones.
[[nodiscard]] std::vector<std::uint8_t> planesOf(const std::vector<std::vector<std::uint16_t>>& rows);

/// Sections one after the other, as one zlib stream. Throws core::Error when memory is short.
[[nodiscard]] std::vector<std::byte> compressed(std::span<const std::vector<std::uint8_t>* const> sections);

}  // namespace handpiece::report
