// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Depth against the triangles of the uncut surface: max over the bur's medial balls (c, R) of R - phiT(c). Private to
/// this room.

#include <array>
#include <vector>

#include "handpiece/base/core/simd.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/field/distance_field.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/tick/contact/bur_frame.h"
#include "handpiece/tick/contact/exact/exact_kernels.h"

namespace handpiece::contact {

/// A medial ball against the surface, tooth frame.
struct BallDepth {
    double depthMm = -std::numeric_limits<double>::infinity();  ///< radius - phiT(centre)
    core::Vec3 centreMm = core::Vec3::Zero();
    core::Vec3 surfaceMm = core::Vec3::Zero();  ///< nearest point of the tooth
    std::uint32_t triangle = geometry::kNoTriangle;
    std::uint8_t feature = 0;
    bool inside = false;  ///< the centre lies in the tooth
};

/// The triangles, the kernels for this machine and the sign of a point. What every part of the exact query shares.
class ExactSurface {
  public:
    ExactSurface(const geometry::TriangleTree& tree, const field::DistanceField& field, core::SimdLevel level);

    /// Depth of one ball; unchanged `triangle` (none) when nothing lies within `boundMm` of the centre.
    [[nodiscard]] BallDepth ball(const core::Vec3& centreMm, double radiusMm,
                                 std::uint32_t seed = geometry::kNoTriangle,
                                 double boundMm = std::numeric_limits<double>::infinity()) const noexcept;
    [[nodiscard]] bool isInside(const core::Vec3& p, const SurfaceHit& hit) const noexcept;
    /// Unit normal of the surface out of the tooth where the ball touches it.
    [[nodiscard]] core::Vec3 outward(const BallDepth& ball) const noexcept;
    [[nodiscard]] core::Vec3 closestOn(std::uint32_t triangle, const core::Vec3& p) const noexcept;
    /// Signed, and at most the distance to the surface in magnitude, away from it.
    [[nodiscard]] double farBound(const core::Vec3& p) const noexcept { return field_.distance(p); }
    /// Nearer than this to the surface farBound() does not vouch for the side.
    [[nodiscard]] double sureMm() const noexcept { return field_.settings().voxelMm; }
    [[nodiscard]] const TreeView& view() const noexcept { return view_; }
    [[nodiscard]] const ExactKernels& kernels() const noexcept { return kernels_; }
    [[nodiscard]] const geometry::TriangleTree& tree() const noexcept { return tree_; }

  private:
    const geometry::TriangleTree& tree_;
    const field::DistanceField& field_;
    TreeView view_;
    ExactKernels kernels_;
};

/// The part of the medial region on the bur's own axis.
class AxisSearch {
  public:
    explicit AxisSearch(const instrument::Bur& bur);

    /// Raises `best` to the deepest ball of the axis, within kDepthToleranceMm, if that is deeper; `mostMm` to what one
    /// that was not seen could have, where the work ended first. Seeds only save time.
    void search(const ExactSurface& surface, const BurFrame& frame, BallDepth& best, double& mostMm) noexcept;
    /// False when all of its balls have their centres outside the tooth.
    [[nodiscard]] bool mayEnter(const ExactSurface& surface, const BurFrame& frame) const noexcept;
    [[nodiscard]] double leastRadiusMm() const noexcept { return leastRadiusMm_; }
    void reset() noexcept { seeds_.fill(geometry::kNoTriangle); }

    static constexpr int kMaxCuts = 48, kMaxLooks = 64, kFineCuts = 12;
    static constexpr double kFineToleranceMm = 1e-7;

  private:
    /// Balls at rising z whose radius is concave along them, and lines above it.
    struct Run {
        std::vector<double> z, radius, slope;
        AxisRun plain;
        bool constant = false;
    };
    void addRun(const std::vector<instrument::MedialBall>& balls);
    [[nodiscard]] static bool mayEnter(const ExactSurface& surface, const BurFrame& frame, const Run& run) noexcept;
    void searchInside(const ExactSurface& surface, const Run& run, const BurFrame& frame, const SurfaceHit& first,
                      BallDepth& best, double& mostMm) const noexcept;

    std::vector<Run> runs_;
    static constexpr std::size_t kMaxSeeds = 8;
    std::array<std::uint32_t, kMaxSeeds> seeds_;
    double leastRadiusMm_ = std::numeric_limits<double>::infinity();
};

}  // namespace handpiece::contact
