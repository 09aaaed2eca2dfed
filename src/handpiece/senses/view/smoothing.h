// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Edges made smooth in a picture that was read from the renderer: for a software renderer, whose shaders would look at
/// every pixel as at an edge. Private to this room.

#include "handpiece/senses/view/image.h"
#include "handpiece/senses/view/passes.h"

namespace handpiece::view {

/// Pixels that smoothing looks away.
inline constexpr int kSmoothMargin = 8;

/// After FXAA (Lottes 2009), as the shader `smooth` has it, with 8 bits where that has floats: `rect` of `from`, within
/// it, into `out` of the same size. Channels keep their order.
void smoothEdges(const Image& from, const PixelRect& rect, Image& out);

}  // namespace handpiece::view
