// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// From where a place that is shown is looked at.

#include "handpiece/senses/view/camera.h"

namespace handpiece::desktop {

/// Near the place, from about where the work was done and a little out of the cavity's middle, so that walls are seen
/// that hide from straight above. Turned as `worked`, from where one worked, is: a dentist's head is never rolled.
[[nodiscard]] view::Camera lookingAtPlace(const core::Vec3& placeMm, const core::Vec3& draw, const core::Vec3& middleMm,
                                          const view::Camera& worked);

}  // namespace handpiece::desktop
