// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Closed surfaces for tests, and the slow, plain distance to a triangle that fast code is compared with.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "base/geometry/meshes.h"
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::test {

/// A subdivided icosahedron on the unit sphere, mapped point by point: 20 x 4^level faces, counter-clockwise from
/// outside.
inline geometry::TriangleMesh icosphere(int level, const std::function<core::Vec3(const core::Vec3&)>& map) {
    using core::Vec3;
    const double g = (1.0 + std::sqrt(5.0)) / 2.0;
    geometry::TriangleMesh mesh;
    mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                     {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    for (Vec3& v : mesh.vertices)
        v.normalize();
    mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (int i = 0; i < level; ++i) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [at, fresh] =
                middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
            if (fresh) mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized());
            return at->second;
        };
        std::vector<geometry::Triangle> finer;
        for (const auto& [a, b, c] : mesh.triangles) {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        mesh.triangles = std::move(finer);
    }
    for (Vec3& v : mesh.vertices)
        v = map(v);
    return mesh;
}

inline geometry::TriangleMesh sphereMesh(int level, double radiusMm, const core::Vec3& centre = core::Vec3::Zero()) {
    return icosphere(level, [&](const core::Vec3& v) { return core::Vec3(centre + radiusMm * v); });
}

/// A closed surface with hollows and bumps, about `radiusMm` large: concave as a tooth is.
inline geometry::TriangleMesh bumpyMesh(int level, double radiusMm) {
    return icosphere(level, [&](const core::Vec3& v) {
        const double bump =
            1.0 + 0.18 * std::sin(5.0 * v.x() + 1.0) * std::cos(4.0 * v.y()) + 0.12 * std::sin(7.0 * v.z());
        return core::Vec3(radiusMm * bump * v);
    });
}

inline double distanceToSegment(const core::Vec3& p, const core::Vec3& a, const core::Vec3& b) {
    const double length2 = (b - a).squaredNorm();
    const double t = length2 > 0.0 ? std::clamp((p - a).dot(b - a) / length2, 0.0, 1.0) : 0.0;
    return (p - (a + t * (b - a))).norm();
}

/// Three segments, and the plane where the foot of the perpendicular lies inside: nothing clever.
inline double distanceToTriangle(const core::Vec3& p, const core::Vec3& a, const core::Vec3& b, const core::Vec3& c) {
    const double edges = std::min({distanceToSegment(p, a, b), distanceToSegment(p, b, c), distanceToSegment(p, c, a)});
    const core::Vec3 n = (b - a).cross(c - a);
    if (n.norm() < 1e-14) return edges;
    const bool inside =
        n.dot((b - a).cross(p - a)) >= 0.0 && n.dot((c - b).cross(p - b)) >= 0.0 && n.dot((a - c).cross(p - c)) >= 0.0;
    return inside ? std::min(edges, std::abs(n.dot(p - a)) / n.norm()) : edges;
}

inline double distanceToMesh(const core::Vec3& p, const geometry::TriangleMesh& mesh) {
    double best = std::numeric_limits<double>::infinity();
    for (const auto& [a, b, c] : mesh.triangles)
        best = std::min(best, distanceToTriangle(p, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]));
    return best;
}

/// Solid angle of every triangle, summed: 1 inside, 0 outside a closed surface.
inline double windingByBruteForce(const core::Vec3& p, const geometry::TriangleMesh& mesh) {
    double sum = 0.0;
    for (const auto& t : mesh.triangles) {
        const core::Vec3 a = mesh.vertices[t[0]] - p, b = mesh.vertices[t[1]] - p, c = mesh.vertices[t[2]] - p;
        const double la = a.norm(), lb = b.norm(), lc = c.norm();
        sum += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
    }
    return sum / (2.0 * M_PI);
}

}  // namespace handpiece::test
