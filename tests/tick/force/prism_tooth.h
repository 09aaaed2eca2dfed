// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Real teeth for the real contact method whose shape is still plain: a polygon in (x, z), drawn along y.

#include <memory>
#include <vector>

#include "handpiece/model/tooth/tooth_model.h"

namespace handpiece::test {

/// Corners counter-clockwise with x to the right and z up; the solid reaches from -halfLength to halfLength in y, then
/// turned by `turn` about the origin. Its field holds exact distances to its triangles.
[[nodiscard]] std::shared_ptr<const tooth::ToothModel> prismTooth(const std::vector<core::Vec2>& corners,
                                                                  double halfLengthMm, double voxelMm,
                                                                  const core::Quat& turn = core::Quat::Identity());

[[nodiscard]] inline std::vector<core::Vec2> slotOutline() {  // 0.7 mm wide, 1.2 deep, top at z = 0
    return {{-1.6, -1.8}, {1.6, -1.8}, {1.6, 0}, {0.35, 0}, {0.35, -1.2}, {-0.35, -1.2}, {-0.35, 0}, {-1.6, 0}};
}
[[nodiscard]] inline std::vector<core::Vec2> veeOutline() {  // opens by 60 degrees, root at the origin
    const double half = 1.2 * 0.57735026918962573;
    return {{-1.3, -0.6}, {1.3, -0.6}, {1.3, 1.2}, {half, 1.2}, {0, 0}, {-half, 1.2}, {-1.3, 1.2}};
}
[[nodiscard]] inline std::vector<core::Vec2> wallOutline() {  // 1.5 mm thick, top at z = 0
    return {{-0.75, -3}, {0.75, -3}, {0.75, 0}, {-0.75, 0}};
}

}  // namespace handpiece::test
