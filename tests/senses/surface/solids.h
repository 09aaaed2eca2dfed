// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Closed forms to contour, and questions to ask of a mesh.

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/model/field/distance_field.h"

namespace handpiece::test {

using Distance = std::function<double(const core::Vec3&)>;

inline Distance sphere(const core::Vec3& centre, double radiusMm) {
    return [=](const core::Vec3& p) { return (p - centre).norm() - radiusMm; };
}
/// `half` extents about `centre`, turned by `turn`.
inline Distance box(const core::Vec3& centre, const core::Vec3& half, const core::Quat& turn = core::Quat::Identity()) {
    return [=](const core::Vec3& p) {
        const core::Vec3 q = (turn.conjugate() * (p - centre)).cwiseAbs() - half;
        return q.cwiseMax(0.0).norm() + std::min(0.0, q.maxCoeff());
    };
}
/// A flat-ended bur: axis +z of `turn`, from its tip upwards without end.
inline Distance cylinderBur(const core::Vec3& tip, double radiusMm, const core::Quat& turn = core::Quat::Identity()) {
    return [=](const core::Vec3& p) {
        const core::Vec3 q = turn.conjugate() * (p - tip);
        const double side = std::hypot(q.x(), q.y()) - radiusMm, below = -q.z();
        return std::hypot(std::max(side, 0.0), std::max(below, 0.0)) + std::min(0.0, std::max(side, below));
    };
}
/// `solid` less what lies in `bur`, as the cutter leaves it.
inline Distance cut(const Distance& solid, const Distance& bur) {
    return [=](const core::Vec3& p) { return std::max(solid(p), -bur(p)); };
}

inline field::DistanceField sampled(const Distance& solid, const core::Box& around, double voxelMm = 0.05) {
    field::FieldSettings settings;
    settings.voxelMm = voxelMm;
    return field::DistanceField::fromFunction(around.grown(6.0 * voxelMm), settings, solid);
}

/// Directed edges that no triangle runs the other way: 0 when closed, whether or not more than two meet at an edge.
inline std::size_t openEdges(const geometry::TriangleMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = t[k], b = t[(k + 1) % 3];
            balance[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    return static_cast<std::size_t>(
        std::count_if(balance.begin(), balance.end(), [](const auto& edge) { return edge.second != 0; }));
}

}  // namespace handpiece::test
