// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A region's solids made ready for meshing: nested, or standing out of the tooth, never grazing it. Private to this
/// room.

#include <vector>

#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/scan/segmentation/segment.h"

namespace handpiece::surfacing {

/// By how much a tissue that reaches the outside stands out of the tooth, for voxels of this size.
[[nodiscard]] double standOutMm(double voxelMm);

/// The distances of solid `index` of the region, in a tooth whose surface lies where `outer` is zero.
[[nodiscard]] std::vector<float> fieldOf(const segmentation::Region& region, std::size_t index,
                                         const std::vector<float>& outer);
/// Takes away what stands out of the tooth by more than standOutMm.
void keepInTooth(std::vector<float>& field, const std::vector<float>& outer, double voxelMm);

/// Evens a field out over about a voxel and moves its level so that as many voxels are inside as before: what joins or
/// divides by less than that goes.
void evenOut(std::vector<float>& field, const std::array<int, 3>& size, double voxelMm);

/// The surface where a field (negative inside, on a grid of `size` nodes `voxelMm` apart from the origin) is zero;
/// vertices found along the grid's edges by cubics, which follow a curved distance where a line cuts it short.
[[nodiscard]] geometry::TriangleMesh fieldSurface(const std::vector<float>& field, const std::array<int, 3>& size,
                                                  double voxelMm, const core::Progress& progress);

/// The field's unit gradients at the vertices of a surface out of it.
[[nodiscard]] std::vector<core::Vec3> fieldNormals(const std::vector<float>& field, const std::array<int, 3>& size,
                                                   double voxelMm, const geometry::TriangleMesh& surface);

/// Whether a surface out of fieldSurface is the staircase of whole voxels.
[[nodiscard]] bool isStaircase(const geometry::TriangleMesh& surface, double voxelMm);

}  // namespace handpiece::surfacing
