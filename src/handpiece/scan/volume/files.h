// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The files that a path stands for: one file, a folder with what is below it, a ZIP, what a DICOMDIR lists.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/base/core/file.h"

namespace handpiece::volume {

/// One file, on disk or in memory, read at any place. Not for several threads at once.
class Input {
  public:
    /// Throws core::Error (missing, unreadable).
    explicit Input(const std::filesystem::path& path);
    Input(std::shared_ptr<const std::vector<std::byte>> data, std::string where);

    [[nodiscard]] std::uint64_t size() const { return size_; }
    /// Names it in messages.
    [[nodiscard]] const std::string& where() const { return where_; }
    /// Fewer than `count` only at the end.
    [[nodiscard]] std::size_t readAt(std::uint64_t at, void* to, std::size_t count);

  private:
    core::FileStream file_;
    std::shared_ptr<const std::vector<std::byte>> memory_;
    std::string where_;
    std::uint64_t size_ = 0, windowAt_ = 0;
    std::vector<std::byte> window_;
};

/// What a ZIP may unpack to: one file is held in memory, all of them are read in the course of time.
struct ArchiveLimits {
    std::uint64_t fileBytes = 4ull << 30, totalBytes = 64ull << 30;
};

/// Files by relative name, in natural order ("slice9" before "slice10").
class FileSet {
  public:
    struct Entry {
        std::string name;  ///< relative to what was opened, steps by '/'
        std::uint64_t bytes = 0;
    };

    /// Throws core::Error (missing, unreadable, a damaged ZIP, too many files, more in a ZIP than its limits).
    [[nodiscard]] static std::shared_ptr<const FileSet> open(const std::filesystem::path& path,
                                                             const ArchiveLimits& limits = {});
    struct InMemory {
        std::string name;
        std::vector<std::byte> data;
    };
    /// The files of a ZIP that is in memory; `where` names it in messages.
    [[nodiscard]] static std::shared_ptr<const FileSet> inArchive(std::vector<std::byte> zip, std::string where,
                                                                  const ArchiveLimits& limits = {});
    /// Files that are in memory; the first is the one that was named.
    [[nodiscard]] static std::shared_ptr<const FileSet> inMemory(std::vector<InMemory> files);

    FileSet(const FileSet&) = delete;
    FileSet& operator=(const FileSet&) = delete;
    ~FileSet();

    [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
    [[nodiscard]] int folderCount() const { return folders_; }
    /// On disk: of a ZIP its own size.
    [[nodiscard]] std::uint64_t storedBytes() const { return storedBytes_; }
    /// What was opened, for messages.
    [[nodiscard]] const std::string& where() const { return where_; }
    [[nodiscard]] std::string where(std::size_t index) const;
    /// From several threads at once.
    [[nodiscard]] Input open(std::size_t index) const;
    /// Its first bytes, without unpacking the rest.
    [[nodiscard]] std::size_t head(std::size_t index, void* to, std::size_t count) const;
    /// The whole file; throws core::Error where it is larger.
    [[nodiscard]] std::vector<std::byte> bytes(std::size_t index, std::uint64_t limitBytes) const;
    /// In the folder of `beside`; names that lead elsewhere are never found, links that do throw core::Error.
    [[nodiscard]] std::optional<std::size_t> find(std::string_view beside, std::string_view name) const;
    /// True where the one file was named, not found in a folder or an archive.
    [[nodiscard]] bool isNamed(std::size_t index) const { return named_ && *named_ == index; }

  private:
    struct Archive;
    FileSet();
    void addFolder(const std::filesystem::path& folder);
    void addArchive(std::unique_ptr<Archive> archive, const ArchiveLimits& limits);
    void sort();

    std::vector<Entry> entries_;
    std::filesystem::path root_;
    std::string where_;
    int folders_ = 0;
    std::uint64_t storedBytes_ = 0;
    std::unique_ptr<Archive> archive_;
    std::map<std::string, std::shared_ptr<const std::vector<std::byte>>> memory_;
    std::optional<std::size_t> named_;
};

/// "slice9" before "slice10": runs of digits are compared as numbers.
[[nodiscard]] bool naturalLess(std::string_view a, std::string_view b);
/// In small letters, with the dot: ".nrrd"; empty when there is none.
[[nodiscard]] std::string extensionOf(std::string_view name);
/// Up to and with the last '/'.
[[nodiscard]] std::string_view folderOf(std::string_view name);

}  // namespace handpiece::volume
