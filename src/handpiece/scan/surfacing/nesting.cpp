// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/surfacing/nesting.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_set>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/points_beyond.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/scan/surfacing/smoothing.h"

namespace handpiece::surfacing {

using core::Vec3;
using geometry::NearestPoint;
using geometry::Triangle;
using geometry::TriangleMesh;
using geometry::TriangleTree;

namespace {

constexpr double kMore = 1.1;  ///< of the way asked for, so that rounds come to an end

/// A bound that a point breaks: how far its distance has to change, and along which way it grows.
struct Breach {
    double byMm = 0.0;
    Vec3 gradient = Vec3::Zero();
    std::uint32_t triangle = geometry::kNoTriangle;
};

Breach breachAt(const TriangleTree& tree, const Vec3& p, const Bounds& bounds, double nearMm) {
    Breach breach;
    const NearestPoint n = tree.nearest(p, nearMm);
    if (n.triangle == geometry::kNoTriangle) return breach;
    const double sign = tree.side(p, n), distance = sign * n.distanceMm;
    if (distance > bounds.high)
        breach.byMm = bounds.high - distance;
    else if (distance < bounds.low)
        breach.byMm = bounds.low - distance;
    else
        return breach;
    breach.triangle = n.triangle;
    if (n.distanceMm > 1e-9) {
        breach.gradient = sign / n.distanceMm * (p - n.pointMm);
    } else {
        breach.gradient = tree.pseudonormal(n.triangle, n.feature);
    }
    return breach;
}

std::vector<Breach> breaches(const TriangleMesh& points, std::span<const Bounds> bounds, const TriangleTree& tree,
                             double nearMm) {
    std::vector<Breach> found(points.vertices.size());
    const core::Box& box = tree.bounds();
    core::parallelFor(found.size(), 512, [&](std::size_t b, std::size_t e) {
        for (std::size_t v = b; v < e; ++v) {
            if (!(bounds[v].low > -1e300) && !(bounds[v].high < 1e300)) continue;
            const Vec3& p = points.vertices[v];
            if (((p - box.max).array() > nearMm).any() || ((box.min - p).array() > nearMm).any()) continue;
            found[v] = breachAt(tree, p, bounds[v], nearMm);
        }
    });
    return found;
}

void longest(std::map<std::uint32_t, Vec3>& moves, std::uint32_t v, const Vec3& move) {
    const auto [place, isNew] = moves.try_emplace(v, move);
    if (!isNew && place->second.squaredNorm() < move.squaredNorm()) place->second = move;
}

/// Vertices of `moving` whose faces cross `still`.
std::vector<std::uint32_t> crossingVertices(const TriangleMesh& moving, const TriangleMesh& still) {
    TriangleMesh both = moving;
    const auto offset = static_cast<std::uint32_t>(moving.vertices.size());
    both.vertices.insert(both.vertices.end(), still.vertices.begin(), still.vertices.end());
    for (const Triangle& t : still.triangles)
        both.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
    std::vector<std::uint32_t> found;
    for (const geometry::CrossingFaces& c : geometry::selfIntersections(both))
        if (c.first < moving.triangles.size() && c.second >= moving.triangles.size())
            for (const std::uint32_t v : moving.triangles[c.first])
                found.push_back(v);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

}  // namespace

Apart holdApart(TriangleMesh& moving, std::span<const Bounds> onMoving, const TriangleMesh& still,
                std::span<const Bounds> onStill, double nearMm, double mostMm, int rounds, bool strictly,
                const core::Progress& progress) {
    Apart result;
    if (moving.triangles.empty() || still.triangles.empty()) return result;
    const TriangleTree stillTree(still);
    std::map<std::uint32_t, Vec3> touched;  // where they were
    const bool asksStill =
        std::any_of(onStill.begin(), onStill.end(), [](const Bounds& b) { return b.low > -1e300 || b.high < 1e300; });
    const auto fail = [&](double byMm, const Vec3& at) {
        if (std::abs(byMm) <= result.failedByMm) return;
        result.failedByMm = std::abs(byMm);
        result.failedMm = at;
    };
    for (int round = 0; round < rounds; ++round) {
        core::report(progress, static_cast<double>(round) / rounds);
        result.failed = 0;
        result.failedByMm = 0.0;
        // First the vertices themselves; what moved before anything else is looked at need not be looked at twice.
        std::map<std::uint32_t, Vec3> moves;
        const std::vector<Breach> own = breaches(moving, onMoving, stillTree, nearMm);
        for (std::uint32_t v = 0; v < own.size(); ++v)
            if (own[v].byMm != 0.0) {
                moves[v] = kMore * own[v].byMm * own[v].gradient;
                fail(own[v].byMm, moving.vertices[v]);
            }
        if (moves.empty() && asksStill) {
            const TriangleTree tree(moving);
            const std::vector<Breach> others = breaches(still, onStill, tree, nearMm);
            for (std::size_t u = 0; u < others.size(); ++u) {
                if (others[u].byMm == 0.0) continue;
                // The distance of a point grows where the surface goes the other way.
                const Triangle& t = moving.triangles[tree.triangles()[others[u].triangle].index];
                for (const std::uint32_t v : t)
                    longest(moves, v, -kMore * others[u].byMm * others[u].gradient);
                fail(others[u].byMm, still.vertices[u]);
            }
        }
        if (moves.empty() && strictly) {
            const std::vector<Vec3> normals = vertexNormals(moving);
            for (const std::uint32_t v : crossingVertices(moving, still)) {
                moves[v] = -0.1 * nearMm * normals[v];
                fail(nearMm, moving.vertices[v]);
            }
        }
        result.failed = moves.size();
        if (moves.empty()) break;
        for (const auto& [v, move] : moves) {
            const Vec3& was = touched.try_emplace(v, moving.vertices[v]).first->second;
            const Vec3 way = moving.vertices[v] + move - was;
            const double length = way.norm();
            moving.vertices[v] = was + (length > mostMm ? mostMm / length : 1.0) * way;
        }
    }
    result.moved = touched.size();
    for (const auto& [v, was] : touched)
        result.movedMm = std::max(result.movedMm, (moving.vertices[v] - was).norm());
    return result;
}

DrawnBack drawBack(TriangleMesh& tissue, const TriangleTree& tooth) {
    constexpr int kDrawRounds = 6;
    constexpr double kTo = 0.75;  // of what is allowed: uncrossing may push a little out again
    DrawnBack result;
    std::map<std::uint32_t, Vec3> was;
    for (int round = 0;; ++round) {
        const std::vector<std::uint32_t> out = geometry::pointsBeyond(tooth, tissue.vertices, kMaxStandOutMm);
        result.left = out.size();
        if (out.empty() || round == kDrawRounds) break;
        for (const std::uint32_t v : out) {
            Vec3& p = tissue.vertices[v];
            was.try_emplace(v, p);
            const NearestPoint n = tooth.nearest(p);
            p = n.pointMm + kTo * kMaxStandOutMm / n.distanceMm * (p - n.pointMm);
        }
        std::size_t crossing = 0;
        result.movedMm = std::max(result.movedMm, uncross(tissue, crossing));
    }
    result.moved = was.size();
    for (const auto& [v, before] : was)
        result.movedMm = std::max(result.movedMm, (tissue.vertices[v] - before).norm());
    return result;
}

TriangleMesh facesNear(const TriangleMesh& mesh, std::span<const Vec3> points, double reachMm) {
    const auto keyOf = [&](const Vec3& p, int dx, int dy, int dz) {
        const auto at = [&](int axis, int d) {
            return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(p[axis] / reachMm)) + d +
                                              (1 << 20)) &
                   0x1fffffu;
        };
        return at(0, dx) | at(1, dy) << 21 | at(2, dz) << 42;
    };
    std::unordered_set<std::uint64_t> cells;
    for (const Vec3& p : points)
        for (int d = 0; d < 27; ++d)
            cells.insert(keyOf(p, d % 3 - 1, d / 3 % 3 - 1, d / 9 - 1));
    std::vector<std::uint8_t> isNear(mesh.vertices.size(), 0);
    for (std::size_t v = 0; v < isNear.size(); ++v)
        isNear[v] = cells.count(keyOf(mesh.vertices[v], 0, 0, 0)) > 0;
    Shells asShells;
    for (const Triangle& t : mesh.triangles)
        asShells.ofFace.push_back(isNear[t[0]] | isNear[t[1]] | isNear[t[2]] ? 1u : 0u);
    return keptShells(mesh, asShells, {false, true});
}

}  // namespace handpiece::surfacing
