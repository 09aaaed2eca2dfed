// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Which tissue lies where, from the closed surfaces of the parts.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "handpiece/model/field/field_builder.h"

namespace handpiece::field {

/// The part of highest priority that contains a point, else the part whose surface is nearest. Const, any thread.
class PartTissues {
  public:
    /// `parts` must outlive this. Of equal priorities the later part wins.
    explicit PartTissues(std::span<const PartSurface> parts);

    /// Without a tree in sight of it: all is one tissue.
    [[nodiscard]] bool isUniform() const { return parts_.size() <= 1; }

    /// Tissue at a point; enamel when there are no parts.
    [[nodiscard]] cases::Tissue at(const core::Vec3& p) const;

    /// Fills the tissues of a brick's nodes, index x + 9 y + 81 z, whose places are given by `nodeMm(x, y, z)`. Blocks
    /// that lie wholly in one tissue are settled by one look at their middle.
    void fill(const std::function<core::Vec3(int, int, int)>& nodeMm, std::uint8_t* tissue) const;

  private:
    struct Block;
    void fillBlock(const Block& block, std::span<const std::size_t> candidates, std::uint8_t* tissue) const;
    /// Index of the part that every point within `radiusMm` of `p` belongs to, or -1 when they may differ. Candidates
    /// that can play no part there are left out of `remaining`.
    [[nodiscard]] int decide(const core::Vec3& p, double radiusMm, std::span<const std::size_t> candidates,
                             std::vector<std::size_t>* remaining) const;

    std::vector<PartSurface> parts_;  ///< highest priority first
};

}  // namespace handpiece::field
