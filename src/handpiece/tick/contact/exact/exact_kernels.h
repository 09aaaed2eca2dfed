// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The inner loops of the exact query, in plain data so that they can be compiled once per instruction set.

#include <cstdint>

namespace handpiece::contact {

/// geometry::TreeNode and TreeTriangle as the kernels see them; exact_depth.cpp asserts that the layouts agree.
struct alignas(64) KernelNode {
    float minX[8], minY[8], minZ[8], maxX[8], maxY[8], maxZ[8];
    std::int32_t child[8];
    std::uint8_t count[8];
    std::uint8_t lanes;
};
struct KernelTriangle {
    double a[3], ab[3], ac[3];
    std::uint32_t index, thin;
};
struct TreeView {
    const KernelNode* nodes = nullptr;
    const KernelTriangle* triangles = nullptr;
    std::uint32_t triangleCount = 0;
};

inline constexpr int kMaxRunLines = 4;

/// A run of the bur's axis with balls at rising z and a radius that is concave along it, so that the distance of a
/// triangle to a ball, less its radius, is convex along the run.
struct AxisRun {
    const double* z = nullptr;       ///< of the balls
    const double* radius = nullptr;  ///< of the balls
    const double* slope = nullptr;   ///< of the radius from ball i to i + 1
    std::int32_t count = 0;
    bool constant = false;  ///< one radius all along: squares are compared and roots saved
    float maxRadius = 0.0f;
    /// Lines above the radius: radius(z) <= lineRadius + lineSlope z. For bounds.
    std::int32_t lines = 0;
    float lineRadius[kMaxRunLines] = {}, lineSlope[kMaxRunLines] = {}, lineCosine[kMaxRunLines] = {};
};

/// Where a search ended. Goes in with `value` as the bound to beat and `triangle` as a seed (or kNone).
struct SurfaceHit {
    static constexpr std::uint32_t kNone = 0xffffffffu;
    double value = 0.0;           ///< distance less radius; the bound that went in when nothing beat it
    double z = 0.0;               ///< where on the axis (bur's z)
    double point[3] = {0, 0, 0};  ///< of the surface
    std::uint32_t triangle = kNone;
    std::uint8_t feature = 0;  ///< as in geometry::NearestPoint
};

struct ExactKernels {
    /// Least distance of the surface to a ball of the run, less its radius.
    void (*nearestToRun)(const TreeView& tree, const AxisRun& run, const double tip[3], const double axis[3],
                         SurfaceHit& hit) noexcept;
    void (*closestOnTriangle)(const KernelTriangle& triangle, const double point[3], double closest[3]) noexcept;
    /// Nearest point of the surface.
    void (*nearestToPoint)(const TreeView& tree, const double point[3], SurfaceHit& hit) noexcept;
};

namespace simd_base {
ExactKernels exactKernels() noexcept;
}
namespace simd_avx2 {
ExactKernels exactKernels() noexcept;
}
namespace simd_avx512 {
ExactKernels exactKernels() noexcept;
}

}  // namespace handpiece::contact
