// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The programs that draw tooth, scenery and instruments. Private to this room.
///
/// The tooth is drawn in two steps, so that each pixel is lit once however many triangles lie over it. The first writes
/// depth and, in four times 16 bits, the normal (half of it plus a half; all halves: lit flat) and a code: kind * 4096
/// + removed depth in 5 um. Kinds are tissues and some more, below.

#include "handpiece/senses/view/gl.h"

namespace handpiece::view {

inline constexpr int kInsideKind = 10;  ///< the back of a surface that was cut open
inline constexpr int kGridKind = 11, kEdgeKind = 12;
inline constexpr int kKinds = 16;

struct Shaders {
    Shaders();
    gl::Program surface, clippedSurface, cap, occlusion, occlusionBlur, background, light, fineLight, shadowedLight,
        smooth, burShadow, bur, glassBur, turbine, glassTurbine, ghost;
};

}  // namespace handpiece::view
