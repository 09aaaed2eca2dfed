// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Which of a surface's vertices stand out of, or reach into, another surface.

#include <cstdint>
#include <span>
#include <vector>

#include "handpiece/base/geometry/triangle_tree.h"

namespace handpiece::geometry {

/// The indices of the points for which `sign` times the signed distance (negative inside) is above `mostMm`, in their
/// order. Exact: but a distance changes by no more than the way gone, so points beside one that is far from the limit
/// need not be looked up. In parallel; the same at any thread count.
[[nodiscard]] std::vector<std::uint32_t> pointsBeyond(const TriangleTree& tree, std::span<const core::Vec3> points,
                                                      double mostMm, double sign = 1.0);

}  // namespace handpiece::geometry
