// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What has been cut of the teeth of a mouth, by value: a brick, a state, a change.

#include <array>
#include <cstdint>
#include <vector>

#include "handpiece/model/field/field_view.h"
#include "handpiece/model/tooth/tissue_volumes.h"

namespace handpiece::tooth {

inline constexpr std::size_t kBrickBytes = sizeof(float) * field::kBrickValues;

/// Which brick of which tooth. Teeth are numbered: 0 is the one worked on, so of a lone tooth this is the brick's dense
/// index x + bricks_x (y + bricks_y z) in its grid.
using BrickId = std::uint32_t;
inline constexpr int kDenseBits = 26;
inline constexpr std::uint32_t kMaxBricks = 1u << kDenseBits;  ///< of one tooth
inline constexpr std::uint16_t kMaxTeeth = 1u << (32 - kDenseBits);
[[nodiscard]] constexpr BrickId brickId(std::uint16_t tooth, std::uint32_t dense) noexcept {
    return (static_cast<std::uint32_t>(tooth) << kDenseBits) | dense;
}
[[nodiscard]] constexpr std::uint16_t toothOf(BrickId id) noexcept {
    return static_cast<std::uint16_t>(id >> kDenseBits);
}
[[nodiscard]] constexpr std::uint32_t denseOf(BrickId id) noexcept {
    return id & (kMaxBricks - 1);
}

/// One brick as it is now, by value: how listeners learn of a cut.
struct BrickSnapshot {
    BrickId id = 0;
    bool shows = true;           ///< the surface may have moved in it since it was handed over last
    TissueVolumes removedMm3{};  ///< of its tooth when it was handed over
    float values[field::kBrickValues];
};

/// What has been removed since all was uncut [mm3].
struct RemovedMm3 {
    TissueVolumes own{};                  ///< of the tooth worked on
    std::vector<TissueVolumes> others{};  ///< of the teeth 1, 2, ...; those beyond its end lost nothing

    [[nodiscard]] const TissueVolumes& of(std::uint16_t tooth) const noexcept;
    void set(std::uint16_t tooth, const TissueVolumes& mm3);
    /// In the order of their numbers, so that it is the same sum wherever it is made.
    [[nodiscard]] double sumOfOthers() const noexcept;
    bool operator==(const RemovedMm3& other) const noexcept;
};
/// Of all tissues.
[[nodiscard]] double sumOf(const TissueVolumes& mm3) noexcept;

/// Bricks that differ from the uncut teeth (a state), or that differ between two states (a change).
struct StateDelta {
    struct Brick {
        BrickId id;
        bool uncut;  ///< as before any cut; then `values` counts for nothing
        std::array<float, field::kBrickValues> values;
    };
    std::vector<Brick> bricks;  ///< at rising `id`
    RemovedMm3 removedMm3{};

    /// The state of one more tooth, of a higher number than those that are in it.
    void append(StateDelta&& ofTooth);
};
/// The same number for the same teeth, bit for bit; uncut bricks count for nothing.
[[nodiscard]] std::uint64_t stateHash(const StateDelta& state);
/// What turns teeth in state `from` into those in state `to`: bricks that differ, uncut where `to` leaves them so.
[[nodiscard]] StateDelta changeBetween(const StateDelta& from, const StateDelta& to);

}  // namespace handpiece::tooth
