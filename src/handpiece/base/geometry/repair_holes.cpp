// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/repair_holes.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <span>

#include "handpiece/base/geometry/clear_patch.h"
#include "handpiece/base/geometry/mesh_edges.h"
#include "handpiece/base/geometry/self_intersection.h"

namespace handpiece::geometry {
namespace {

using core::Vec3;
constexpr std::size_t kLargestExact = 128;  // the exact triangulation costs its cube

class HoleCloser {
  public:
    explicit HoleCloser(TriangleMesh& mesh) : mesh_(mesh) {}

    std::vector<ClosedHole> closeAll() {
        const std::vector<Loop> loops = openLoops(mesh_);
        taken_ = edgesBetween(mesh_, loops);
        std::vector<ClosedHole> holes;
        std::vector<std::size_t> first;
        for (const Loop& loop : loops) {
            first.push_back(mesh_.triangles.size());
            holes.push_back(close(loop));
        }
        uncross(loops, first, holes);
        std::stable_sort(holes.begin(), holes.end(),
                         [](const ClosedHole& a, const ClosedHole& b) { return a.perimeterMm > b.perimeterMm; });
        return holes;
    }

  private:
    // Closes anew, one after another, the loops whose faces cross something; what cannot be helped stays as it is.
    void uncross(const std::vector<Loop>& loops, std::vector<std::size_t> first, std::vector<ClosedHole>& holes) {
        if (loops.empty()) return;
        const std::size_t given = first[0];
        first.push_back(mesh_.triangles.size());
        std::vector<std::uint8_t> crosses(loops.size(), 0);
        for (const CrossingFaces& c : selfIntersections(mesh_))
            for (const std::uint32_t f : {c.first, c.second})
                if (f >= given)
                    crosses[static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), f) - first.begin()) -
                            1] = 1;
        // The small ones first: a large one finds its way around them.
        std::vector<std::size_t> order;
        for (std::size_t l = 0; l < loops.size(); ++l)
            if (crosses[l]) order.push_back(l);
        if (order.empty()) return;
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return holes[a].perimeterMm < holes[b].perimeterMm; });
        std::vector<std::vector<Triangle>> patches(loops.size());
        for (std::size_t l = 0; l < loops.size(); ++l)
            patches[l].assign(mesh_.triangles.begin() + static_cast<std::ptrdiff_t>(first[l]),
                              mesh_.triangles.begin() + static_cast<std::ptrdiff_t>(first[l + 1]));
        // What stands already, but for the patches of those that are still to be closed.
        std::vector<std::uint8_t> stands(loops.size(), 0);
        for (std::size_t l = 0; l < loops.size(); ++l)
            stands[l] = !crosses[l];
        const auto assemble = [&](std::size_t without, std::size_t other) {
            mesh_.triangles.resize(given);
            for (std::size_t l = 0; l < loops.size(); ++l)
                if (stands[l] && l != without && l != other)
                    mesh_.triangles.insert(mesh_.triangles.end(), patches[l].begin(), patches[l].end());
        };
        for (const std::size_t l : order) {
            assemble(l, l);
            if (auto faces = ClearPatch(mesh_, taken_, loops[l]).find()) {
                patches[l] = std::move(*faces);
                stands[l] = 1;
            }
        }
        // Two that are in each other's way, as the borders of a band that runs round: one patch from one to the other.
        std::vector<std::uint8_t> gone(loops.size(), 0);
        for (const std::size_t l : order)
            for (const std::size_t m : order) {
                if (stands[l] || gone[l] || m == l || gone[m]) continue;
                assemble(l, m);
                auto faces = clearBridge(mesh_, taken_, loops[l], loops[m]);
                if (!faces) continue;
                patches[l] = std::move(*faces);
                patches[m].clear();
                stands[l] = stands[m] = gone[m] = 1;
                const double share =
                    static_cast<double>(holes[m].edges) / static_cast<double>(holes[l].edges + holes[m].edges);
                holes[l].centreMm += share * (holes[m].centreMm - holes[l].centreMm);
                holes[l].edges += holes[m].edges;
                holes[l].perimeterMm += holes[m].perimeterMm;
            }
        stands.assign(loops.size(), 1);
        assemble(loops.size(), loops.size());
        for (std::size_t l = 0; l < loops.size(); ++l)
            holes[l].areaMm2 = areaMm2(mesh_, patches[l]);
        for (std::size_t l = loops.size(); l-- > 0;)
            if (gone[l]) holes.erase(holes.begin() + static_cast<std::ptrdiff_t>(l));
    }

    ClosedHole close(const Loop& loop) {
        ClosedHole hole;
        hole.edges = loop.size();
        hole.perimeterMm = perimeterMm(mesh_, loop);
        for (std::size_t i = 0; i < loop.size(); ++i)
            hole.centreMm += at(loop, i) / static_cast<double>(loop.size());
        const std::size_t first = mesh_.triangles.size();
        if (!triangulate(loop)) {
            // Every diagonal that is needed exists already elsewhere: a new vertex in the middle always works.
            mesh_.triangles.resize(first);
            const auto middle = static_cast<std::uint32_t>(mesh_.vertices.size());
            mesh_.vertices.push_back(hole.centreMm);
            for (std::size_t i = 0; i < loop.size(); ++i)
                mesh_.triangles.push_back({loop[i], loop[(i + 1) % loop.size()], middle});
        }
        hole.areaMm2 = areaMm2(mesh_, std::span<const Triangle>(mesh_.triangles).subspan(first));
        return hole;
    }

    [[nodiscard]] const Vec3& at(const Loop& loop, std::size_t i) const { return mesh_.vertices[loop[i]]; }

    // True when the mesh has this edge already, other than as a side of the loop.
    [[nodiscard]] bool isTaken(std::uint32_t a, std::uint32_t b) const { return holdsEdge(taken_, a, b); }

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

    bool leastArea(const Loop& loop) {
        return leastAreaFaces(
            mesh_, loop, [this](auto a, auto b) { return !isTaken(a, b); }, [](const Triangle&) { return true; },
            mesh_.triangles);
    }

    TriangleMesh& mesh_;
    EdgeList taken_;  ///< between vertices of loops
};

}  // namespace

std::vector<Loop> openLoops(const TriangleMesh& mesh) {
    constexpr std::uint32_t kNone = 0xffffffffu;
    const MeshEdges edges(mesh);
    std::vector<std::uint32_t> next(mesh.vertices.size(), kNone);
    for (const MeshEdges::Edge& e : edges.edges()) {
        if (e.count != 1) continue;
        const HalfEdge h = edges.halfEdges(e)[0];
        next[toVertex(mesh, h)] = fromVertex(mesh, h);  // the hole runs the other way
    }
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

double perimeterMm(const TriangleMesh& mesh, const Loop& loop) {
    double length = 0.0;
    for (std::size_t i = 0; i < loop.size(); ++i)
        length += (mesh.vertices[loop[i]] - mesh.vertices[loop[(i + 1) % loop.size()]]).norm();
    return length;
}

double areaMm2(const TriangleMesh& mesh, std::span<const Triangle> faces) {
    double area = 0.0;
    for (const Triangle& t : faces) {
        const Vec3& a = mesh.vertices[t[0]];
        area += 0.5 * (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm();
    }
    return area;
}

std::vector<ClosedHole> closeHoles(TriangleMesh& mesh) {
    return HoleCloser(mesh).closeAll();
}

}  // namespace handpiece::geometry
