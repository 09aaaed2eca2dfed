// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The files of a case, wherever they lie. Private to this room.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "handpiece/base/config/table.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/case/package.h"

namespace handpiece::cases {

inline constexpr const char* kCaseFile = "case.toml";
/// Where an attempt's package keeps the case, when it does.
inline constexpr const char* kCaseInAttempt = "case/";

/// Where the files of a case are read from: a folder, or a package in memory.
struct CaseFiles {
    std::filesystem::path source;  ///< the folder or the package
    std::function<bool(const std::string& name)> has;
    /// Throws core::Error when there is none, or one of more bytes.
    std::function<std::vector<std::byte>(const std::string& name, std::uint64_t mostBytes)> read;
    /// As messages name it.
    std::function<std::string(const std::string& name)> where;
};
[[nodiscard]] CaseFiles filesInFolder(const std::filesystem::path& folder);
/// Those whose names begin with `prefix`. `files` must outlive the result.
[[nodiscard]] CaseFiles filesInPackage(const std::filesystem::path& package, const PackageFiles& files,
                                       const std::string& prefix = {});

/// One that is TOML, as text.
[[nodiscard]] std::string tomlIn(const CaseFiles& files, const std::string& name);
/// The case in these files. Throws core::Error.
[[nodiscard]] Case readCaseFiles(const CaseFiles& files);

/// Throws core::Error unless `name` is a file below the folder of the file that names it.
void requireInside(const config::Table& table, const std::string& name, std::string_view key);

/// As it stands in case.toml, without the heading.
[[nodiscard]] std::string exerciseToml(const Exercise& exercise);

/// A landmark from the tooth's origin: no tooth is as large.
inline constexpr double kFarthestLandmarkMm = 200.0;
/// The `landmark` tables of a tooth's table. Throws core::Error.
[[nodiscard]] std::vector<Landmark> readLandmarks(const config::Table& tooth);
/// As tables `key` ("landmark", "tooth.landmark"), to 10 nm.
[[nodiscard]] std::string landmarksToml(const std::vector<Landmark>& marks, std::string_view key);

}  // namespace handpiece::cases
