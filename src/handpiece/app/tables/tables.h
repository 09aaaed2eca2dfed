// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Tables for other programs: CSV, and HDF5 with a dataset a column. docs/formats/results-table.md.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace handpiece::tables {

using Texts = std::vector<std::string>;
using Whole = std::vector<std::int64_t>;
using Numbers = std::vector<std::optional<double>>;  ///< none: empty in CSV, NaN in HDF5

struct Column {
    std::string name;  ///< small letters, digits, '_'
    std::string unit;  ///< empty: none, or said by the name
    std::variant<Texts, Whole, Numbers> values;
};
struct Table {
    std::string name;  ///< of its group
    std::vector<Column> columns;

    [[nodiscard]] std::size_t rows() const;
};

/// UTF-8, CRLF, RFC 4180; a cell that a spreadsheet would take for a formula has an apostrophe before it. Numbers are
/// the shortest that read back to the same bits.
[[nodiscard]] std::string toCsv(const Table& table);
/// A group a table, a one-dimensional dataset a column: texts of fixed length (UTF-8, padded with zeros), 64-bit whole
/// numbers, doubles; attributes "unit" of columns with one, "rows" of groups. The same tables give the same bytes.
/// Throws core::Error for a table whose columns are of unequal length, and for what cannot be written.
void writeHdf5(std::span<const Table> tables, const std::filesystem::path& file);
/// NAME.csv of each and results.h5, as one zip. Throws as writeHdf5().
[[nodiscard]] std::string toZip(std::span<const Table> tables);

}  // namespace handpiece::tables
