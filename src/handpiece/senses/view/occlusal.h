// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How a picture that looks down on a crown is turned: one answer for all of them.

#include "handpiece/base/core/vec.h"

namespace handpiece::view {

/// Up in a picture along -z: lingual. Whoever turns from a buccal or oblique view over the crown, or from that with
/// which exercises begin, has it so; the other way round it would jump by half a turn. `buccalSign` as in cases::Case.
[[nodiscard]] inline core::Vec3 occlusalUp(int buccalSign) {
    return {0.0, buccalSign < 0 ? 1.0 : -1.0, 0.0};
}

}  // namespace handpiece::view
