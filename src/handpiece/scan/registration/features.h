// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Points spread evenly over a surface and what each one's surroundings look like. Private to this room.

#include <array>
#include <cstdint>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::registration {

/// Points with unit normals, in an order that depends on the mesh alone.
struct Points {
    std::vector<core::Vec3> at, normal;
    [[nodiscard]] std::size_t size() const { return at.size(); }
};
/// About one point per spacingMm x spacingMm of surface: the mean of what lies in each cell of that size.
[[nodiscard]] Points spread(const geometry::TriangleMesh& mesh, double spacingMm);

/// Fast Point Feature Histograms (Rusu, Blodow & Beetz 2009): three angles between a point's normal and those around
/// it, 11 bins each; the same wherever the surface lies.
using Feature = std::array<float, 33>;
[[nodiscard]] std::vector<Feature> featuresOf(const Points& points, double radiusMm,
                                              const core::Progress& progress = {});

}  // namespace handpiece::registration
