// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Reading and writing whole files, never half: a file is written beside its place and renamed into it.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace handpiece::core {

/// Closes a stream.
struct CloseFile {
    void operator()(std::FILE* stream) const noexcept { std::fclose(stream); }
};
using FileStream = std::unique_ptr<std::FILE, CloseFile>;

/// Opens a file for reading in binary. Throws core::Error: missing, a folder, unreadable, or no plain file (a device
/// has no end, and a pipe may never say anything).
[[nodiscard]] FileStream openFile(const std::filesystem::path& path);

/// True for what belongs to this user and is no link.
[[nodiscard]] bool isOurs(const std::filesystem::path& path);

/// Opens a plain file that this user wrote and nobody else can have: theirs, no link, writable by no one else. Nothing
/// for any other.
[[nodiscard]] FileStream openOwnFile(const std::filesystem::path& path);

/// Bytes of an open file; 0 where the system does not tell.
[[nodiscard]] std::uint64_t sizeOf(const FileStream& file);

/// The whole file. Throws as openFile(), and for one larger than `limitBytes`.
[[nodiscard]] std::vector<std::byte> readFile(const std::filesystem::path& path, std::uint64_t limitBytes = 8ull << 30);

/// A new file in place of what was there, to write and to read, that nobody else may look into (0600). A device stays
/// what it is. Null where that cannot be: errno tells why.
[[nodiscard]] FileStream createOwnFile(const std::filesystem::path& path);

/// How a file is written.
struct Writing {
    /// Where there was no file yet: for its owner's eyes only (0600), for a person's work or a patient's name.
    bool ownerOnly = false;
    /// On the disk, not only on its way there, when the call returns. Not needed for what can be made again.
    bool lasting = true;
};

/// Replaces `path` with `data` in one step: after an error (no permission, full disk) the old file still stands. The
/// new one has the old one's mode.
void writeFile(const std::filesystem::path& path, std::span<const std::byte> data, Writing how = {});
void writeFile(const std::filesystem::path& path, std::string_view text, Writing how = {});

/// Renames `made` to `path`, with the mode of the file that it replaces; `lasting` as above, of the file too.
/// Returns 0, or the error's number, and then nothing has changed.
[[nodiscard]] int replaceFile(const std::filesystem::path& made, const std::filesystem::path& path, bool lasting);

/// What lies at a path, if anything. Throws core::Error where one may not look, which std::filesystem's own questions
/// answer with an exception of their own.
[[nodiscard]] std::filesystem::file_status statusOf(const std::filesystem::path& path);
[[nodiscard]] bool isThere(const std::filesystem::path& path);
[[nodiscard]] bool isFolder(const std::filesystem::path& path);

/// From the root on. Throws core::Error where the folder one works in is gone.
[[nodiscard]] std::filesystem::path wholePath(const std::filesystem::path& path);

/// Throws core::Error unless there is nothing, an empty folder, or one that holds `marker`: a result of before.
void requireReplaceable(const std::filesystem::path& folder, const std::string& marker);

/// A new folder among the temporary files that nobody else may enter; goes with all that is in it.
class PrivateFolder {
  public:
    /// Throws core::Error.
    PrivateFolder();
    PrivateFolder(const PrivateFolder&) = delete;
    PrivateFolder& operator=(const PrivateFolder&) = delete;
    ~PrivateFolder();
    [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

  private:
    std::filesystem::path path_;
};

/// What an error of writing is called (Error::id): "no-space" where the disk is full, else "not-writable".
[[nodiscard]] std::string writeErrorId(int errorNumber);

/// Creates the folder and its parents and proves that a file can be written there. Throws core::Error. `ownerOnly`: if
/// it was not there, nobody else may look into it (0700).
void prepareOutputFolder(const std::filesystem::path& path, bool ownerOnly = false);

}  // namespace handpiece::core
