// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How a picture that looks at a crown along its axis is turned: one answer for all of them.

#include "handpiece/base/core/vec.h"
#include "handpiece/senses/view/camera.h"

namespace handpiece::view {

/// Up in a picture along -z: lingual of a lower tooth, buccal of an upper one, as both arches lie in a chart. Whoever
/// turns from a buccal or oblique view to the chewing surface, or from that with which exercises begin, has it so; the
/// other way round it would jump by half a turn.
[[nodiscard]] inline core::Vec3 occlusalUp(const Standing& standing) {
    return {0.0, (standing.buccalSign < 0) != standing.isUpper ? 1.0 : -1.0, 0.0};
}

}  // namespace handpiece::view
