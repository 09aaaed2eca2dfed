// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The programs that draw tooth, scenery and instruments. Private to this room.
///
/// The tooth is drawn in two steps, so that each pixel is lit once however many triangles lie over it. The first writes
/// depth and, in four times 16 bits, the normal (half of it plus a half; all halves: lit flat) and a code: kind * 2048
/// + removed depth in 10 um. Kinds are tissues and some more, below. Where a scan's colours are to be seen, they go
/// into a texture of their own: each channel and how much of it there is, 0 where the surface is none that was scanned.

#include <memory>

#include "handpiece/senses/view/gl.h"

namespace handpiece::view {

inline constexpr int kInsideKind = 29;  ///< the back of a surface that was cut open
inline constexpr int kGridKind = 30, kEdgeKind = 31;
inline constexpr int kKinds = 32;

/// Those that know a scan's colours: made when the first are to be seen.
struct ScannedShaders {
    ScannedShaders();
    gl::Program surface, clippedSurface, light, fineLight, shadowedLight;
};

struct Shaders {
    Shaders();
    [[nodiscard]] ScannedShaders& scanned() {
        if (!scanned_) scanned_ = std::make_unique<ScannedShaders>();
        return *scanned_;
    }
    gl::Program surface, clippedSurface, cap, occlusion, occlusionBlur, background, light, fineLight, shadowedLight,
        smooth, burShadow, bur, glassBur, turbine, glassTurbine, ghost;

  private:
    std::unique_ptr<ScannedShaders> scanned_;
};

}  // namespace handpiece::view
