// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The distance between two convex hulls: GJK on their Minkowski difference.

#include <array>
#include <cstdint>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/convex_hull.h"

namespace handpiece::geometry {

/// Distances below this are a touch; distance and penetration are found to within it [mm].
inline constexpr double kTouchMm = 1e-10;

/// A vertex of the Minkowski difference A - B and the two vertices it comes from, all in the frame of A.
struct DifferenceVertex {
    core::Vec3 point;    ///< onA - onB [mm]
    core::Vec3 onA;      ///< [mm]
    std::uint32_t a, b;  ///< vertices of the hulls
};

/// Two hulls and where the second lies in the frame of the first. Cheap to make, once a query. Keeps references to
/// both.
class HullPair {
  public:
    HullPair(const ConvexHull& a, const ConvexHull& b, const core::Pose& bInA) noexcept
        : a_(a), b_(b), rotation_(bInA.orientation.toRotationMatrix()), positionMm_(bInA.positionMm) {}

    /// The vertex of A - B farthest along `direction`; climbing starts at the two vertices given.
    [[nodiscard]] DifferenceVertex support(const core::Vec3& direction, std::uint32_t startA = kNoVertex,
                                           std::uint32_t startB = kNoVertex) const noexcept HANDPIECE_REALTIME {
        return vertex(a_.support(direction, startA), b_.support(-(rotation_.transpose() * direction), startB));
    }
    [[nodiscard]] DifferenceVertex vertex(std::uint32_t a, std::uint32_t b) const noexcept HANDPIECE_REALTIME {
        const core::Vec3& onA = a_.vertex(a);
        return {onA - (rotation_ * b_.vertex(b) + positionMm_), onA, a, b};
    }
    [[nodiscard]] const ConvexHull& a() const noexcept { return a_; }
    [[nodiscard]] const ConvexHull& b() const noexcept { return b_; }
    /// From a point inside B to one inside A [mm].
    [[nodiscard]] core::Vec3 centreDifferenceMm() const noexcept {
        return a_.centreMm() - (rotation_ * b_.centreMm() + positionMm_);
    }

  private:
    const ConvexHull& a_;
    const ConvexHull& b_;
    core::Mat3 rotation_;
    core::Vec3 positionMm_;
};

/// One to four vertices of A - B.
struct Simplex {
    std::array<DifferenceVertex, 4> vertices;
    int count = 0;
};

/// Vertex pairs of the last simplex, valid at any pose: what the next query starts from. Empty at first.
struct SimplexSeed {
    std::array<std::array<std::uint32_t, 2>, 4> pairs{};
    int count = 0;
};

struct Separation {
    bool overlapping = false;                   ///< touching, or penetrating: then ask penetration() with `simplex`
    bool converged = true;                      ///< false: the iteration cap was met; distanceMm is an upper bound
    double distanceMm = 0.0;                    ///< >= 0
    core::Vec3 direction = core::Vec3::Zero();  ///< unit, from A towards B; zero when overlapping
    core::Vec3 pointOnA = core::Vec3::Zero();   ///< nearest point of A [mm], frame of A
    core::Vec3 pointOnB = core::Vec3::Zero();   ///< nearest point of B [mm], frame of A
    Simplex simplex;                            ///< carries the nearest point of A - B, or holds the origin
};

/// Distance and nearest points, by GJK (Gilbert, Johnson & Keerthi 1988): each simplex reduced to the feature nearest
/// to the origin by signed volumes (after Montanari, Petrinic & Barbieri 2017), the distance bracketed to within
/// kTouchMm from above by the simplex and from below by the support plane.
///
/// Starts from `seed` and leaves the last simplex in it; the distance does not depend on it beyond kTouchMm.
[[nodiscard]] Separation separation(const HullPair& pair, SimplexSeed& seed) noexcept HANDPIECE_REALTIME;

}  // namespace handpiece::geometry
