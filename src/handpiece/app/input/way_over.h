// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The way of a lifted instrument from place to place: over tissue, never through it.

#include "handpiece/app/input/hand_feel.h"

namespace handpiece::input {

/// Whether bur and handpiece meet nothing on the straight way, moved and turned evenly: all of it clear, or no less
/// clear than where it begins and ends.
[[nodiscard]] bool isWayFree(HandFeel& feel, const core::Pose& from, const core::Pose& to);

/// The next pose on a way of the bur that is not free: up along `up` (unit), turned, across, down. `to` where no such
/// way is found within reach.
[[nodiscard]] core::Pose nextOnWayOver(HandFeel& feel, const core::Pose& from, const core::Pose& to,
                                       const core::Vec3& up);

}  // namespace handpiece::input
