// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The resolutions of the paper's Table II, and its plane.

#include <cstddef>
#include <span>
#include <string_view>

#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::starter {

/// One row of Table II.
struct PaperResolution {
    std::string_view name;  ///< "6 %"
    std::size_t vertices, faces;
};
/// The five teeth, coarse to fine.
[[nodiscard]] std::span<const PaperResolution> paperResolutions();

inline constexpr PaperResolution kPaperPlane{"plane", 169, 288};

/// The paper's plane: an open sheet of 13 x 13 vertices and 288 faces at z = 0 about the origin, normal +z.
[[nodiscard]] geometry::TriangleMesh makePlane(double edgeMm = 12.0);
/// The same sheet as the top of a closed slab, for methods that need an inside.
[[nodiscard]] geometry::TriangleMesh makePlaneSlab(double edgeMm = 12.0, double thicknessMm = 3.0);

}  // namespace handpiece::starter
