// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Convex hulls (Quickhull), and the question every algorithm on them asks: which point lies farthest this way?

#include <cstdint>
#include <span>
#include <vector>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::geometry {

inline constexpr std::uint32_t kNoVertex = 0xffffffffu;

/// The convex hull of a set of points, with what support() needs. Immutable; queries may run on any number of threads.
class ConvexHull {
  public:
    /// Quickhull (Barber, Dobkin & Huhdanpaa 1996) by Qhull; facets merged for rounding, then triangulated.
    /// Throws core::Error for fewer than four points, points that are not finite, and points in one plane.
    explicit ConvexHull(std::span<const core::Vec3> points);
    explicit ConvexHull(const TriangleMesh& mesh) : ConvexHull(std::span<const core::Vec3>(mesh.vertices)) {}

    /// The vertex farthest along `direction` (any length, not zero): no vertex lies farther than it by more than
    /// rounding.
    ///
    /// Climbs from neighbour to neighbour, from `startVertex` when given and better than the start stored for this
    /// direction. A few dozen nanoseconds, whatever the number of vertices. Where several tie it may be any of them.
    [[nodiscard]] std::uint32_t support(const core::Vec3& direction,
                                        std::uint32_t startVertex = kNoVertex) const noexcept HANDPIECE_REALTIME;

    [[nodiscard]] std::size_t vertexCount() const noexcept { return mesh_.vertices.size(); }
    [[nodiscard]] const core::Vec3& vertex(std::uint32_t i) const noexcept { return mesh_.vertices[i]; }
    /// Vertices and triangulated facets, counter-clockwise from outside; some triangles of merged facets may have no
    /// area.
    [[nodiscard]] const TriangleMesh& mesh() const noexcept { return mesh_; }
    /// A point inside: the mean of the vertices.
    [[nodiscard]] const core::Vec3& centreMm() const noexcept { return centreMm_; }
    /// Indices of the vertices joined to vertex `i` by an edge, ascending.
    [[nodiscard]] std::vector<std::uint32_t> neighbours(std::uint32_t i) const;
    /// x, y and z of the vertices, each in a row of its own, for linear scans.
    [[nodiscard]] std::span<const double> coordinate(int axis) const noexcept { return coordinates_[axis]; }

  private:
    // A neighbour's coordinates beside its index: climbing reads one run of memory a vertex.
    struct Neighbour {
        double x, y, z;
        std::uint32_t vertex;
    };
    struct Summit {
        std::uint32_t vertex;
        double value;      ///< along the direction asked about
        double nextValue;  ///< of its best neighbour
    };
    [[nodiscard]] std::uint32_t binOf(const core::Vec3& direction) const noexcept;
    [[nodiscard]] Summit climb(const core::Vec3& direction, std::uint32_t from, double value) const noexcept;
    void buildAdjacency();
    void buildStarts();

    TriangleMesh mesh_;
    core::Vec3 centreMm_ = core::Vec3::Zero();
    double tieMm_ = 0.0;  ///< neighbours this little lower than a summit are looked at too
    std::array<std::vector<double>, 3> coordinates_;
    std::vector<std::uint32_t> firstNeighbour_;  ///< vertexCount() + 1 offsets into neighbours_
    std::vector<Neighbour> neighbours_;
    int binsPerEdge_ = 0;                ///< directions are binned on a cube of 6 x bins x bins, about one a vertex
    std::vector<std::uint32_t> starts_;  ///< the farthest vertex in the middle of each bin
};

}  // namespace handpiece::geometry
