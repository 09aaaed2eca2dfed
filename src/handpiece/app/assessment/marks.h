// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Marks that several raters gave the same items, from a CSV file (docs/agreement.md#the-file).

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace handpiece::assessment {

/// Of one criterion.
struct MarkTable {
    std::string criterion;                          ///< empty: the file has no such column
    std::vector<std::string> items, raters;         ///< in the order of the file
    std::vector<std::optional<std::string>> marks;  ///< [item * raters + rater]; none: not marked
    std::string where;
};

inline constexpr std::uint64_t kMaxMarksBytes = 16u << 20;
inline constexpr std::size_t kMaxRaters = 50, kMaxCells = 2'000'000;

/// Throws core::Error with the line: no header, a column that is missing, a row cut short, a mark given twice, sizes
/// beyond the limits.
[[nodiscard]] std::vector<MarkTable> parseMarks(std::string_view text, const std::string& where);
[[nodiscard]] std::vector<MarkTable> readMarks(const std::filesystem::path& file);

}  // namespace handpiece::assessment
