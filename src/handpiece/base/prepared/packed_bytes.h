// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Bytes packed by zlib in pieces, so that they are unpacked on all threads.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace handpiece::prepared {

/// Appends `data`, packed, to `out`. The same bytes at any thread count.
void pack(std::span<const std::byte> data, std::vector<std::byte>& out);

/// What was packed at the beginning of `packed`, which then begins after it; nothing where it is damaged, or more than
/// `mostBytes`.
[[nodiscard]] std::optional<std::vector<std::byte>> unpack(std::span<const std::byte>& packed, std::uint64_t mostBytes);

/// The bytes of numbers of `width` bytes, all first bytes first, then all second ones: numbers that are alike pack
/// better so. And back.
[[nodiscard]] std::vector<std::byte> inPlanes(std::span<const std::byte> data, std::size_t width);
[[nodiscard]] std::vector<std::byte> fromPlanes(std::span<const std::byte> planes, std::size_t width);

}  // namespace handpiece::prepared
