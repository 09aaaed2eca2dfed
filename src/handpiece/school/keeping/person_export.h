// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// All that a school holds of one person, as a file for them.

#include <filesystem>
#include <string>

#include "handpiece/school/store/books.h"

namespace handpiece::school {

/// A zip: what it is in plain words, each table as CSV, the files of their sessions. In the audit.
/// Throws core::Error as Books and cases::writeLargePackage().
void exportPerson(Books& books, const std::string& code, const std::filesystem::path& file, const Act& act);

}  // namespace handpiece::school
