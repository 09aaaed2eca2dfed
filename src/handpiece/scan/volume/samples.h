// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Numbers as they lie in files: all types, both byte orders, plain or packed by zlib.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "handpiece/scan/volume/candidate.h"

namespace handpiece::volume {

enum class SampleType { u8, i8, u16, i16, u32, i32, u64, i64, f32, f64 };

[[nodiscard]] std::size_t bytesOf(SampleType type);
/// To float, of any alignment. True order of bytes: `isBigEndian`.
void convert(SampleType type, bool isBigEndian, double slope, double intercept, const std::byte* from,
             std::size_t count, float* to);
/// True when 16-bit values make far smoother rows the other way round.
[[nodiscard]] bool looksSwapped(SampleType type, bool isBigEndian, const std::byte* from, std::size_t count);

/// A block of numbers in a file, i fastest.
struct Samples {
    Files files;
    std::size_t file = 0;
    std::uint64_t offset = 0;  ///< where it begins
    bool isPacked = false;     ///< zlib or gzip, from the offset on
    std::uint64_t skip = 0;    ///< bytes to pass over in what is unpacked
    SampleType type = SampleType::u8;
    bool isBigEndian = false;
    double slope = 1, intercept = 0;
    std::array<int, 3> size{};
    std::string orderRemedy;  ///< what to do about a wrong byte order; empty: the format tells it for certain
};
/// Gives the candidate its slice and load; `problem` where the file is too short or in the wrong byte order.
void setSamples(Candidate& candidate, Samples samples);
/// Throws core::Error for sizes that are none, or products beyond any memory.
void checkSize(const std::array<std::int64_t, 3>& size, const std::string& where);

}  // namespace handpiece::volume
