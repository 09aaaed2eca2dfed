// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Finished fields on disk, so that a tooth opens at once the second time. docs/formats/field-cache.md has the format.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/tooth/tooth.h"

namespace handpiece::tooth {

/// What a cache file holds: the field, and how the triangles of the outer surface lie in their tree.
struct CachedField {
    ToothField field;
    geometry::TriangleTree::Storage tree;
};

/// A number that differs when the surfaces, tissues, settings or the format do.
[[nodiscard]] std::uint64_t cacheKey(const Case& toothCase, const FieldSettings& settings);

/// A checksum of bytes, on all threads: pieces of a mebibyte hashed side by side, the same number at any thread count.
[[nodiscard]] std::uint64_t hashOf(std::span<const std::byte> data);

/// The bytes of a cache file.
[[nodiscard]] std::vector<std::byte> encodeField(const ToothField& field, const geometry::TriangleTree& tree,
                                                 std::uint64_t key);

/// What the file holds, or nothing when it is missing, unreadable, of another key or format, truncated or damaged: then
/// the caller builds anew. Sizes are believed only after the header's checksum and the file's own length agree with
/// them.
[[nodiscard]] std::optional<CachedField> readFieldFile(const std::filesystem::path& path, std::uint64_t key);

/// Where a field of this key may lie, the place to try first in front: the folder asked for; else beside the case
/// (.handpiece-cache), then the user's cache folder ($XDG_CACHE_HOME or ~/.cache, handpiece). A single file has no
/// beside.
[[nodiscard]] std::vector<std::filesystem::path> cachePlaces(const Case& toothCase,
                                                             const std::filesystem::path& cacheFolder,
                                                             std::uint64_t key);

/// Writes to the first of `places` that can be written, beside and renamed, so that concurrent writers never mix.
/// Returns where; empty when none can: no cache is no error.
[[nodiscard]] std::filesystem::path writeFieldFile(const std::vector<std::filesystem::path>& places,
                                                   const std::vector<std::byte>& data);

}  // namespace handpiece::tooth
