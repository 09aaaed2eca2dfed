// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A field as the packages carry it, a tenth of a cache file: which triangle each node's distance is of, from which the
/// distance is computed again, bit for bit. docs/formats/prepared.md has the format.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "handpiece/model/field/field_cache.h"

namespace handpiece::field {

/// `nearest`: as FieldBuilder::fromSurface() gave it with this field.
[[nodiscard]] std::vector<std::byte> packField(const DistanceField& field, std::span<const std::uint32_t> nearest,
                                               std::uint64_t key);

/// The field of the surface in `tree`, or nothing where the bytes are of another key, surface or settings.
[[nodiscard]] std::optional<DistanceField> unpackField(std::span<const std::byte> packed, std::uint64_t key,
                                                       const geometry::TriangleTree& tree,
                                                       const FieldSettings& settings, const TissueSet& tissues);

}  // namespace handpiece::field
