// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The arrays of a TriangleTree as plain data, for kernels that may include nothing else.

#include <cstdint>

namespace handpiece::geometry {

inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;
inline constexpr int kMaxTreeDepth = 32;  ///< a depth-first stack of 7 * kMaxTreeDepth + 8 entries never overflows
inline constexpr std::uint32_t kMaxLeafTriangles = 4;

/// Eight child boxes side by side, each axis an array of eight floats, so that one instruction looks at all of them.
/// Boxes contain their triangles with a margin that covers the rounding to float, of the query point as well: the
/// distance from float(p) to a box, in float arithmetic, times (1 - 1e-6) is a lower bound of the distance from p to
/// what it holds. Empty lanes have min > max (+inf, -inf). Children come after their parents; at most kMaxTreeDepth
/// nodes lie on a path.
struct alignas(64) TreeNode {
    float minX[8], minY[8], minZ[8], maxX[8], maxY[8], maxZ[8];
    /// >= 0: index of a child node. < 0: a leaf, ~child is the first triangle (in tree order) and count[] its length.
    std::int32_t child[8];
    std::uint8_t count[8];
    std::uint8_t lanes;         ///< lanes in use, from 0
    std::uint8_t reserved[23];  ///< zero, so that equal trees are equal bytes
};

/// One triangle in tree order, ready for distance queries.
struct TreeTriangle {
    double a[3], ab[3], ac[3];  ///< corner a [mm] and the edges to b and c
    std::uint32_t index;        ///< place in the mesh that was given
    std::uint32_t thin;         ///< 1 for slivers, segments and points, whose inside is ill-defined in double; else 0
};

}  // namespace handpiece::geometry
