// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a scanner adds to what was there: blur, noise, rings, streaks. Private to this room.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/scan/volume/volume.h"

namespace handpiece::phantom {

/// Weights of a sampled normal distribution about the middle, sum 1.
[[nodiscard]] std::vector<double> normalWeights(double sigmaVoxels);
/// Blurs rows and columns of one slice in place; the border's values go on beyond it.
void blurSlice(std::span<float> slice, int columns, int rows, std::span<const double> weights);
/// Blurs across slices in place, in parallel.
void blurAcross(volume::Volume& volume, std::span<const double> weights, const core::Progress& progress);

/// Streaks of one filling, or none.
struct Streaks {
    core::Vec3 centreVoxels;
    double radiusVoxels = 0, halfHeightVoxels = 0;
    double amplitude = 0;  ///< grey values
};
struct Artefacts {
    double noise = 0;  ///< standard deviation, grey values
    double ring = 0;   ///< largest, grey values; about the grid's middle, along k
    std::optional<Streaks> streaks;
    std::uint64_t seed = 1;
    double least = 0, most = 65535;  ///< what the scanner can hold
};
/// Adds them and rounds to whole numbers, in parallel; every voxel by its own random number.
void addArtefacts(volume::Volume& volume, const Artefacts& artefacts, const core::Progress& progress);

}  // namespace handpiece::phantom
