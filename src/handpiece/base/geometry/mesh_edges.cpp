// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/mesh_edges.h"

#include <algorithm>
#include <numeric>

namespace handpiece::geometry {

MeshEdges::MeshEdges(const TriangleMesh& mesh) {
    // Half-edges in buckets by their lower vertex, each bucket sorted by the higher one: linear but for short sorts.
    struct Entry {
        std::uint32_t high;
        HalfEdge halfEdge;
    };
    std::vector<std::uint32_t> start(mesh.vertices.size() + 1, 0);
    const auto forEachHalfEdge = [&](auto&& visit) {
        for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
            const Triangle& t = mesh.triangles[f];
            if (repeatsCorner(t)) continue;
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t a = t[k], b = t[k == 2 ? 0 : k + 1];
                visit(std::min(a, b), std::max(a, b), 3 * f + k);
            }
        }
    };
    forEachHalfEdge([&](std::uint32_t low, std::uint32_t, HalfEdge) { ++start[low + 1]; });
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<Entry> entries(start.back());
    std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
    forEachHalfEdge([&](std::uint32_t low, std::uint32_t high, HalfEdge h) { entries[next[low]++] = {high, h}; });

    halfEdges_.reserve(entries.size());
    edges_.reserve(entries.size() / 2 + 1);
    for (std::uint32_t low = 0; low + 1 < start.size(); ++low) {
        const auto begin = entries.begin() + start[low], end = entries.begin() + start[low + 1];
        std::sort(begin, end, [](const Entry& a, const Entry& b) {
            return a.high != b.high ? a.high < b.high : a.halfEdge < b.halfEdge;
        });
        for (auto at = begin; at != end;) {
            Edge edge{low, at->high, static_cast<std::uint32_t>(halfEdges_.size()), 0};
            for (; at != end && at->high == edge.high; ++at, ++edge.count)
                halfEdges_.push_back(at->halfEdge);
            edges_.push_back(edge);
        }
    }
}

DisjointSets::DisjointSets(std::size_t n) : parent_(n) {
    std::iota(parent_.begin(), parent_.end(), 0u);
}

std::uint32_t DisjointSets::find(std::uint32_t i) {
    while (parent_[i] != i)
        i = parent_[i] = parent_[parent_[i]];
    return i;
}

void DisjointSets::join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a < b)
        parent_[b] = a;
    else
        parent_[a] = b;
}

Shells shellsOf(const TriangleMesh& mesh, const MeshEdges& edges) {
    DisjointSets sets(mesh.triangles.size());
    for (const MeshEdges::Edge& e : edges.edges()) {
        const std::span<const HalfEdge> half = edges.halfEdges(e);
        for (const HalfEdge h : half.subspan(1))
            sets.join(half[0] / 3, h / 3);
    }
    Shells shells;
    shells.ofFace.resize(mesh.triangles.size());
    for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
        const std::uint32_t root = sets.find(f);  // the shell's first face, already numbered
        shells.ofFace[f] = root == f ? static_cast<std::uint32_t>(shells.count++) : shells.ofFace[root];
    }
    return shells;
}

std::vector<double> shellVolumesMm3(const TriangleMesh& mesh, const Shells& shells) {
    std::vector<double> six(shells.count, 0.0);
    std::vector<std::uint32_t> origin(shells.count, 0);
    std::vector<std::uint8_t> seen(shells.count, 0);
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        const Triangle& t = mesh.triangles[f];
        const std::uint32_t s = shells.ofFace[f];
        if (!seen[s]) {
            seen[s] = 1;
            origin[s] = t[0];
        }
        const core::Vec3& o = mesh.vertices[origin[s]];
        six[s] += (mesh.vertices[t[0]] - o).dot((mesh.vertices[t[1]] - o).cross(mesh.vertices[t[2]] - o));
    }
    for (double& v : six)
        v /= 6.0;
    return six;
}

std::vector<std::uint32_t> nestingOf(const TriangleMesh& mesh, const Shells& shells,
                                     std::span<const std::uint8_t> closed) {
    std::vector<std::uint32_t> depth(shells.count, 0);
    if (shells.count < 2) return depth;
    std::vector<core::Box> boxes(shells.count);
    std::vector<core::Vec3> probe(shells.count, core::Vec3::Zero());
    std::vector<std::uint32_t> size(shells.count, 0), start(shells.count + 1, 0);
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        const std::uint32_t s = shells.ofFace[f];
        if (size[s]++ == 0) {
            const Triangle& t = mesh.triangles[f];
            probe[s] = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
        }
        for (const std::uint32_t v : mesh.triangles[f])
            boxes[s].extend(mesh.vertices[v]);
    }
    std::partial_sum(size.begin(), size.end(), start.begin() + 1);
    std::vector<std::uint32_t> faces(mesh.triangles.size()), next(start.begin(), start.end() - 1);
    for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
        faces[next[shells.ofFace[f]]++] = f;

    // Parity of the crossings of a ray along +z; an edge belongs to the side of the ray where a half-open rule puts it,
    // computed the same way from both its faces.
    const auto crosses = [&](const core::Vec3& p, const Triangle& t) {
        bool inside = false;
        for (int k = 0; k < 3; ++k) {
            std::uint32_t i = t[static_cast<std::size_t>(k)], j = t[static_cast<std::size_t>(k == 2 ? 0 : k + 1)];
            if (i > j) std::swap(i, j);
            const core::Vec3 &a = mesh.vertices[i], &b = mesh.vertices[j];
            if ((a.y() > p.y()) == (b.y() > p.y())) continue;
            if (p.x() < a.x() + (b.x() - a.x()) * ((p.y() - a.y()) / (b.y() - a.y()))) inside = !inside;
        }
        if (!inside) return false;
        const core::Vec3& a = mesh.vertices[t[0]];
        const core::Vec3 normal = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
        return normal.z() != 0.0 &&
               a.z() - (normal.x() * (p.x() - a.x()) + normal.y() * (p.y() - a.y())) / normal.z() > p.z();
    };
    // Along x, so that thousands of small shells are not each compared with all others.
    std::vector<std::uint32_t> order(shells.count);
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return boxes[a].min.x() != boxes[b].min.x() ? boxes[a].min.x() < boxes[b].min.x() : a < b;
    });
    for (std::size_t outer = 0; outer < shells.count; ++outer) {
        if (!closed[outer]) continue;
        const auto first = std::lower_bound(order.begin(), order.end(), boxes[outer].min.x(),
                                            [&](std::uint32_t s, double x) { return boxes[s].min.x() < x; });
        for (auto at = first; at != order.end() && boxes[*at].min.x() <= boxes[outer].max.x(); ++at) {
            const std::uint32_t inner = *at;
            if (inner == outer || (boxes[inner].min.array() < boxes[outer].min.array()).any() ||
                (boxes[inner].max.array() > boxes[outer].max.array()).any())
                continue;
            bool inside = false;
            for (std::uint32_t i = start[outer]; i < start[outer + 1]; ++i)
                if (crosses(probe[inner], mesh.triangles[faces[i]])) inside = !inside;
            depth[inner] += inside;
        }
    }
    return depth;
}

Orientation agreeingOrientation(const TriangleMesh& mesh, const MeshEdges& edges) {
    const std::size_t count = mesh.triangles.size();
    // The neighbour across each half-edge whose edge has exactly two faces, and whether the two run the same way.
    constexpr std::uint32_t kNone = 0xffffffffu;
    std::vector<std::uint32_t> across(3 * count, kNone);
    for (const MeshEdges::Edge& e : edges.edges()) {
        if (e.count != 2) continue;
        const std::span<const HalfEdge> half = edges.halfEdges(e);
        across[half[0]] = half[1];
        across[half[1]] = half[0];
    }
    Orientation result;
    result.turn.assign(count, 2);  // 2: not reached yet
    std::vector<std::uint32_t> reached;
    for (std::uint32_t seed = 0; seed < count; ++seed) {
        if (result.turn[seed] != 2) continue;
        reached.assign(1, seed);
        result.turn[seed] = 0;
        std::size_t turned = 0;
        for (std::size_t i = 0; i < reached.size(); ++i) {
            const std::uint32_t f = reached[i];
            turned += result.turn[f];
            for (std::uint32_t k = 0; k < 3; ++k) {
                const HalfEdge h = 3 * f + k, other = across[h];
                if (other == kNone) continue;
                const bool sameWay = fromVertex(mesh, h) == fromVertex(mesh, other);
                const std::uint8_t wanted = static_cast<std::uint8_t>(result.turn[f] ^ (sameWay ? 1 : 0));
                std::uint8_t& turn = result.turn[other / 3];
                if (turn == 2) {
                    turn = wanted;
                    reached.push_back(other / 3);
                } else if (turn != wanted) {
                    result.orientable = false;
                }
            }
        }
        if (2 * turned > reached.size()) {
            for (const std::uint32_t f : reached)
                result.turn[f] ^= 1;
            turned = reached.size() - turned;
        }
        result.turned += turned;
    }
    return result;
}

}  // namespace handpiece::geometry
