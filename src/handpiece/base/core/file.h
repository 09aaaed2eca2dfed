// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Reading and writing whole files, never half: a file is written beside its place and renamed into it.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace handpiece::core {

/// The whole file. Throws core::Error (missing, a folder, unreadable, larger than `limitBytes`).
[[nodiscard]] std::vector<std::byte> readFile(const std::filesystem::path& path, std::uint64_t limitBytes = 8ull << 30);

/// Replaces `path` with `data` in one step: after an error (no permission, full disk) the old file still stands.
void writeFile(const std::filesystem::path& path, std::span<const std::byte> data);
void writeFile(const std::filesystem::path& path, std::string_view text);

/// What an error of writing is called (Error::id): "no-space" where the disk is full, else "not-writable".
[[nodiscard]] std::string writeErrorId(int errorNumber);

/// Creates the folder and its parents and proves that a file can be written there. Throws core::Error.
void prepareOutputFolder(const std::filesystem::path& path);

}  // namespace handpiece::core
