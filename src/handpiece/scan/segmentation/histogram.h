// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Peaks of the grey values, and a coarse copy of a scan. Private to this room.

#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/scan/segmentation/segment.h"
#include "handpiece/scan/segmentation/voxels.h"

namespace handpiece::segmentation {

/// The scan in blocks of whole voxels, each the mean of what it holds.
struct Coarse {
    Shape shape;
    std::array<int, 3> factor{1, 1, 1};  ///< voxels of the scan a block, along each axis
    core::Vec3 spacingMm;
    Field values;
    /// Voxel coordinates of the scan at a block's centre.
    [[nodiscard]] core::Vec3 toVoxels(const core::Vec3& block) const {
        core::Vec3 at;
        for (int axis = 0; axis < 3; ++axis) {
            const double f = factor[static_cast<std::size_t>(axis)];
            at[axis] = block[axis] * f + 0.5 * (f - 1);
        }
        return at;
    }
    [[nodiscard]] core::Vec3 fromVoxels(const core::Vec3& voxel) const {
        core::Vec3 at;
        for (int axis = 0; axis < 3; ++axis) {
            const double f = factor[static_cast<std::size_t>(axis)];
            at[axis] = (voxel[axis] - 0.5 * (f - 1)) / f;
        }
        return at;
    }
};
/// Blocks of about `spacingMm`, but no fewer voxels a block than one.
[[nodiscard]] Coarse coarsen(const volume::Volume& volume, double spacingMm, const core::Progress& progress = {});

struct Peak {
    float value = 0;  ///< grey
    double mass = 0;  ///< share of the samples that belong to it
};
/// Peaks of values that are alike their surroundings, the darkest first.
[[nodiscard]] std::vector<Peak> findPeaks(const Shape& shape, const Field& values);

/// The thrown "empty segmentation".
[[nodiscard]] core::Error nothingFound(const std::string& why);

}  // namespace handpiece::segmentation
