// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What lies where in a session file: names, types, units. docs/session-format.md says the same for people.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "handpiece/record/session/record.h"

namespace handpiece::session {

inline constexpr std::string_view kFormatName = "handpiece-session";
inline constexpr std::int32_t kFormatVersion =
    4;  // 3: no landmarks; 2: one tooth; 1: without the tissues after restoration

enum class NumberType : std::uint8_t { u8, u16, u32, i32, u64, i64, f32, f64 };
[[nodiscard]] std::size_t bytesOf(NumberType type) noexcept;

/// One dataset of /samples: a member of Record, tick by tick.
struct Column {
    const char* name;
    NumberType type;
    std::size_t width;   ///< numbers a tick; 1: the dataset has one dimension
    std::size_t offset;  ///< in Record
    const char* unit;
    const char* description;
    std::int32_t since = 1;  ///< the format that brought it
};
/// In the order they are written; "tick" is last, so what it counts is there in all others.
[[nodiscard]] std::span<const Column> columns() noexcept;

/// A row of /events. A long text goes on in rows with `part` 1, 2, ...
struct EventRow {
    std::uint64_t tick = 0;
    std::uint32_t part = 0;
    char name[28]{};  ///< ends with a zero byte, as `text` does
    char text[472]{};
};
static_assert(sizeof(EventRow) == 512);

/// A row of /key_frames/index.
struct KeyFrameRow {
    std::uint64_t tick = 0, offset = 0, bytes = 0, hash = 0;  ///< where in /key_frames/data; core::Hasher of the bytes
};

/// core::Hasher over a key frame's bytes.
[[nodiscard]] std::uint64_t hashOf(std::span<const std::byte> bytes) noexcept;

/// For people who open the file.
[[nodiscard]] std::string_view readme() noexcept;

/// Rows of a chunk of /samples: 0.7 s, so that less than a second is lost with the process.
[[nodiscard]] std::size_t chunkRows(double rateHz) noexcept;
inline constexpr std::size_t kEventChunk = 8, kKeyFrameIndexChunk = 64, kKeyFrameDataChunk = 1u << 16,
                             kBytesChunk = 1u << 16;
inline constexpr std::size_t kMaxToothBytes = std::size_t{1} << 30, kMaxHistoryBytes = std::size_t{1} << 26;

}  // namespace handpiece::session
