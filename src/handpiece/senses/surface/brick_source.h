// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Where the surface takes its signed distances from: a field, or the mirror of one that is being cut.

#include <cstdint>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/model/field/distance_field.h"
#include "handpiece/model/tooth/tooth_mirror.h"

namespace handpiece::surface {

/// The grid that bricks lie in.
struct BrickGrid {
    core::Vec3 originMm = core::Vec3::Zero();  ///< node 0 of brick 0
    double voxelMm = 0.0;
    std::int32_t bricks[3] = {0, 0, 0};

    [[nodiscard]] std::size_t count() const {
        return static_cast<std::size_t>(bricks[0]) * static_cast<std::size_t>(bricks[1]) *
               static_cast<std::size_t>(bricks[2]);
    }
    [[nodiscard]] std::array<std::int32_t, 3> at(std::uint32_t dense) const {
        const auto x = static_cast<std::uint32_t>(bricks[0]), y = static_cast<std::uint32_t>(bricks[1]);
        return {static_cast<std::int32_t>(dense % x), static_cast<std::int32_t>(dense / x % y),
                static_cast<std::int32_t>(dense / (x * y))};
    }
    /// The brick one or more steps away; -1 outside the grid.
    [[nodiscard]] std::int64_t neighbour(std::uint32_t dense, int dx, int dy, int dz) const {
        const std::array<std::int32_t, 3> b = at(dense);
        const std::int32_t x = b[0] + dx, y = b[1] + dy, z = b[2] + dz;
        if (x < 0 || y < 0 || z < 0 || x >= bricks[0] || y >= bricks[1] || z >= bricks[2]) return -1;
        return x + std::int64_t{bricks[0]} * (y + std::int64_t{bricks[1]} * z);
    }
};
[[nodiscard]] BrickGrid gridOf(const field::FieldView& field);

/// Values of bricks, whoever holds them. Reading is const and may happen on several threads at once.
class BrickSource {
  public:
    virtual ~BrickSource() = default;
    [[nodiscard]] virtual const BrickGrid& grid() const = 0;
    /// False when the surface certainly does not pass through the brick.
    [[nodiscard]] virtual bool mayHoldSurface(std::uint32_t dense) const = 0;
    /// field::kBrickValues signed distances [mm], negative inside; nodes on a brick's faces are the same bits in every
    /// brick that has them. `scratch` (as many) may be used to hold them.
    [[nodiscard]] virtual const float* values(std::uint32_t dense, float* scratch) const = 0;
};

/// A field that does not change while it is read.
class FieldSource final : public BrickSource {
  public:
    explicit FieldSource(const field::DistanceField& field) : view_(field.view()), grid_(gridOf(view_)) {}
    [[nodiscard]] const BrickGrid& grid() const override { return grid_; }
    [[nodiscard]] bool mayHoldSurface(std::uint32_t dense) const override { return view_.brickIndex[dense] >= 0; }
    [[nodiscard]] const float* values(std::uint32_t dense, float* scratch) const override;

  private:
    field::FieldView view_;
    BrickGrid grid_;
};

/// A tooth that is being cut, as its mirror has it.
class MirrorSource final : public BrickSource {
  public:
    explicit MirrorSource(const tooth::ToothMirror& mirror)
        : mirror_(mirror), view_(mirror.model().field.view()), grid_(gridOf(view_)) {}
    [[nodiscard]] const BrickGrid& grid() const override { return grid_; }
    [[nodiscard]] bool mayHoldSurface(std::uint32_t dense) const override {
        return view_.brickIndex[dense] >= 0 || mirror_.isChanged(dense);
    }
    [[nodiscard]] const float* values(std::uint32_t dense, float* scratch) const override {
        return mirror_.values(dense, scratch);
    }

  private:
    const tooth::ToothMirror& mirror_;
    field::FieldView view_;
    BrickGrid grid_;
};

}  // namespace handpiece::surface
