// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How an exercise begins, as a camera.

#include "handpiece/model/case/exercise.h"
#include "handpiece/senses/view/camera.h"

namespace handpiece::desktop {

/// `camera`, but looking as the exercise has it.
[[nodiscard]] inline view::Camera lookingAs(view::Camera camera, const cases::View& start) {
    camera.eyeMm = start.eyeMm;
    camera.targetMm = start.targetMm;
    camera.up = start.up;
    return camera;
}

}  // namespace handpiece::desktop
