// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Exact distances to a triangle mesh: an 8-wide box tree, boxes in float with a margin, triangles in double.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/triangle_mesh.h"

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
    std::uint8_t lanes;  ///< lanes in use, from 0
};

/// One triangle in tree order, ready for distance queries.
struct TreeTriangle {
    double a[3], ab[3], ac[3];  ///< corner a [mm] and the edges to b and c
    std::uint32_t index;        ///< place in the mesh that was given
    std::uint32_t thin;         ///< 1 for slivers, segments and points, whose inside is ill-defined in double; else 0
};

/// The nearest point of the surface.
struct NearestPoint {
    double distanceMm = 0.0;  ///< >= 0
    core::Vec3 pointMm = core::Vec3::Zero();
    std::uint32_t triangle = kNoTriangle;  ///< in tree order; kNoTriangle when nothing lies within the bound
    std::uint8_t feature = 0;              ///< 0 face, 1..3 edge ab, bc, ca, 4..6 vertex a, b, c
};

/// Built once off the tick; queries are const, noexcept, allocate nothing and may run on any number of threads.
class TriangleTree {
  public:
    /// Throws core::Error on an empty mesh or indices out of range. Degenerate triangles are kept (as segments or
    /// points).
    explicit TriangleTree(const TriangleMesh& mesh);

    /// Nearest point of the surface within `boundMm`; starts from `seed` (a triangle in tree order) when given.
    [[nodiscard]] NearestPoint nearest(const core::Vec3& p, double boundMm = std::numeric_limits<double>::infinity(),
                                       std::uint32_t seed = kNoTriangle) const noexcept;

    /// Signed distance [mm], negative inside; the sign from the angle-weighted pseudonormal of the nearest feature
    /// (Baerentzen & Aanaes 2005), right for closed, consistently oriented meshes.
    [[nodiscard]] double signedDistance(const core::Vec3& p, NearestPoint* nearestPoint = nullptr,
                                        std::uint32_t seed = kNoTriangle) const noexcept;

    /// +1 outside, -1 inside, for a point whose nearest point is `n`.
    [[nodiscard]] double side(const core::Vec3& p, const NearestPoint& n) const noexcept;

    /// Generalised winding number (Jacobson 2013; tree acceleration after Barill 2018): about 1 inside, 0 outside.
    [[nodiscard]] double windingNumber(const core::Vec3& p) const noexcept;

    [[nodiscard]] std::span<const TreeNode> nodes() const noexcept { return nodes_; }  ///< node 0 is the root
    [[nodiscard]] std::span<const TreeTriangle> triangles() const noexcept { return triangles_; }
    [[nodiscard]] const core::Box& bounds() const noexcept { return bounds_; }

    // Storage for the tooth's cache: everything the tree holds, as flat arrays.
    struct Storage {
        std::vector<TreeNode> nodes;
        std::vector<TreeTriangle> triangles;
        std::vector<float> pseudonormals;  ///< 7 normals of 3 floats a triangle: face, edges ab bc ca, vertices a b c
    };
    /// Throws core::Error when the arrays do not belong together.
    explicit TriangleTree(Storage storage, const core::Box& bounds);
    [[nodiscard]] const std::vector<float>& pseudonormals() const noexcept { return pseudonormals_; }

  private:
    void computeDipoles();
    std::vector<TreeNode> nodes_;
    std::vector<TreeTriangle> triangles_;
    std::vector<float> pseudonormals_;
    std::vector<double> dipoles_;  ///< per node lane: area-weighted normal (3), centre (3), radius (1), area(1)
    core::Box bounds_;
};

}  // namespace handpiece::geometry
