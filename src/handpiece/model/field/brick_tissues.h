// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The tissue of every node of a grid of bricks: the one place where it is kept.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "handpiece/model/case/tissue.h"
#include "handpiece/model/field/field_view.h"

namespace handpiece::field {

/// Bricks of one tissue share its block of nodes, each mixed one has a block of its own.
struct BrickTissues {
    static constexpr std::size_t kShared = cases::kTissueCount * kBrickValues;

    /// No tissue anywhere.
    explicit BrickTissues(std::size_t denseBricks) : start(denseBricks, 0), nodes(kShared) {
        for (std::size_t i = 0; i < kShared; ++i)
            nodes[i] = static_cast<std::uint8_t>(i / kBrickValues);
    }
    [[nodiscard]] bool isMixed(std::size_t dense) const noexcept { return start[dense] >= kShared; }
    /// kBrickValues of a brick, index x + 9 y + 81 z.
    [[nodiscard]] const std::uint8_t* of(std::size_t dense) const noexcept { return &nodes[start[dense]]; }
    [[nodiscard]] std::size_t mixedBricks() const noexcept { return (nodes.size() - kShared) / kBrickValues; }
    [[nodiscard]] std::size_t memoryBytes() const noexcept { return start.size() * sizeof start[0] + nodes.size(); }
    /// Tissues that occur anywhere, rising.
    [[nodiscard]] std::vector<cases::Tissue> tissues() const;

    void setUniform(std::size_t dense, std::uint8_t tissue) { start[dense] = std::uint32_t{tissue} * kBrickValues; }
    void addMixed(std::size_t dense, const std::uint8_t* values) {
        start[dense] = static_cast<std::uint32_t>(nodes.size());
        nodes.insert(nodes.end(), values, values + kBrickValues);
    }

    std::vector<std::uint32_t> start;  ///< by dense brick: of its block in `nodes`
    std::vector<std::uint8_t> nodes;   ///< the shared blocks, then those of mixed bricks
};

}  // namespace handpiece::field
