// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The programs that draw tooth, scenery and instruments. Private to this room.
///
/// The tooth is drawn in two steps, so that each pixel is lit once however many triangles lie over it. The first writes
/// depth and, in four times 16 bits, the normal (half of it plus a half; all halves: lit flat) and a code: kind * 2048
/// + removed depth in 10 um. Kinds are tissues and some more, below.

#include "handpiece/senses/view/gl.h"

namespace handpiece::view {

/// Gingiva with blood on it: the code's lower 11 bits are 64 times how far under its margin (in 0.33 mm), and how thick
/// the blood is (of 0.5 mm, 63 and more: all of that).
inline constexpr int kBloodyKind = 27;
inline constexpr int kInsideKind = 29;  ///< the back of a surface that was cut open
inline constexpr int kGridKind = 30, kEdgeKind = 31;
inline constexpr int kKinds = 32;

struct Shaders {
    Shaders();
    gl::Program surface, clippedSurface, cap, occlusion, occlusionBlur, background, light, fineLight, shadowedLight,
        smooth, burShadow, bur, glassBur, turbine, glassTurbine, ghost;
};

}  // namespace handpiece::view
