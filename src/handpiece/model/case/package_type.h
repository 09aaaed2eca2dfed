// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a .handpiece file says it is. docs/case-format.md#handpiece-files.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "handpiece/model/case/package.h"

namespace handpiece::cases {

/// An exam is a school's: nothing here opens one.
enum class PackageType { toothCase, attempt, exercise, handIn, exam };
inline constexpr std::array<std::string_view, 5> kPackageTypes = {"case", "attempt", "exercise", "hand-in", "exam"};
/// Says it: `format = 1` and `type`.
inline constexpr const char* kPackageFile = "handpiece.toml";

void setPackageType(PackageFiles& files, PackageType type);

/// What it says it is, else, of files of before, by what lies in it; none: neither. Of `files` the content of
/// kPackageFile alone is looked at. Throws core::Error: a type that there is not, a newer format, a file that lacks
/// what its type has.
[[nodiscard]] std::optional<PackageType> packageType(const PackageFiles& files, const std::string& where);
/// The same of a file on the disk, unpacking nothing else. Throws core::Error as readPackage() too.
[[nodiscard]] std::optional<PackageType> packageType(const std::filesystem::path& file);
/// Throws core::Error as packageType() does, and for an exam.
void requireOpenable(const PackageFiles& files, const std::string& where);

}  // namespace handpiece::cases
