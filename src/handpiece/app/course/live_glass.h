// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What is still to be cut, and what is gone beyond what may go, as surfaces to be seen over the tooth while one works.

#include "handpiece/app/simulation/live_tooth.h"
#include "handpiece/assess/preparation/preparation.h"
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::course {

struct LiveGlass {
    geometry::TriangleMesh left;  ///< of the target, in the tooth
    geometry::TriangleMesh over;  ///< gone beside and under target and leeway: in stripes, told without its colour
};
/// Takes some tenths of a second of this thread and of no other. To a sixth of a millimetre; scores never rest on it.
[[nodiscard]] LiveGlass liveGlass(const preparation::Laid& laid, const simulation::LiveTooth& tooth);

/// Of a surface the stripes that slanting planes cut out of it, as wide as what lies between them.
[[nodiscard]] geometry::TriangleMesh hatched(const geometry::TriangleMesh& mesh, double stripeMm);

}  // namespace handpiece::course
