// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A field's tissues as files hold them. Private to this room.

#include <cstdint>
#include <vector>

#include "handpiece/model/field/distance_field.h"
#include "handpiece/model/field/field_cache.h"

namespace handpiece::field {

struct StoredTissues {
    /// At every brick's centre; one a stored brick, or all nodes of the mixed ones.
    std::vector<std::uint8_t> coarseTissue, tissueOfBrick, mixedTissues;

    [[nodiscard]] static StoredTissues of(const FieldStorage& field);
    /// Puts them into a field whose bricks stand. False where they are not of these tissues, or do not fit the bricks.
    [[nodiscard]] bool putInto(FieldStorage& field, const TissueSet& known) const;
};

}  // namespace handpiece::field
