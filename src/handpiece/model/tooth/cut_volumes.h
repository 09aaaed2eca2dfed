// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the sources of the cut field share: tissues of a brick, volumes by tissue.

#include <algorithm>
#include <cstdint>
#include <functional>

#include "handpiece/model/field/brick_index.h"
#include "handpiece/model/tooth/cut_field.h"

namespace handpiece::tooth {

/// Writes the tissue of a brick's nodes.
inline void copyTissues(const field::TissueMap& map, std::uint32_t dense, std::uint8_t* out) noexcept {
    const std::uint8_t* nodes = map.nodes(dense);
    if (nodes != nullptr)
        std::copy_n(nodes, field::kBrickValues, out);
    else
        std::fill_n(out, field::kBrickValues, static_cast<std::uint8_t>(map.ofBrick(dense)));
}

/// Volume by tissue; `valuesOf(dense)` gives a brick's values, null where it is whole. In parallel, the same bits at
/// any thread count.
[[nodiscard]] TissueVolumes integrateVolumes(const CuttableTooth& base,
                                             const std::function<const float*(std::uint32_t dense)>& valuesOf);

}  // namespace handpiece::tooth
