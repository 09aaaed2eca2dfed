// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Tables of numbers from and into CSV files. Numbers are written and read in the C locale.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/base/core/vec.h"

namespace handpiece::studies {

/// The columns asked for, by name, one row a line. Lines that are empty or begin with # are passed over.
struct CsvTable {
    std::vector<std::vector<double>> rows;
    std::vector<std::size_t> lines;  ///< in the file, from 1, for messages
    std::string source;
};

/// Reads `path` ("-": standard input). With a header the columns may stand in any order and others may be there;
/// without one there must be exactly `columns`. Throws core::Error with the line for what is no number or not finite.
[[nodiscard]] CsvTable readCsv(const std::string& path, const std::vector<std::string>& columns);

/// A pose from x, y, z, qw, qx, qy, qz; a quaternion within 1e-3 of unit length is normalised, any other refused.
[[nodiscard]] core::Pose poseFrom(const std::vector<double>& row, std::size_t first, const CsvTable& table,
                                  std::size_t index);

/// Writes text line by line into a file beside `path` and renames it into place when done: all or nothing. "-" is
/// standard output.
class TextWriter {
  public:
    explicit TextWriter(std::string path);
    ~TextWriter();  ///< without commit() the file is removed
    TextWriter(const TextWriter&) = delete;
    TextWriter& operator=(const TextWriter&) = delete;
    void write(std::string_view text);
    void commit();

  private:
    [[noreturn]] void fail();
    std::string path_, temporary_;
    std::FILE* file_ = nullptr;
};

}  // namespace handpiece::studies
