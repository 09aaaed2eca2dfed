// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The ways that the bur takes over the tooth in the benchmarks.

#include <vector>

#include "handpiece/base/core/vec.h"
#include "query.h"

namespace handpiece::bench {

enum class Way {
    hover,  ///< 1.0 mm clear of the tooth, 22 mm long
    touch,  ///< depth swinging between 0.05 and 0.5 mm, 24 mm long, over cusps and fissures
    deep,   ///< the same way, 1.0 mm deep
};

/// `ticks` poses (4,000 at 1 kHz: 6 um a tick) of equal spacing along the way, the bur tilted by 15 degrees.
///
/// `surface` tells the depth by which the way is found; `tooth` is only asked where the crown lies (its occlusal 2.5
/// mm).
[[nodiscard]] std::vector<core::Pose> makeTrajectory(Way way, Query& surface, const geometry::TriangleMesh& tooth,
                                                     int ticks);

}  // namespace handpiece::bench
