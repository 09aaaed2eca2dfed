// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Lists of people as files: a table of one's own (CSV), or OneRoster 1.1 (1EdTech OneRoster: CSV Tables).
/// docs/school-office.md#a-list-of-people.

#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/school/store/books_roster.h"

namespace handpiece::school {

/// Columns code, name, login, role, class, class role; all but the first may be left out.
/// Throws core::Error "list-unfit" with line and column.
[[nodiscard]] Roster peopleList(std::string_view bytes, const std::string& where);

/// manifest.csv and the tables that it names, by their names. Of the roles student, teacher and administrator are read.
/// `today` is "2026-11-27": enrolments have days on which they begin and end.
/// Throws core::Error "list-unfit" with file, line and column.
[[nodiscard]] Roster oneRoster(const std::map<std::string, std::vector<std::byte>>& files, const std::string& where,
                               const std::string& today);

/// Whichever it is: a CSV file, a folder with manifest.csv, or a zip of one.
[[nodiscard]] Roster readRoster(const std::filesystem::path& path, const std::string& today);
/// The same from memory, as it comes over a wire.
[[nodiscard]] Roster readRoster(std::span<const std::byte> bytes, const std::string& name, const std::string& today);

}  // namespace handpiece::school
