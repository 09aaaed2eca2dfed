// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Faces over an open loop that cross nothing. Only repair_*.cpp include it.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::geometry {

using Loop = std::vector<std::uint32_t>;  ///< vertices in the order in which new faces run along them
using EdgeList = std::vector<std::pair<std::uint32_t, std::uint32_t>>;  ///< lower and higher vertex, sorted

[[nodiscard]] bool holdsEdge(const EdgeList& edges, std::uint32_t a, std::uint32_t b);

/// What a face costs: area decides; among equals (a flat hole) short sides do, and faces without area are the last
/// resort.
[[nodiscard]] double patchCost(const core::Vec3& a, const core::Vec3& b, const core::Vec3& c);

/// Adds the faces of least area over a loop, among the triangulations whose chords and faces are free (Barequet &
/// Sharir 1995); false where there is none. `chordIsFree`: of two vertices, not asked of the side from the loop's last
/// to its first.
template <class ChordIsFree, class FaceIsFree>
bool leastAreaFaces(const TriangleMesh& mesh, const Loop& loop, const ChordIsFree& chordIsFree,
                    const FaceIsFree& faceIsFree, std::vector<Triangle>& faces) {
    const std::size_t n = loop.size();
    if (n < 3) return false;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const auto at = [&](std::size_t i) -> const core::Vec3& { return mesh.vertices[loop[i]]; };
    std::vector<double> best(n * n, 0.0), total(n);
    std::vector<std::uint32_t> apex(n * n, 0);
    for (std::size_t length = 2; length < n; ++length)
        for (std::size_t i = 0; i + length < n; ++i) {
            const std::size_t k = i + length;
            best[i * n + k] = kInfinity;
            if (length != n - 1 && !chordIsFree(loop[i], loop[k])) continue;
            for (std::size_t j = i + 1; j < k; ++j)
                total[j] = best[i * n + j] + best[j * n + k] + patchCost(at(i), at(j), at(k));
            for (;;) {
                const auto least = std::min_element(total.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                                                    total.begin() + static_cast<std::ptrdiff_t>(k));
                const auto j = static_cast<std::size_t>(least - total.begin());
                if (!(*least < kInfinity)) break;
                if (faceIsFree(Triangle{loop[i], loop[j], loop[k]})) {
                    best[i * n + k] = *least;
                    apex[i * n + k] = static_cast<std::uint32_t>(j);
                    break;
                }
                *least = kInfinity;
            }
        }
    if (!(best[n - 1] < kInfinity)) return false;
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, n - 1}};
    while (!open.empty()) {
        const auto [i, k] = open.back();
        open.pop_back();
        if (k - i < 2) continue;
        const std::size_t j = apex[i * n + k];
        faces.push_back({loop[i], loop[j], loop[k]});
        open.emplace_back(i, j);
        open.emplace_back(j, k);
    }
    return true;
}

/// The faces of least area over one loop among those that cross neither the mesh nor each other.
class ClearPatch {
  public:
    /// `taken`: edges of the mesh between the loop's vertices, which a face may not have a second time.
    ClearPatch(const TriangleMesh& mesh, const EdgeList& taken, Loop loop);

    /// The loop runs along a cut, there and back: that edge may be no other one's.
    ClearPatch& across(std::uint32_t from, std::uint32_t to);
    /// Nothing where there is none, or none was found.
    [[nodiscard]] std::optional<std::vector<Triangle>> find();

  private:
    using Key = std::array<std::uint32_t, 3>;
    struct Hash {
        std::size_t operator()(const Key& k) const;
    };
    enum Known : std::uint8_t { unknown, free, barred };

    bool cover();
    [[nodiscard]] bool repeatsEdge() const;
    bool forbidCrossing();
    bool isFree(const Triangle& t);
    bool isFree(std::uint32_t a, std::uint32_t b);
    bool halve(const Loop& loop, std::vector<Loop>& parts);
    bool leastArea(const Loop& loop);
    [[nodiscard]] const core::Vec3& at(const Loop& loop, std::size_t i) const { return mesh_.vertices[loop[i]]; }

    const TriangleMesh& mesh_;
    const EdgeList& taken_;
    CrossingTree tree_;
    Loop whole_;
    std::vector<Triangle> faces_;
    std::unordered_map<Key, Known, Hash> faceKnown_, edgeKnown_;
};

/// One patch from the first loop to the second, as the wall of a tube. It starts from a cut between them, of which the
/// shortest are tried.
[[nodiscard]] std::optional<std::vector<Triangle>> clearBridge(const TriangleMesh& mesh, const EdgeList& taken,
                                                               const Loop& one, const Loop& other);

/// The edges of the mesh between vertices of these loops.
[[nodiscard]] EdgeList edgesBetween(const TriangleMesh& mesh, const std::vector<Loop>& loops);

}  // namespace handpiece::geometry
