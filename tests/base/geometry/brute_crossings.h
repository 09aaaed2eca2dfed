// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Faces that cross, found without the finder: all pairs, and one small linear system for each edge and face instead of
/// signed heights.

#include <Eigen/LU>
#include <set>
#include <utility>

#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::test {

/// Pairs without a common vertex of which an edge of one goes through the inside of the other. `touchingMm`: what ends
/// so near the other's plane only touches.
inline std::set<std::pair<std::uint32_t, std::uint32_t>> bruteForce(const geometry::TriangleMesh& mesh,
                                                                    double touchingMm = 0.0) {
    const auto pierces = [&](const core::Vec3& p, const core::Vec3& q, const geometry::Triangle& t) {
        core::Mat3 system;
        system << mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]], p - q;
        const double determinant = system.determinant();
        if (std::abs(determinant) < 1e-14) return false;
        const core::Vec3 s = system.inverse() * (p - mesh.vertices[t[0]]);
        // Over the plane: the box of edge and face over the face.
        const double heightMm = std::abs(determinant) / system.col(0).cross(system.col(1)).norm();
        const double ends = touchingMm / heightMm;
        return s.x() > ends && s.y() > ends && s.x() + s.y() < 1 - ends && s.z() > ends && s.z() < 1 - ends;
    };
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        core::Box box;
        for (const std::uint32_t v : mesh.triangles[i])
            box.extend(mesh.vertices[v]);
        for (std::uint32_t j = 0; j < mesh.triangles.size(); ++j) {
            const geometry::Triangle &a = mesh.triangles[i], &b = mesh.triangles[j];
            bool share = false;
            core::Box other;
            for (const std::uint32_t w : b) {
                other.extend(mesh.vertices[w]);
                for (const std::uint32_t v : a)
                    share = share || v == w;
            }
            if (share || (box.min.array() > other.max.array()).any() || (other.min.array() > box.max.array()).any())
                continue;
            for (int k = 0; k < 3; ++k)
                if (pierces(mesh.vertices[a[static_cast<std::size_t>(k)]],
                            mesh.vertices[a[static_cast<std::size_t>((k + 1) % 3)]], b))
                    pairs.emplace(std::min(i, j), std::max(i, j));
        }
    }
    return pairs;
}

}  // namespace handpiece::test
