// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What has been cut, by value: a brick, a state, a change.

#include <array>
#include <cstdint>
#include <vector>

#include "handpiece/model/field/field_view.h"
#include "handpiece/model/tooth/tissue_volumes.h"

namespace handpiece::tooth {

inline constexpr std::size_t kBrickBytes = sizeof(float) * field::kBrickValues;

/// One brick as it is now, by value: how listeners learn of a cut.
struct BrickSnapshot {
    std::uint32_t dense = 0;  ///< which brick: index x + bricks_x (y + bricks_y z)
    std::uint16_t tooth = 0;  ///< of a mouth
    bool shows = true;        ///< the surface may have moved in it since it was handed over last
    float values[field::kBrickValues];
};

/// Bricks that differ from the uncut tooth (a state), or that differ between two states (a change).
struct StateDelta {
    struct Brick {
        std::uint32_t dense;
        bool uncut;  ///< as before any cut; then `values` counts for nothing
        std::array<float, field::kBrickValues> values;
    };
    std::vector<Brick> bricks;   ///< at rising `dense`
    TissueVolumes removedMm3{};  ///< since the tooth was uncut
};
/// The same number for the same tooth, bit for bit; uncut bricks count for nothing.
[[nodiscard]] std::uint64_t stateHash(const StateDelta& state);
/// What turns a tooth in state `from` into one in state `to`: bricks that differ, uncut where `to` leaves them so.
[[nodiscard]] StateDelta changeBetween(const StateDelta& from, const StateDelta& to);

}  // namespace handpiece::tooth
