// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Faces of a mesh that pass through each other.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::geometry {

/// Two faces that cross, and a point where they do.
struct CrossingFaces {
    std::uint32_t first = 0, second = 0;  ///< first < second
    core::Vec3 pointMm = core::Vec3::Zero();
};

/// Crossings shallower than this share of the box's diagonal are touching, not crossing (25 nm on a tooth of 25 mm): it
/// covers the rounding of coordinates to the float32 of an STL file.
inline constexpr double kTouchingShare = 1e-6;

/// The pairs of faces that cross or are folded onto each other, by face number; the first `limit` of them.
///
/// Faces that only touch (share a corner or an edge, by number or place, or lie against each other) do not count.
/// Deterministic at any thread count. Throws core::Error when a triangle names a vertex that is not there.
[[nodiscard]] std::vector<CrossingFaces> selfIntersections(const TriangleMesh& mesh,
                                                           std::size_t limit = std::numeric_limits<std::size_t>::max());

/// A mesh that is asked many times whether something new would cross it, by the rules of selfIntersections(). New faces
/// stand on the mesh's own vertices.
class CrossingTree {
  public:
    /// Throws core::Error when a triangle names a vertex that is not there.
    explicit CrossingTree(const TriangleMesh& mesh);
    CrossingTree(CrossingTree&&) noexcept;
    CrossingTree& operator=(CrossingTree&&) noexcept;
    ~CrossingTree();

    /// True when this face would cross one of the mesh, or lie folded onto it.
    [[nodiscard]] bool isCrossed(const Triangle& face) const;
    /// True when the straight line between two vertices goes through a face that has neither of them.
    [[nodiscard]] bool isPierced(std::uint32_t from, std::uint32_t to) const;

  private:
    std::unique_ptr<const class CrossingFinder> finder_;
};

}  // namespace handpiece::geometry
