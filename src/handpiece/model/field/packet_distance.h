// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Signed distances of neighbouring points to a closed surface, sixteen at a time.

#include <array>
#include <cstdint>
#include <vector>

#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/field/nearest_kernel.h"

namespace handpiece::field {

/// The signed distance [mm] of `p` to one triangle of a tree, with which distances() ends each search.
[[nodiscard]] float distanceTo(const geometry::TriangleTree& tree, std::uint32_t triangle, const core::Vec3& p);

/// Made once a surface; const, any thread. `tree` must outlive it.
class PacketDistance {
  public:
    explicit PacketDistance(const geometry::TriangleTree& tree);

    /// Signed distances [mm], exact on triangles no farther than the nearest by more than float rounding, of `count`
    /// (1 .. kPacket) points; the search starts from `seed`, any triangle. Returns a triangle to start the next from.
    /// `triangles`, where wanted: the one that each distance is of.
    std::uint32_t distances(const core::Vec3* points, int count, std::uint32_t seed, float* out,
                            std::uint32_t* triangles = nullptr) const;

  private:
    const geometry::TriangleTree& tree_;
    NearestKernel kernel_;
    std::vector<FlatTriangle> flat_;
};

}  // namespace handpiece::field
