// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Finished fields on disk, so that a tooth opens at once the second time. docs/formats/field-cache.md has the format.
///
/// A case's folder goes from hand to hand, and what lies in it may have been made by anybody: sums in a file prove that
/// it is whole, not that it is true. So only files that this user alone wrote are read, everything that follows from
/// the case is compared with the case, and everything else has limits.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/field/distance_field.h"

namespace handpiece::field {

/// A number that differs when the surfaces, tissues, settings or the format do.
[[nodiscard]] std::uint64_t cacheKey(const cases::Case& toothCase, const FieldSettings& settings);

/// A checksum of bytes, on all threads: pieces of a mebibyte hashed side by side, the same number at any thread count.
[[nodiscard]] std::uint64_t hashOf(std::span<const std::byte> data);

/// The tissues that a tooth's parts can put anywhere, a bit each.
class TissueSet {
  public:
    explicit TissueSet(const cases::Case& toothCase);
    TissueSet(std::initializer_list<cases::Tissue> tissues);
    [[nodiscard]] bool has(std::uint8_t tissue) const { return tissue < 32 && (bits_ >> tissue & 1) != 0; }
    [[nodiscard]] bool hasAll(std::span<const std::uint8_t> tissues) const;

  private:
    std::uint32_t bits_ = 0;
};

/// The bytes of a cache file.
[[nodiscard]] std::vector<std::byte> encodeField(const DistanceField& field, std::uint64_t key);

/// The field of the surface in `tree`, or nothing when the file is missing, not this user's own, of another key or
/// format, truncated or damaged, or holds what this surface, these settings and these tissues cannot give: then the
/// caller builds anew. Grid and bricks are as they must be, all distances within what the bricks' centres allow, and
/// those at some hundred places, other ones each time, are compared with the surface itself.
[[nodiscard]] std::optional<DistanceField> readFieldFile(const std::filesystem::path& path, std::uint64_t key,
                                                         const geometry::TriangleTree& tree,
                                                         const FieldSettings& settings, const TissueSet& tissues);

/// The user's own folder for what can be made again: $XDG_CACHE_HOME or ~/.cache, handpiece in it; empty where there is
/// neither.
[[nodiscard]] std::filesystem::path userCacheFolder();

/// Where a field of this key may lie, the place to try first in front: the folder asked for; else beside the case
/// (.handpiece-cache), then the user's cache folder ($XDG_CACHE_HOME or ~/.cache, handpiece). A single file has no
/// beside.
[[nodiscard]] std::vector<std::filesystem::path> cachePlaces(const cases::Case& toothCase,
                                                             const std::filesystem::path& cacheFolder,
                                                             std::uint64_t key);

/// Writes to the first of `places` that can be written and where nothing lies that is another's, beside and renamed, so
/// that concurrent writers never mix. Returns where; empty when none can: no cache is no error.
[[nodiscard]] std::filesystem::path writeFieldFile(const std::vector<std::filesystem::path>& places,
                                                   const std::vector<std::byte>& data);

}  // namespace handpiece::field
