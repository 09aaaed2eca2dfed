// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the sources of the cut field share: bricks by number, their tissues, volumes by tissue.

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>

#include "handpiece/model/tooth/cut_field.h"

namespace handpiece::tooth {

[[nodiscard]] inline std::array<std::int32_t, 3> brickAt(const std::int32_t (&bricks)[3],
                                                         std::uint32_t dense) noexcept {
    const auto nx = static_cast<std::uint32_t>(bricks[0]), ny = static_cast<std::uint32_t>(bricks[1]);
    return {static_cast<std::int32_t>(dense % nx), static_cast<std::int32_t>(dense / nx % ny),
            static_cast<std::int32_t>(dense / nx / ny)};
}

[[nodiscard]] inline std::uint32_t denseOf(const std::int32_t (&bricks)[3],
                                           const std::array<std::int32_t, 3>& brick) noexcept {
    return static_cast<std::uint32_t>(brick[0]) +
           static_cast<std::uint32_t>(bricks[0]) *
               (static_cast<std::uint32_t>(brick[1]) +
                static_cast<std::uint32_t>(bricks[1]) * static_cast<std::uint32_t>(brick[2]));
}

/// Writes the tissue of a brick's nodes.
inline void copyTissues(const TissueMap& map, std::uint32_t dense, std::uint8_t* out) noexcept {
    const std::uint8_t* nodes = map.nodes(dense);
    if (nodes != nullptr)
        std::copy_n(nodes, kBrickValues, out);
    else
        std::fill_n(out, kBrickValues, static_cast<std::uint8_t>(map.ofBrick(dense)));
}

/// Volume by tissue; `valuesOf(dense)` gives a brick's values, null where it is whole. In parallel, the same bits at
/// any thread count.
[[nodiscard]] TissueVolumes integrateVolumes(const CuttableTooth& base,
                                             const std::function<const float*(std::uint32_t dense)>& valuesOf);

}  // namespace handpiece::tooth
