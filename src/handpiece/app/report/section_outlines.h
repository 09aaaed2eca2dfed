// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Own and ideal in one section, as lines. Private to this room.

#include <string>

#include "handpiece/base/geometry/isosurface.h"

namespace handpiece::report {

struct SectionOutlines {
    core::Box box;                                ///< of the tooth
    core::Vec3 originMm, right, up;               ///< of the plane; unit
    double lowestMm = -1e9;                       ///< nothing under this height along `up` is drawn
    geometry::ScalarFunction before, own, ideal;  ///< signed distances; `ideal` may be empty
};
/// Uncut surface, ideal and own as one <svg>, with a grid of millimetres; lines lie within 0.02 mm.
[[nodiscard]] std::string outlinesSvg(const SectionOutlines& outlines);

}  // namespace handpiece::report
