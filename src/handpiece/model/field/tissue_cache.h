// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Finished tissue maps on disk, beside the field's cache. docs/formats/tissue-cache.md has the format.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "handpiece/model/field/field_cache.h"
#include "handpiece/model/field/tissue_map.h"

namespace handpiece::field {

/// A number that differs when the field's key (cacheKey()) or this format does.
[[nodiscard]] std::uint64_t tissueKey(std::uint64_t fieldKey);

/// The bytes of a cache file.
[[nodiscard]] std::vector<std::byte> encodeTissues(const TissueMap& map, std::uint64_t key);

/// What the file holds, or nothing when it is missing, not this user's own, of another key, grid or format, truncated
/// or damaged, or holds what this grid and these tissues cannot give: then the caller builds anew.
[[nodiscard]] std::optional<TissueMap> readTissueFile(const std::filesystem::path& path, const DistanceField& grid,
                                                      std::uint64_t key, const TissueSet& tissues);

/// The same, packed for what is prepared, and back.
[[nodiscard]] std::vector<std::byte> packTissues(const TissueMap& map, std::uint64_t key);
[[nodiscard]] std::optional<TissueMap> unpackTissues(std::span<const std::byte> packed, const DistanceField& grid,
                                                     std::uint64_t key, const TissueSet& tissues);

}  // namespace handpiece::field
