// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/clear_patch.h"

#include <algorithm>

#include "handpiece/base/geometry/mesh_edges.h"

namespace handpiece::geometry {
namespace {

using core::Vec3;

constexpr std::size_t kLargest = 320;  // the work of an exact patch grows with the cube

std::array<std::uint32_t, 3> keyOf(Triangle t) {
    std::sort(t.begin(), t.end());
    return {t[0], t[1], t[2]};
}

}  // namespace

bool holdsEdge(const EdgeList& edges, std::uint32_t a, std::uint32_t b) {
    return std::binary_search(edges.begin(), edges.end(), std::pair(std::min(a, b), std::max(a, b)));
}

double patchCost(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double area = 0.5 * (b - a).cross(c - a).norm();
    const double sides = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
    constexpr double kSides = 0.01, kFlat = 1e-9;
    return area + kSides * sides + (area < kFlat * sides ? sides : 0.0);
}

std::size_t ClearPatch::Hash::operator()(const Key& k) const {
    std::uint64_t h = k[0] * 0x9E3779B97F4A7C15ull;
    h = (h ^ (h >> 32) ^ k[1]) * 0xD6E8FEB86659FD93ull;
    return static_cast<std::size_t>((h ^ (h >> 32) ^ k[2]) * 0xC2B2AE3D27D4EB4Full);
}

ClearPatch::ClearPatch(const TriangleMesh& mesh, const EdgeList& taken, Loop loop)
    : mesh_(mesh), taken_(taken), tree_(mesh), whole_(std::move(loop)) {}

ClearPatch& ClearPatch::across(std::uint32_t from, std::uint32_t to) {
    edgeKnown_[{std::min(from, to), std::max(from, to), 0}] = barred;
    return *this;
}

std::optional<std::vector<Triangle>> ClearPatch::find() {
    constexpr int kTries = 12;  // each forbids what crossed in the one before
    for (int tries = 0; tries < kTries; ++tries) {
        faces_.clear();
        if (!cover() || repeatsEdge()) return std::nullopt;
        if (!forbidCrossing()) return std::move(faces_);
    }
    return std::nullopt;
}

bool ClearPatch::cover() {
    std::vector<Loop> waiting{whole_};
    while (!waiting.empty()) {
        const Loop loop = std::move(waiting.back());
        waiting.pop_back();
        if (!(loop.size() <= kLargest ? leastArea(loop) : halve(loop, waiting))) return false;
    }
    return true;
}

bool ClearPatch::leastArea(const Loop& loop) {
    return leastAreaFaces(
        mesh_, loop, [this](auto a, auto b) { return isFree(a, b); }, [this](const Triangle& t) { return isFree(t); },
        faces_);
}

// A vertex that stands in the loop twice can have the same edge from both of its places.
bool ClearPatch::repeatsEdge() const {
    EdgeList edges;
    for (const Triangle& t : faces_)
        for (std::size_t k = 0; k < 3; ++k)
            edges.emplace_back(t[k], t[(k + 1) % 3]);
    std::sort(edges.begin(), edges.end());
    return std::adjacent_find(edges.begin(), edges.end()) != edges.end();
}

// Of the faces that cross each other the larger ones may not come again. False where there are none.
bool ClearPatch::forbidCrossing() {
    TriangleMesh patch;
    patch.triangles = faces_;
    std::unordered_map<std::uint32_t, std::uint32_t> number;
    for (Triangle& t : patch.triangles)
        for (std::uint32_t& v : t) {
            const auto [found, isNew] = number.try_emplace(v, static_cast<std::uint32_t>(patch.vertices.size()));
            if (isNew) patch.vertices.push_back(mesh_.vertices[v]);
            v = found->second;
        }
    const std::vector<CrossingFaces> crossings = selfIntersections(patch);
    for (const CrossingFaces& c : crossings) {
        const auto sizeOf = [&](std::uint32_t f) {
            const Triangle& t = faces_[f];
            return patchCost(mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]]);
        };
        faceKnown_[keyOf(faces_[sizeOf(c.first) > sizeOf(c.second) ? c.first : c.second])] = barred;
    }
    return !crossings.empty();
}

bool ClearPatch::isFree(const Triangle& t) {
    Known& known = faceKnown_[keyOf(t)];
    if (known == unknown) known = repeatsCorner(t) || tree_.isCrossed(t) ? barred : free;
    return known == free;
}

bool ClearPatch::isFree(std::uint32_t a, std::uint32_t b) {
    Known& known = edgeKnown_[{std::min(a, b), std::max(a, b), 0}];
    if (known == unknown) known = a == b || holdsEdge(taken_, a, b) || tree_.isPierced(a, b) ? barred : free;
    return known == free;
}

// Along the free chord that is shortest for the way around it that it saves, and leaves two parts of some size.
bool ClearPatch::halve(const Loop& loop, std::vector<Loop>& parts) {
    const std::size_t n = loop.size(), stride = std::max<std::size_t>(1, n / 600), least = n / 6;
    std::vector<double> along(n + 1, 0.0);
    for (std::size_t i = 0; i < n; ++i)
        along[i + 1] = along[i] + (at(loop, (i + 1) % n) - at(loop, i)).norm();
    struct Chord {
        double ratio;
        std::size_t from, to;
    };
    std::vector<Chord> chords;
    for (std::size_t i = 0; i < n; i += stride)
        for (std::size_t k = i + least; k < std::min(n, i + n - least); k += stride) {
            const double way = std::min(along[k] - along[i], along[n] - along[k] + along[i]);
            chords.push_back({(at(loop, k) - at(loop, i)).norm() / way, i, k});
        }
    std::sort(chords.begin(), chords.end(), [](const Chord& a, const Chord& b) {
        return a.ratio != b.ratio ? a.ratio < b.ratio : std::pair(a.from, a.to) < std::pair(b.from, b.to);
    });
    for (const Chord& c : chords) {
        if (!isFree(loop[c.from], loop[c.to])) continue;
        const auto from = static_cast<std::ptrdiff_t>(c.from), to = static_cast<std::ptrdiff_t>(c.to);
        Loop other(loop.begin(), loop.begin() + from + 1);
        other.insert(other.end(), loop.begin() + to, loop.end());
        parts.push_back(std::move(other));
        parts.emplace_back(loop.begin() + from, loop.begin() + to + 1);
        return true;
    }
    return false;
}

std::optional<std::vector<Triangle>> clearBridge(const TriangleMesh& mesh, const EdgeList& taken, const Loop& one,
                                                 const Loop& other) {
    // Through a cut from a vertex of one to a vertex of the other, the two are one loop.
    constexpr std::size_t kCuts = 4;
    struct Cut {
        double lengthMm;
        std::size_t from, to;
    };
    std::vector<Cut> cuts;
    const std::size_t stride = std::max<std::size_t>(1, (one.size() + other.size()) / 1500);
    for (std::size_t i = 0; i < one.size(); i += stride)
        for (std::size_t k = 0; k < other.size(); k += stride)
            cuts.push_back({(mesh.vertices[one[i]] - mesh.vertices[other[k]]).norm(), i, k});
    std::sort(cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) {
        return a.lengthMm != b.lengthMm ? a.lengthMm < b.lengthMm : std::pair(a.from, a.to) < std::pair(b.from, b.to);
    });
    const CrossingTree tree(mesh);
    std::vector<std::size_t> tried;
    for (const Cut& c : cuts) {
        const auto isNear = [&](std::size_t i) {
            const std::size_t apart = std::max(i, c.from) - std::min(i, c.from);
            return std::min(apart, one.size() - apart) < one.size() / 10 + 1;
        };
        if (tried.size() == kCuts) break;
        if (std::any_of(tried.begin(), tried.end(), isNear) || holdsEdge(taken, one[c.from], other[c.to]) ||
            tree.isPierced(one[c.from], other[c.to]))
            continue;
        tried.push_back(c.from);
        Loop loop(one.begin() + static_cast<std::ptrdiff_t>(c.from), one.end());
        loop.insert(loop.end(), one.begin(), one.begin() + static_cast<std::ptrdiff_t>(c.from) + 1);
        loop.insert(loop.end(), other.begin() + static_cast<std::ptrdiff_t>(c.to), other.end());
        loop.insert(loop.end(), other.begin(), other.begin() + static_cast<std::ptrdiff_t>(c.to) + 1);
        if (auto faces = ClearPatch(mesh, taken, loop).across(one[c.from], other[c.to]).find()) return faces;
    }
    return std::nullopt;
}

EdgeList edgesBetween(const TriangleMesh& mesh, const std::vector<Loop>& loops) {
    EdgeList found;
    if (loops.empty()) return found;
    std::vector<std::uint8_t> onLoop(mesh.vertices.size(), 0);
    for (const Loop& loop : loops)
        for (const std::uint32_t v : loop)
            onLoop[v] = 1;
    const MeshEdges edges(mesh);
    for (const MeshEdges::Edge& e : edges.edges())
        if (onLoop[e.low] && onLoop[e.high]) found.emplace_back(e.low, e.high);
    return found;
}

}  // namespace handpiece::geometry
