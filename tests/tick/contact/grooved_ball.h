// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A closed, concave test surface with what a crown has: cusps, crossing fissures 0.15 mm wide, swellings.

#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::test {

inline double grooveRadius(const core::Vec3& d) {
    double r = 4.0 + 0.15 * std::sin(3.0 * d.x() + 1.0) * std::cos(4.0 * d.y());
    for (const auto& [x, y] : {std::pair{0.4, 0.35}, {-0.35, 0.4}, {0.42, -0.38}, {-0.38, -0.4}, {0.0, 0.62}})
        r += 0.7 * std::exp(-18.0 * ((d - core::Vec3(x, y, std::sqrt(1.0 - x * x - y * y))).squaredNorm()));
    if (d.z() > 0.0) {
        const double fade = 1.0 - std::exp(-20.0 * d.z() * d.z());
        for (const double across : {d.x() + 0.1 * d.y(), d.y() - 0.2 * d.x()})
            r -= 0.6 * fade * std::exp(-0.5 * std::pow(across * 4.0 / 0.15, 2)) * std::exp(-1.5 * (1.0 - d.z()));
    }
    return r;
}

/// 8 n^2 faces; +z is the crown's top, about 4 mm from the origin.
inline geometry::TriangleMesh groovedBall(int n) {
    geometry::TriangleMesh mesh;
    std::map<std::array<int, 3>, std::uint32_t> known;
    const auto vertex = [&](int x, int y, int z) {
        const auto [it, added] = known.try_emplace({x, y, z}, static_cast<std::uint32_t>(mesh.vertices.size()));
        if (added) {
            const core::Vec3 d = core::Vec3(x, y, z).normalized();
            mesh.vertices.push_back(grooveRadius(d) * d);
        }
        return it->second;
    };
    for (int face = 0; face < 8; ++face) {
        const int sx = face & 1 ? -1 : 1, sy = face & 2 ? -1 : 1, sz = face & 4 ? -1 : 1;
        const bool flip = sx * sy * sz < 0;
        const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            if (flip) std::swap(b, c);
            mesh.triangles.push_back({a, b, c});
        };
        for (int i = 0; i < n; ++i)
            for (int j = 0; i + j < n; ++j) {
                const auto at = [&](int a, int b) { return vertex(sx * (n - a - b), sy * a, sz * b); };
                add(at(i, j), at(i + 1, j), at(i, j + 1));
                if (i + j + 1 < n) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            }
    }
    return mesh;
}

}  // namespace handpiece::test
