// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The part of a tooth that is of one tissue, as signed distances. Private to this room.

#include <array>
#include <vector>

#include "handpiece/model/field/tissue_map.h"
#include "handpiece/senses/surface/brick_source.h"

namespace handpiece::surface {

/// max(distance to the tooth, distance to the tissue). Keeps references to both.
class PartSource final : public BrickSource {
  public:
    PartSource(const BrickSource& tooth, const field::TissueMap& tissues, cases::Tissue tissue);
    [[nodiscard]] const BrickGrid& grid() const override { return tooth_.grid(); }
    [[nodiscard]] bool mayHoldSurface(std::uint32_t dense) const override;
    [[nodiscard]] const float* values(std::uint32_t dense, float* scratch) const override;

  private:
    enum class Kind : std::uint8_t { other, all, mixed };
    [[nodiscard]] Kind kindOf(std::uint32_t dense) const;
    struct Place {
        std::uint32_t dense;
        std::array<int, 3> node;
    };
    [[nodiscard]] Place owner(std::uint32_t dense, const std::array<int, 3>& node) const;
    [[nodiscard]] float tissueDistance(const Place& place) const;

    const BrickSource& tooth_;
    const field::TissueMap& tissues_;
    cases::Tissue tissue_;
    float farMm_;                     ///< what is told where no boundary is near
    std::vector<Kind> kinds_;         ///< by dense brick
    std::vector<std::uint8_t> same_;  ///< by dense brick: all neighbours are of its kind, and it is not mixed
};

}  // namespace handpiece::surface
