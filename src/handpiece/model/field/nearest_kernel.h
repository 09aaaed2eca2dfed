// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Which triangle is nearest to each of sixteen neighbouring points: plain data in, plain data out, once per
/// instruction set.

#include <cstdint>

#include "handpiece/base/geometry/tree_layout.h"

namespace handpiece::field {

inline constexpr int kPacket = 16;

/// A triangle laid into its own plane: its longest edge along x from the origin, the third corner at (cx, cy), cy >= 0.
/// Distances in this frame lose nothing to slivers; segments and points are triangles with cy = 0.
struct FlatTriangle {
    double origin[3];              ///< [mm]
    float x[3], y[3], n[3];        ///< axes of the frame
    float length, cx, cy;          ///< corners (0, 0), (length, 0), (cx, cy) [mm]
    float inverseBc2, inverseCa2;  ///< 1 / squared lengths of the other two edges; 0 where there is none
};

[[nodiscard]] FlatTriangle flattened(const geometry::TreeTriangle& triangle);

/// Sixteen points around a centre.
struct PointPacket {
    double centre[3];          ///< [mm]
    float offset[3][kPacket];  ///< from the centre [mm]
    float halfSize[3];         ///< of the box around the offsets
};

/// Writes for each point the index of its nearest triangle, right to float rounding: what is written is no farther than
/// the nearest by more than some 1e-6 mm. Starts from `seed`, any triangle. The same bits at every level.
using NearestKernel = void (*)(const geometry::TreeNode* nodes, const FlatTriangle* triangles,
                               const PointPacket& packet, std::uint32_t seed, std::uint32_t* nearest);

namespace simd_base {
void nearestOfPacket(const geometry::TreeNode*, const FlatTriangle*, const PointPacket&, std::uint32_t, std::uint32_t*);
}
namespace simd_avx2 {
void nearestOfPacket(const geometry::TreeNode*, const FlatTriangle*, const PointPacket&, std::uint32_t, std::uint32_t*);
}
namespace simd_avx512 {
void nearestOfPacket(const geometry::TreeNode*, const FlatTriangle*, const PointPacket&, std::uint32_t, std::uint32_t*);
}

}  // namespace handpiece::field
