// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How much of which tissue there is.

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>

#include "handpiece/model/case/tissue.h"

namespace handpiece::tooth {

struct ToothModel;

/// Volume by tissue [mm3].
using TissueVolumes = std::array<double, cases::kTissueCount>;

/// Half width of the slope over which a node's voxel counts from full to empty, in voxels.
inline constexpr float kOccupancyHalfWidth = 0.5f;
/// Share of a node's voxel that is tissue, 0..1, from its value: what volumes are sums of, and what a cut counts.
[[nodiscard]] inline float occupancy(float valueMm, float inverseVoxelMm) noexcept {
    return std::clamp(0.5f - valueMm * inverseVoxelMm * (0.5f / kOccupancyHalfWidth), 0.0f, 1.0f);
}

/// Volume by tissue; `valuesOf(dense)` gives a brick's values, null where it is uncut. In parallel, the same bits at
/// any thread count.
[[nodiscard]] TissueVolumes integrateVolumes(const ToothModel& model,
                                             const std::function<const float*(std::uint32_t dense)>& valuesOf);

}  // namespace handpiece::tooth
