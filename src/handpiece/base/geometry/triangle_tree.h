// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Exact distances to a triangle mesh: an 8-wide box tree, boxes in float with a margin, triangles in double.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/tree_layout.h"
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::geometry {

/// The nearest point of the surface.
struct NearestPoint {
    double distanceMm = 0.0;  ///< >= 0
    core::Vec3 pointMm = core::Vec3::Zero();
    std::uint32_t triangle = kNoTriangle;  ///< in tree order; kNoTriangle when nothing lies within the bound
    std::uint8_t feature = 0;              ///< 0 face, 1..3 edge ab, bc, ca, 4..6 vertex a, b, c
};

/// Where a ray meets the surface.
struct RayMeeting {
    double distanceMm = 0.0;               ///< along the ray
    std::uint32_t triangle = kNoTriangle;  ///< in tree order; kNoTriangle when it meets none
};

/// Built once off the tick; queries are const, noexcept, allocate nothing and may run on any number of threads.
class TriangleTree {
  public:
    /// Throws core::Error on an empty mesh or indices out of range. Degenerate triangles are kept (as segments or
    /// points).
    explicit TriangleTree(const TriangleMesh& mesh);

    /// Nearest point of one triangle, in tree order: exact, whatever lies around it.
    [[nodiscard]] NearestPoint nearestOn(std::uint32_t triangle, const core::Vec3& p) const noexcept;

    /// Nearest point of the surface within `boundMm`; starts from `seed` (a triangle in tree order) when given.
    [[nodiscard]] NearestPoint nearest(const core::Vec3& p, double boundMm = std::numeric_limits<double>::infinity(),
                                       std::uint32_t seed = kNoTriangle) const noexcept;

    /// Signed distance [mm], negative inside; the sign from the angle-weighted pseudonormal of the nearest feature
    /// (Baerentzen & Aanaes 2005), right for closed, consistently oriented meshes.
    [[nodiscard]] double signedDistance(const core::Vec3& p, NearestPoint* nearestPoint = nullptr,
                                        std::uint32_t seed = kNoTriangle) const noexcept;

    /// +1 outside, -1 inside, for a point whose nearest point is `n`.
    [[nodiscard]] double side(const core::Vec3& p, const NearestPoint& n) const noexcept;

    /// The first triangle that a ray meets from `origin` to `farMm` along `direction` (unit), from either side. Edges
    /// belong to both their triangles, so that a ray does not slip through between them.
    [[nodiscard]] RayMeeting firstMeeting(const core::Vec3& origin, const core::Vec3& direction,
                                          double farMm = std::numeric_limits<double>::infinity()) const noexcept;

    [[nodiscard]] std::span<const TreeNode> nodes() const noexcept { return nodes_; }  ///< node 0 is the root
    [[nodiscard]] std::span<const TreeTriangle> triangles() const noexcept { return triangles_; }
    [[nodiscard]] const core::Box& bounds() const noexcept { return bounds_; }

    /// 7 unit normals of 3 floats a triangle, in tree order: face, edges ab bc ca, vertices a b c.
    [[nodiscard]] const std::vector<float>& pseudonormals() const noexcept { return pseudonormals_; }
    /// Of a triangle in tree order, or of one of its features as NearestPoint has them; unit.
    [[nodiscard]] core::Vec3 pseudonormal(std::uint32_t triangle, std::uint8_t feature = 0) const noexcept {
        const float* n = &pseudonormals_[std::size_t{triangle} * 21 + std::size_t{feature} * 3];
        return {n[0], n[1], n[2]};
    }

  private:
    void fillTriangles(const TriangleMesh& mesh, std::span<const std::uint32_t> order);
    std::vector<TreeNode> nodes_;
    std::vector<TreeTriangle> triangles_;
    std::vector<float> pseudonormals_;
    core::Box bounds_;
};

}  // namespace handpiece::geometry
