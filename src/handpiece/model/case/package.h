// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A .handpiece file: a case or an attempt as one zip, read into memory and never unpacked onto the disk.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace handpiece::cases {

struct Case;

/// Content by name; names are relative, with '/' between folders.
using PackageFiles = std::map<std::string, std::vector<std::byte>>;

/// What a package may be at most; beyond it is refused before anything is unpacked.
struct PackageLimits {
    std::size_t files = 1000;
    std::uint64_t bytes = 2ull << 30;         ///< all of it, unpacked
    double ratio = 200.0;                     ///< unpacked over packed, of all of it
    std::uint64_t bytesOfAnyRatio = 8 << 20;  ///< that little may be packed as tightly as it likes
};

/// The file's name ends in .handpiece (any case).
[[nodiscard]] bool isPackageName(const std::filesystem::path& path);

/// Throws core::Error for what is no zip, is damaged, encrypted or beyond the limits, and for names that are absolute,
/// lead outside, hold odd characters or stand twice, and for links.
[[nodiscard]] PackageFiles readPackage(const std::filesystem::path& file, const PackageLimits& limits = {});
/// The same; a file whose name is not wanted is in the result without its content.
[[nodiscard]] PackageFiles readPackage(const std::filesystem::path& file,
                                       const std::function<bool(const std::string& name)>& wanted);
/// The same of the file as it lies, whatever core::takenFrom() says: for what only tells what a file is.
[[nodiscard]] PackageFiles lookInto(const std::filesystem::path& file,
                                    const std::function<bool(const std::string& name)>& wanted);
/// The same from memory; `where` names it in messages.
[[nodiscard]] PackageFiles readPackage(std::span<const std::byte> zip, const std::string& where,
                                       const PackageLimits& limits = {});

/// As one zip. The same files give the same bytes. Recordings (.h5) are packed in themselves and stored as they are.
/// Throws core::Error.
[[nodiscard]] std::vector<std::byte> packed(const PackageFiles& files);
/// packed(), written beside its place and renamed into it.
void writePackage(const std::filesystem::path& file, const PackageFiles& files);

/// case.toml and all that it names, as writeCase() writes them.
[[nodiscard]] PackageFiles caseFiles(const Case& toothCase);

/// Writes the files into a folder, which must be new, empty, or hold `marker` (then it is replaced whole). They are
/// written into a folder beside it, which is renamed: after an error the old folder still stands.
void writeFolder(const std::filesystem::path& folder, const PackageFiles& files, const std::string& marker);

}  // namespace handpiece::cases
