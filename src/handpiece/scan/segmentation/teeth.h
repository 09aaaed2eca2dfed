// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Which voxels belong to which tooth, coarsely. Private to this room.

#include <vector>

#include "handpiece/scan/segmentation/histogram.h"

namespace handpiece::segmentation {

/// Things that could be teeth in a coarse scan: parted where they touch.
struct CoarseTeeth {
    Coarse coarse;
    std::vector<std::uint32_t> of;           ///< a block: 0 none, else one more than the place in `teeth`
    std::vector<Candidate> teeth;            ///< the largest first
    std::vector<std::uint8_t> hasNeighbour;  ///< touches another one, in the order of `teeth`
};
[[nodiscard]] CoarseTeeth partTeeth(const volume::Volume& volume, const Thresholds& thresholds,
                                    const core::Progress& progress);

}  // namespace handpiece::segmentation
