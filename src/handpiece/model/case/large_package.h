// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Zip files larger than memory: written from files on the disk, read piece by piece.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "handpiece/base/core/progress.h"
#include "handpiece/model/case/package.h"

namespace handpiece::cases {

/// Packs `small`, and as they are the files of `onDisk`, by their names in it. For its owner's eyes only (0600); beside
/// its place first, then renamed into it: after an error the old file still stands.
/// Throws core::Error: "no-space", "not-writable", "cancelled" when `progress` says so.
void writeLargePackage(const std::filesystem::path& file, const PackageFiles& small,
                       const std::map<std::string, std::filesystem::path>& onDisk, const core::Progress& progress = {});

/// One that is read. Throws core::Error "not-a-package" for what is damaged, names an entry twice or is no zip, with
/// the name in it.
class LargePackage {
  public:
    explicit LargePackage(const std::filesystem::path& file);
    ~LargePackage();
    LargePackage(const LargePackage&) = delete;
    LargePackage& operator=(const LargePackage&) = delete;

    /// Names, and how many bytes they have unpacked.
    [[nodiscard]] const std::map<std::string, std::uint64_t>& files() const noexcept { return files_; }
    /// Piece by piece, and at the end its checksum is compared.
    void read(const std::string& name, const std::function<void(std::span<const std::byte>)>& piece) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
    std::string where_;
    std::map<std::string, std::uint64_t> files_;
};

}  // namespace handpiece::cases
