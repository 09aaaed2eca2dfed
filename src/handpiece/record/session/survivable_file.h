// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// An HDF5 file driver whose file can be opened by any HDF5 reader at any moment, also after kill -9 or a full disk.
///
/// HDF5's single-writer mode writes in an order in which every prefix of the writes is a sound file, but for three
/// things that this driver mends on the way to the disk: the mark "open for writing" in the superblock, with which
/// other programs refuse the file; the end of file noted there, which would lie before the newest data; and, once a
/// write has failed, the writes that would follow it.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

namespace handpiece::session {

/// What the driver found out; outlives the HDF5 file.
struct FileState {
    ~FileState();                 ///< a file that never came into its place is given up
    std::filesystem::path place;  ///< where the file belongs
    std::filesystem::path begun;  ///< where it is now: beside that until putInPlace()
    std::string failure;          ///< why nothing is written any more; empty while all is well
    int errorNumber = 0;          ///< of the system, with it
    std::uint64_t sizeBytes = 0;  ///< written so far
    /// For tests: sees every change of the file. `data` empty: the file's length becomes `address`.
    std::function<void(std::uint64_t address, std::span<const unsigned char> data)> observer;
};

/// Makes a new HDF5 file through the driver, beside its place: until the single-writer mode begins a file is no sound
/// one. Returns the file's identifier (hid_t), to be closed by H5Fclose. Throws core::Error when the place cannot be
/// written.
[[nodiscard]] std::int64_t createSurvivableFile(const std::filesystem::path& path, FileState& state);
/// Opens one that was made so, to go on in it; what it holds stays sound at every moment. Throws core::Error when it
/// cannot be written or is no HDF5 file.
[[nodiscard]] std::int64_t reopenSurvivableFile(const std::filesystem::path& path, FileState& state);
/// From now on it is sound at every moment: puts it in its place, in place of what was there. Throws core::Error.
void putInPlace(FileState& state);
}  // namespace handpiece::session
