// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What came with the program ready made: teeth and their fields, each believed only when its SHA-256 is in the
/// program.
///
/// A file that is missing, of another version or changed is as if there were none: what it holds is made as without it.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace handpiece::prepared {

/// A file's name in the folder, and the SHA-256 of its bytes in 64 hexadecimal digits.
struct Believed {
    std::string_view name, sha256;
};

/// In hexadecimal digits.
[[nodiscard]] std::string sha256Of(std::span<const std::byte> data);

/// Of the programs' folders: beside the program (../share/handpiece/prepared of where it lies), then the system's. The
/// first that is there; empty where none is.
[[nodiscard]] std::filesystem::path installedFolder();

/// From now on read() looks here. `believed` must outlive it. `tell` hears the first thing that is wrong, once, on
/// whatever thread looks. Before any other thread runs.
void use(std::filesystem::path folder, std::span<const Believed> believed,
         std::function<void(const std::string& problem)> tell);

/// Whether the program believes a file of this name, be it there or not.
[[nodiscard]] bool isKnown(std::string_view name);
/// Its bytes, or nothing. Any thread.
[[nodiscard]] std::optional<std::vector<std::byte>> read(std::string_view name);
/// As the one who read it found it to hold something else than it should.
void refuse(std::string_view name);

/// From now on whatever could have been prepared is written there by keep(), for the program that prepares. Empty: no
/// longer.
void collectIn(std::filesystem::path folder);
[[nodiscard]] bool isCollecting();
/// Throws core::Error where it cannot be written.
void keep(std::string_view name, std::span<const std::byte> data);

/// The source of a list of what lies in the folder, `name` the function that gives it: by name, the same text for the
/// same files.
[[nodiscard]] std::string listSource(const std::filesystem::path& folder);

}  // namespace handpiece::prepared
