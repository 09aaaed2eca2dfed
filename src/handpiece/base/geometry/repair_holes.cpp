// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/repair_holes.h"

#include <algorithm>
#include <limits>

#include "handpiece/base/geometry/mesh_edges.h"

namespace handpiece::geometry {
namespace {

using core::Vec3;
using Loop = std::vector<std::uint32_t>;  // vertices in the order in which the new faces run along them

constexpr std::size_t kLargestExact = 128;  // the exact triangulation costs its cube

class HoleCloser {
  public:
    explicit HoleCloser(TriangleMesh& mesh) : mesh_(mesh) {}

    std::vector<ClosedHole> closeAll() {
        std::vector<ClosedHole> holes;
        for (const Loop& loop : findLoops())
            holes.push_back(close(loop));
        std::stable_sort(holes.begin(), holes.end(),
                         [](const ClosedHole& a, const ClosedHole& b) { return a.perimeterMm > b.perimeterMm; });
        return holes;
    }

  private:
    static constexpr std::uint32_t kNone = 0xffffffffu;

    std::vector<Loop> findLoops() {
        const MeshEdges edges(mesh_);
        std::vector<std::uint32_t> next(mesh_.vertices.size(), kNone);
        for (const MeshEdges::Edge& e : edges.edges()) {
            if (e.count != 1) continue;
            const HalfEdge h = edges.halfEdges(e)[0];
            next[toVertex(mesh_, h)] = fromVertex(mesh_, h);  // the hole runs the other way
        }
        for (const MeshEdges::Edge& e : edges.edges())
            if (next[e.low] != kNone && next[e.high] != kNone) taken_.emplace_back(e.low, e.high);
        std::vector<Loop> loops;
        for (std::uint32_t v = 0; v < next.size(); ++v) {
            if (next[v] == kNone) continue;
            Loop loop;
            for (std::uint32_t at = v; next[at] != kNone;) {
                loop.push_back(at);
                const std::uint32_t to = next[at];
                next[at] = kNone;
                at = to;
            }
            loops.push_back(std::move(loop));
        }
        return loops;
    }

    ClosedHole close(const Loop& loop) {
        ClosedHole hole;
        hole.edges = loop.size();
        for (std::size_t i = 0; i < loop.size(); ++i) {
            hole.perimeterMm += (at(loop, i) - at(loop, (i + 1) % loop.size())).norm();
            hole.centreMm += at(loop, i) / static_cast<double>(loop.size());
        }
        const std::size_t first = mesh_.triangles.size();
        if (!triangulate(loop)) {
            // Every diagonal that is needed exists already elsewhere: a new vertex in the middle always works.
            mesh_.triangles.resize(first);
            const auto middle = static_cast<std::uint32_t>(mesh_.vertices.size());
            mesh_.vertices.push_back(hole.centreMm);
            for (std::size_t i = 0; i < loop.size(); ++i)
                mesh_.triangles.push_back({loop[i], loop[(i + 1) % loop.size()], middle});
        }
        for (std::size_t f = first; f < mesh_.triangles.size(); ++f) {
            const Triangle& t = mesh_.triangles[f];
            const Vec3& a = mesh_.vertices[t[0]];
            hole.areaMm2 += 0.5 * (mesh_.vertices[t[1]] - a).cross(mesh_.vertices[t[2]] - a).norm();
        }
        return hole;
    }

    [[nodiscard]] const Vec3& at(const Loop& loop, std::size_t i) const { return mesh_.vertices[loop[i]]; }

    // True when the mesh has this edge already, other than as a side of the loop.
    [[nodiscard]] bool isTaken(std::uint32_t a, std::uint32_t b) const {
        return std::binary_search(taken_.begin(), taken_.end(), std::pair(std::min(a, b), std::max(a, b)));
    }

    /// Large loops are cut in two until the exact way can be paid. No recursion: a cut may take off three vertices of
    /// a hundred thousand.
    bool triangulate(const Loop& whole) {
        std::vector<Loop> waiting{whole};
        while (!waiting.empty()) {
            const Loop loop = std::move(waiting.back());
            waiting.pop_back();
            if (!(loop.size() <= kLargestExact ? leastArea(loop) : cutInTwo(loop, waiting))) return false;
        }
        return true;
    }

    // Along the chord that is shortest for the way around it that it saves.
    bool cutInTwo(const Loop& loop, std::vector<Loop>& parts) {
        const std::size_t n = loop.size(), stride = std::max<std::size_t>(1, n / 1500);
        std::vector<double> along(n + 1, 0.0);
        for (std::size_t i = 0; i < n; ++i)
            along[i + 1] = along[i] + (at(loop, (i + 1) % n) - at(loop, i)).norm();
        double best = std::numeric_limits<double>::infinity();
        std::size_t from = 0, to = 0;
        for (std::size_t i = 0; i < n; i += stride)
            for (std::size_t k = i + 2; k < n; k += stride) {
                if (i == 0 && k == n - 1) continue;
                const double way = std::min(along[k] - along[i], along[n] - along[k] + along[i]);
                const double ratio = (at(loop, k) - at(loop, i)).norm() / way;
                if (!(ratio < best) || isTaken(loop[i], loop[k])) continue;
                best = ratio;
                from = i;
                to = k;
            }
        if (to == 0) return false;
        Loop one(loop.begin() + static_cast<std::ptrdiff_t>(from), loop.begin() + static_cast<std::ptrdiff_t>(to) + 1);
        Loop other(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(from) + 1);
        other.insert(other.end(), loop.begin() + static_cast<std::ptrdiff_t>(to), loop.end());
        parts.push_back(std::move(other));
        parts.push_back(std::move(one));  // the first to be taken
        return true;
    }

    [[nodiscard]] double cost(const Vec3& a, const Vec3& b, const Vec3& c) const {
        const double area = 0.5 * (b - a).cross(c - a).norm();
        const double sides = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
        // Area decides; among equals (a flat hole) short sides do, and faces without area are the last resort.
        constexpr double kSides = 0.01, kFlat = 1e-9;
        return area + kSides * sides + (area < kFlat * sides ? sides : 0.0);
    }

    bool leastArea(const Loop& loop) {
        const std::size_t n = loop.size();
        if (n < 3) return false;
        const double kInfinity = std::numeric_limits<double>::infinity();
        std::vector<double> best(n * n, 0.0);
        std::vector<std::uint32_t> apex(n * n, 0);
        for (std::size_t length = 2; length < n; ++length)
            for (std::size_t i = 0; i + length < n; ++i) {
                const std::size_t k = i + length;
                double least = kInfinity;
                // The side from the last vertex to the first is one of the hole's own.
                if (length == n - 1 || !isTaken(loop[i], loop[k]))
                    for (std::size_t j = i + 1; j < k; ++j) {
                        const double parts = best[i * n + j] + best[j * n + k];
                        if (parts >= least) continue;
                        const double total = parts + cost(at(loop, i), at(loop, j), at(loop, k));
                        if (total >= least) continue;
                        least = total;
                        apex[i * n + k] = static_cast<std::uint32_t>(j);
                    }
                best[i * n + k] = least;
            }
        if (!(best[n - 1] < kInfinity)) return false;
        std::vector<std::pair<std::size_t, std::size_t>> open{{0, n - 1}};
        while (!open.empty()) {
            const auto [i, k] = open.back();
            open.pop_back();
            if (k - i < 2) continue;
            const std::size_t j = apex[i * n + k];
            mesh_.triangles.push_back({loop[i], loop[j], loop[k]});
            open.emplace_back(i, j);
            open.emplace_back(j, k);
        }
        return true;
    }

    TriangleMesh& mesh_;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> taken_;  ///< edges between vertices of loops, sorted
};

}  // namespace

std::vector<ClosedHole> closeHoles(TriangleMesh& mesh) {
    return HoleCloser(mesh).closeAll();
}

}  // namespace handpiece::geometry
