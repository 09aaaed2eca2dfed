// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A desk as a table for spreadsheets, and as a page of the class.

#include <string>
#include <vector>

#include "handpiece/app/marking/desk.h"

namespace handpiece::marking {

enum class Naming { codesOnly, withFiles };

/// A line a work (docs/marking.md#resultscsv): final score and machine's beside each other, then for each criterion
/// points and band, the machine's, the reason. What is hidden yet is empty.
[[nodiscard]] std::string resultsCsv(const Desk& desk, Naming naming);

/// One HTML page in the program's language (report::classReport) of the final scores, the marker's decisions among
/// them, each work once. What is hidden yet, or has no score, is not in it.
[[nodiscard]] std::string classPage(const Desk& desk, Naming naming);

/// Cells as RFC 4180 has them. One that a spreadsheet would take for a formula gets an apostrophe.
[[nodiscard]] std::string csvLine(const std::vector<std::string>& cells);

}  // namespace handpiece::marking
