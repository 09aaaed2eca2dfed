// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A school in one file, while it goes on, and back. docs/school-office.md#backup.

#include <cstdint>
#include <filesystem>
#include <string>

#include "handpiece/base/core/progress.h"
#include "handpiece/school/store/books.h"

namespace handpiece::school {

struct Backup {
    std::int64_t rows = 0, files = 0, keys = 0;
    std::uint64_t bytes = 0;  ///< of the files
};

/// By which the server signs: exams' packs and receipts, and for learning platforms. Of its folder.
inline constexpr const char* kServerKeys[] = {"exam.key", "lti.pem"};

/// A zip for its owner's eyes: backup.toml, tables/*.tsv, files/SHA256, keys/*. Throws core::Error as copyBooks() and
/// cases::writeLargePackage().
/// @param keys  whether those that are there go along
Backup backUp(const std::filesystem::path& data, const std::string& address, const std::filesystem::path& file,
              Milliseconds now, const std::string& program, bool keys, const core::Progress& progress = {});

/// Reads all of it and compares each part with its hash; nothing is written. Throws core::Error "not-a-package",
/// "store-damaged" (which part), "store-newer".
Backup checkBackup(const std::filesystem::path& file, const core::Progress& progress = {});

/// Into an empty school, after all of it was found good. Throws core::Error as checkBackup() and loadBooks(): then
/// nothing is there as before, but for content files that nobody names, which are swept. A key that is there already,
/// another one, is kept beside as NAME.before-restore-N.
Backup restore(const std::filesystem::path& file, const std::filesystem::path& data, const std::string& address,
               const core::Progress& progress = {});

}  // namespace handpiece::school
