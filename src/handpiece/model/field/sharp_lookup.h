// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A field between its nodes to third order, with edges kept sharp: some ten times the cost of DistanceField::distance.

#include <array>

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
    /// Unit gradient (out of the tooth); zero where no brick is stored. On an edge that of one of its walls.
    [[nodiscard]] core::Vec3 normal(const core::Vec3& p) noexcept;

  private:
    struct Cell {
        SharpBlock block;
        std::int32_t first[3] = {-1, -1, -1};
        std::uint64_t version = 0;
    };
    /// The nodes about the cell at `p`; null where no brick is stored. `t`: the place in it.
    const SharpBlock* find(const core::Vec3& p, float (&t)[3]) noexcept;

    const DistanceField& field_;
    FieldView view_;
    SharpKernels kernels_;
    float farOutMm_, farInMm_;
    std::array<Cell, 8> cells_;  ///< by whether x, y, z are odd: neighbours are kept beside one another
};

}  // namespace handpiece::field
