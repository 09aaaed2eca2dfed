// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Points all over the pulp's surface, and the nearest of them. Private to this room.

#include <limits>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/model/tooth/tooth_model.h"

namespace handpiece::measure {

/// Where the edges of the grid, and diagonals of its faces, pass through the surface of the pulp. Immutable; any
/// thread.
class PulpSurface {
  public:
    /// In parallel; the same points at any thread count.
    explicit PulpSurface(const tooth::ToothModel& base);

    [[nodiscard]] bool isEmpty() const { return points_.empty(); }
    /// Distance to the nearest point; infinite when none lies within `boundMm`.
    [[nodiscard]] double distanceMm(const core::Vec3& p,
                                    double boundMm = std::numeric_limits<double>::infinity()) const;

  private:
    /// Points of one brick of the grid, and the box round them.
    struct Cluster {
        core::Box box;
        std::size_t first, count;
    };
    std::vector<Cluster> clusters_;
    std::vector<core::Vec3> points_;
};

/// Node (x, y, z) of a brick, or a place beyond it [mm].
[[nodiscard]] core::Vec3 nodeMm(const field::FieldView& view, std::uint32_t dense, int x, int y, int z);

}  // namespace handpiece::measure
