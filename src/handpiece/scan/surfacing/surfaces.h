// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// From a region's solids to closed surfaces that do not cross, at chosen numbers of faces.

#include <array>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/scan/segmentation/segment.h"

namespace handpiece::surfacing {

struct Surface {
    tooth::Tissue tissue = tooth::Tissue::none;  ///< none: the whole tooth
    geometry::TriangleMesh mesh;                 ///< scanner's frame [mm]; closed, manifold, outward
    double errorBoundMm = 0;                     ///< of the decimation
    bool isAuthored = false;
};
/// The whole tooth first, then its tissues in the region's order.
struct Surfaces {
    Surface outer;
    std::vector<Surface> tissues;
    double leastGapMm = 0;  ///< between a nested surface and the one around it; where a tissue reaches the outside it
                            ///< stands out of the tooth by this much instead, and the tooth's own surface bounds it
};

struct Settings {
    bool smooth = true;  ///< without shrinking: the volume is kept to 0.1 %
};
[[nodiscard]] Surfaces makeSurfaces(const segmentation::Region& region, const Settings& settings = {},
                                    const core::Progress& progress = {});

/// The paper's Table II.
inline constexpr std::array<double, 5> kTableTwoPercents{6, 12, 25, 50, 100};
/// All surfaces at a percentage (0..100] of their faces; 100 gives them back.
[[nodiscard]] Surfaces decimated(const Surfaces& full, double percent, const core::Progress& progress = {});
/// All surfaces together at about `faces` faces, the outer one's share by its area.
[[nodiscard]] Surfaces decimatedTo(const Surfaces& full, std::size_t faces, const core::Progress& progress = {});

}  // namespace handpiece::surfacing
