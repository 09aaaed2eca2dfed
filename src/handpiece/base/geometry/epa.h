// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The minimal translation that parts two overlapping convex hulls: EPA on their Minkowski difference.

#include <array>
#include <cstdint>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/gjk.h"

namespace handpiece::geometry {

struct Penetration {
    double depthMm = 0.0;                      ///< >= 0: moving B by depthMm * normal makes the hulls touch
    core::Vec3 normal = core::Vec3::Zero();    ///< unit, the way out for B
    core::Vec3 pointOnA = core::Vec3::Zero();  ///< where they touch after that, on A [mm], frame of A
    bool converged = true;                     ///< false: the polytope was full; depthMm is the best lower bound found
    int iterations = 0;
};

/// EPA (van den Bergen 2001): a polytope inside A - B around the origin grows towards its boundary where it is nearest.
///
/// Holds its polytope in place (about 150 kB) and never allocates: make one off the tick and keep it. One thread at a
/// time.
class PenetrationSolver {
  public:
    static constexpr int kMaxFaces = 1536;
    static constexpr int kMaxVertices = 510;

    /// Depth and normal of an overlapping pair, from the simplex that separation() left. Right to within 10 kTouchMm.
    ///
    /// Starts from the face that decided last time too (see reset()); the depth does not depend on it beyond that
    /// tolerance. Where several ways out are equally short the normal is that of one of them.
    [[nodiscard]] Penetration penetration(const HullPair& pair, const Simplex& simplex) noexcept HANDPIECE_REALTIME;
    /// Forgets the last query.
    void reset() noexcept { seedCount_ = 0; }

  private:
    struct Face {
        core::Vec3 normal;  ///< unit, outwards
        std::array<std::int16_t, 3> vertex;
        std::array<std::int16_t, 3> across;     ///< face beyond the edge vertex[i], vertex[i + 1]
        std::array<std::int8_t, 3> acrossEdge;  ///< that edge's number there
        bool visible;                           ///< from the point being added
        bool settled;                           ///< known to lie on the boundary of A - B
    };
    struct Edge {
        std::int16_t face;
        std::int8_t edge;
    };

    bool buildTetrahedron(const HullPair& pair, const Simplex& simplex) noexcept;
    bool makeFace(int slot, int v0, int v1, int v2) noexcept;
    bool addVertex(int seenFrom, const DifferenceVertex& w) noexcept;
    int findHorizon(int seenFrom, const core::Vec3& w) noexcept;
    void addSeeds(const HullPair& pair) noexcept;
    [[nodiscard]] bool isKnown(const DifferenceVertex& w) const noexcept;
    [[nodiscard]] int nearestFace() const noexcept;
    [[nodiscard]] const DifferenceVertex& at(int i) const noexcept { return vertices_[static_cast<std::size_t>(i)]; }

    std::array<DifferenceVertex, kMaxVertices> vertices_;
    int vertexCount_ = 0;
    std::array<Face, kMaxFaces> faces_;
    std::array<double, kMaxFaces> distance_;  ///< of each face's plane from the origin; infinite where the slot is free
    int faceCount_ = 0;                       ///< slots ever used
    std::array<std::int16_t, kMaxFaces> free_;
    int freeCount_ = 0;
    std::array<Edge, kMaxFaces> horizon_;
    std::array<Edge, 3 * kMaxFaces> stack_;
    std::array<std::int16_t, kMaxFaces> removed_, newSlots_;
    int removedCount_ = 0;
    std::array<std::array<std::uint32_t, 2>, 3> seeds_{};
    int seedCount_ = 0;
};

}  // namespace handpiece::geometry
