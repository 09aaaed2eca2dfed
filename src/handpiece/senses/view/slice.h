// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A tooth as its surfaces have it, cut by a plane. Private to this room.

#include <optional>

#include "handpiece/model/case/case.h"
#include "handpiece/senses/view/renderer.h"

namespace handpiece::view {

/// The tissues of a tooth in a plane of the case's frame. None where the plane does not go through them, or none are
/// known.
[[nodiscard]] std::optional<SectionFace> sliceOf(const cases::PlacedTooth& tooth, const Plane& plane,
                                                 double mmPerPixel);

}  // namespace handpiece::view
