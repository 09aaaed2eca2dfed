// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/surface/brick_source.h"

#include <algorithm>

namespace handpiece::surface {

BrickGrid gridOf(const field::FieldView& field) {
    BrickGrid grid;
    grid.originMm = {field.originMm[0], field.originMm[1], field.originMm[2]};
    grid.voxelMm = field.voxelMm;
    std::copy(field.bricks, field.bricks + 3, grid.bricks);
    return grid;
}

const float* FieldSource::values(std::uint32_t dense, float* scratch) const {
    const std::int32_t stored = view_.brickIndex[dense];
    if (stored >= 0) return view_.values + static_cast<std::size_t>(stored) * field::kBrickValues;
    // Far from the surface: only the sign is asked for.
    std::fill(scratch, scratch + field::kBrickValues, view_.coarse[dense]);
    return scratch;
}

}  // namespace handpiece::surface
