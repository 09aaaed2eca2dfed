// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A field between its nodes to third order, with edges kept sharp: a few times the cost of DistanceField::distance.

#include <array>
#include <span>

#include "handpiece/base/core/simd.h"
#include "handpiece/model/field/distance_field.h"
#include "handpiece/model/field/sharp_kernel.h"

namespace handpiece::field {

/// For one thread; keeps the nodes about the cells that were asked last, until the field changes.
class SharpLookup {
  public:
    /// The field must outlive this.
    SharpLookup(const DistanceField& field, core::SimdLevel level);

    /// Signed distance [mm]; as DistanceField::distance where no brick is stored.
    [[nodiscard]] double distance(const core::Vec3& p) noexcept;
    /// The same at up to kSharpPlaces places at once, for little more than one costs.
    void distances(std::span<const core::Vec3> places, std::span<double> out) noexcept;
    /// The same at a place whose cell is not asked again: cheaper there, and within a nanometre where no edge is near.
    [[nodiscard]] double distanceOnce(const core::Vec3& p) const noexcept;
    /// Unit gradient (out of the tooth); zero where no brick is stored. On an edge that of one of its walls.
    [[nodiscard]] core::Vec3 normal(const core::Vec3& p) noexcept;

    struct Wall {
        double distanceMm;
        core::Vec3 slope;      ///< first derivatives
        core::Mat3 bendPerMm;  ///< second derivatives
    };
    /// The smooth wall at a place; false where an edge lies in or beside its cell, or no brick is stored.
    [[nodiscard]] bool wallAt(const core::Vec3& p, Wall& wall) noexcept;

  private:
    struct Cell {
        std::int32_t at[3] = {-1, -1, -1};
        SharpBlock block;
    };
    void locate(std::span<const core::Vec3> places) noexcept;
    [[nodiscard]] std::int64_t brickOf(const std::int32_t (&cell)[3]) const noexcept;
    /// Null where no brick is stored.
    [[nodiscard]] const SharpBlock* blockAt(const std::int32_t (&cell)[3]) noexcept;
    /// The place itself is the first of places_ then.
    [[nodiscard]] const SharpBlock* firstBlock(const core::Vec3& p) noexcept;

    const DistanceField& field_;
    FieldView view_;
    SharpKernels kernels_;
    float farOutMm_, farInMm_;
    std::uint64_t version_ = 0;
    std::array<Cell, 8> cells_;  ///< by whether x, y, z are odd: neighbours are kept beside one another
    SharpPlaces places_{};
};

}  // namespace handpiece::field
