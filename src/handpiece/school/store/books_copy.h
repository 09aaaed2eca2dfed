// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The books as files, and back: the same from SQLite and PostgreSQL, so that what was copied from one goes into the
/// other too.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/school/store/books_room.h"

namespace handpiece::school {

struct CopiedTable {
    std::string name{};  ///< its file is name.tsv
    std::int64_t rows = 0;
};
struct BooksCopy {
    int version = 0;                    ///< of the books
    std::vector<CopiedTable> tables{};  ///< each refers to earlier ones only
    std::vector<std::string> files{};   ///< SHA-256 of the content files that belong to them
};

/// One state of all tables, while others go on reading and writing. In `folder`, which is there and empty: a file a
/// table, and under files/ the content files (links where the disk allows it, so that they stay even if the school
/// throws them away in the meantime).
/// Throws core::Error as Books, "no-space", "not-writable", and "store-damaged" for a content file that is not there.
[[nodiscard]] BooksCopy copyBooks(const std::filesystem::path& data, const std::string& address,
                                  const std::filesystem::path& folder);

/// Into books that have nothing yet, in one transaction; they come up to this program's version. Whoever was logged in
/// is no longer. Content files of `folder` that are as their names say are moved to the others first.
/// Throws core::Error: "store-not-empty", "store-newer", "store-damaged" (table and line), and as Books.
void loadBooks(const BooksCopy& copy, const std::filesystem::path& folder, const std::filesystem::path& data,
               const std::string& address);

}  // namespace handpiece::school
