// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Which faces of a mesh meet at which edge. The ground on which inspect() and repair() stand.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::geometry {

/// Half-edge h = 3 * face + k runs from corner k of the face to its next corner.
using HalfEdge = std::uint32_t;

[[nodiscard]] inline HalfEdge nextHalfEdge(HalfEdge h) {
    return h % 3 == 2 ? h - 2 : h + 1;
}
[[nodiscard]] inline HalfEdge previousHalfEdge(HalfEdge h) {
    return h % 3 == 0 ? h + 2 : h - 1;
}
[[nodiscard]] inline std::uint32_t fromVertex(const TriangleMesh& mesh, HalfEdge h) {
    return mesh.triangles[h / 3][h % 3];
}
[[nodiscard]] inline std::uint32_t toVertex(const TriangleMesh& mesh, HalfEdge h) {
    return fromVertex(mesh, nextHalfEdge(h));
}

/// True when a face names one vertex twice.
[[nodiscard]] inline bool repeatsCorner(const Triangle& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// All edges of a mesh, sorted by their lower and higher vertex; faces that repeat a corner have none.
class MeshEdges {
  public:
    struct Edge {
        std::uint32_t low, high;
        std::uint32_t first, count;  ///< its half-edges in halfEdges()
    };

    /// Indices must be valid.
    explicit MeshEdges(const TriangleMesh& mesh);

    [[nodiscard]] std::span<const Edge> edges() const { return edges_; }
    /// The half-edges of an edge, in ascending order.
    [[nodiscard]] std::span<const HalfEdge> halfEdges(const Edge& e) const {
        return {halfEdges_.data() + e.first, e.count};
    }

  private:
    std::vector<Edge> edges_;
    std::vector<HalfEdge> halfEdges_;
};

/// Disjoint sets over 0..n-1; the root of a set is its smallest member, so results never depend on the order of
/// joining.
class DisjointSets {
  public:
    explicit DisjointSets(std::size_t n);
    [[nodiscard]] std::uint32_t find(std::uint32_t i);
    void join(std::uint32_t a, std::uint32_t b);

  private:
    std::vector<std::uint32_t> parent_;
};

/// Faces joined through edges, numbered by their first face.
struct Shells {
    std::vector<std::uint32_t> ofFace;
    std::size_t count = 0;
};
[[nodiscard]] Shells shellsOf(const TriangleMesh& mesh, const MeshEdges& edges);

/// For each shell, how many of the closed shells (`closed[shell] != 0`) it lies within: 0 outermost.
[[nodiscard]] std::vector<std::uint32_t> nestingOf(const TriangleMesh& mesh, const Shells& shells,
                                                   std::span<const std::uint8_t> closed);

/// Signed volume [mm3] of each shell.
[[nodiscard]] std::vector<double> shellVolumesMm3(const TriangleMesh& mesh, const Shells& shells);

/// Which faces to turn so that neighbours across edges of exactly two faces agree; in each connected set the smaller
/// number.
struct Orientation {
    std::vector<std::uint8_t> turn;  ///< by face
    std::size_t turned = 0;
    bool orientable = true;
};
[[nodiscard]] Orientation agreeingOrientation(const TriangleMesh& mesh, const MeshEdges& edges);

}  // namespace handpiece::geometry
