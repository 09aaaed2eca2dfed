// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Meshes whose area, volume and flaws are known in advance.

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::test {

using geometry::Triangle;
using geometry::TriangleMesh;

/// A box with two triangles a side, facing outwards.
inline TriangleMesh boxMesh(const core::Vec3& low, const core::Vec3& high) {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.vertices.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z());
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

/// A sphere from an octahedron whose sides are cut in `n`: 8 n^2 faces, vertices on the sphere.
inline TriangleMesh sphereMesh(const core::Vec3& centre, double radius, std::uint32_t n) {
    TriangleMesh mesh;
    std::map<std::array<int, 3>, std::uint32_t> number;
    const auto vertex = [&](const core::Vec3& onOctahedron) {
        const core::Vec3 scaled = onOctahedron * static_cast<double>(n);
        const std::array<int, 3> key{static_cast<int>(std::lround(scaled.x())),
                                     static_cast<int>(std::lround(scaled.y())),
                                     static_cast<int>(std::lround(scaled.z()))};
        const auto [place, isNew] = number.try_emplace(key, static_cast<std::uint32_t>(mesh.vertices.size()));
        if (isNew) mesh.vertices.push_back(centre + radius * onOctahedron.normalized());
        return place->second;
    };
    for (int octant = 0; octant < 8; ++octant) {
        const core::Vec3 x(octant & 1 ? -1 : 1, 0, 0), y(0, octant & 2 ? -1 : 1, 0), z(0, 0, octant & 4 ? -1 : 1);
        const bool even = x.x() * y.y() * z.z() > 0;
        const auto at = [&](std::uint32_t i, std::uint32_t j) {
            return vertex((x * i + y * j + z * (n - i - j)) / static_cast<double>(n));
        };
        const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            mesh.triangles.push_back(even ? Triangle{a, b, c} : Triangle{a, c, b});
        };
        for (std::uint32_t i = 0; i < n; ++i)
            for (std::uint32_t j = 0; i + j < n; ++j) {
                add(at(i, j), at(i + 1, j), at(i, j + 1));
                if (i + j + 1 < n) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            }
    }
    return mesh;
}

/// A torus about z of n x n quads.
inline TriangleMesh torusMesh(double majorRadius, double minorRadius, std::uint32_t n) {
    constexpr double kTurn = 6.283185307179586;
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
            const double u = kTurn * i / n, v = kTurn * j / n, r = majorRadius + minorRadius * std::cos(v);
            mesh.vertices.emplace_back(r * std::cos(u), r * std::sin(u), minorRadius * std::sin(v));
            const std::uint32_t a = i * n + j, b = (i + 1) % n * n + j, c = (i + 1) % n * n + (j + 1) % n,
                                d = i * n + (j + 1) % n;
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
        }
    return mesh;
}

/// Both meshes in one, sharing nothing.
inline TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
    const auto offset = static_cast<std::uint32_t>(a.vertices.size());
    a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
    for (const Triangle& t : b.triangles)
        a.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
    return a;
}

inline TriangleMesh insideOut(TriangleMesh mesh) {
    for (Triangle& t : mesh.triangles)
        std::swap(t[1], t[2]);
    return mesh;
}

/// Every face with three vertices of its own, as in an STL file.
inline TriangleMesh soup(const TriangleMesh& mesh) {
    TriangleMesh result;
    for (const Triangle& t : mesh.triangles) {
        const auto first = static_cast<std::uint32_t>(result.vertices.size());
        for (const std::uint32_t v : t)
            result.vertices.push_back(mesh.vertices[v]);
        result.triangles.push_back({first, first + 1, first + 2});
    }
    return result;
}

/// Without the faces whose centre `isInHole` takes.
template <class Predicate>
TriangleMesh holed(TriangleMesh mesh, Predicate isInHole) {
    std::erase_if(mesh.triangles, [&](const Triangle& t) {
        return isInHole(((mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0).eval());
    });
    return mesh;
}

}  // namespace handpiece::test
