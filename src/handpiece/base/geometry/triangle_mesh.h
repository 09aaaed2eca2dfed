// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A plain triangle mesh [mm], counter-clockwise seen from outside.

#include <array>
#include <cstdint>
#include <vector>

#include "handpiece/base/core/vec.h"

namespace handpiece::geometry {

using Triangle = std::array<std::uint32_t, 3>;

/// Shared vertices and the triangles between them. Says nothing about being closed: ask inspect().
struct TriangleMesh {
    std::vector<core::Vec3> vertices;  ///< [mm]
    std::vector<Triangle> triangles;   ///< indices into vertices; counter-clockwise from outside

    [[nodiscard]] core::Box bounds() const {
        core::Box box;
        for (const core::Vec3& v : vertices)
            box.extend(v);
        return box;
    }
};

/// Sum of the triangles' areas [mm2].
[[nodiscard]] double surfaceAreaMm2(const TriangleMesh& mesh);
/// Signed enclosed volume [mm3], by the divergence theorem; positive when the triangles face outwards.
[[nodiscard]] double enclosedVolumeMm3(const TriangleMesh& mesh);
/// The mesh with every coordinate multiplied: into another unit.
[[nodiscard]] TriangleMesh scaled(TriangleMesh mesh, double factor);
/// The mesh with every vertex mapped by `pose`.
[[nodiscard]] TriangleMesh transformed(TriangleMesh mesh, const core::Pose& pose);

}  // namespace handpiece::geometry
