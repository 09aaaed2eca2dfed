// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Own and ideal in one section, as lines. Private to this room.

#include <string>
#include <vector>

#include "handpiece/app/report/place_section.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/senses/measure/tooth_probe.h"

namespace handpiece::report {

struct SectionOutlines {
    core::Box box;                                ///< of the tooth
    core::Vec3 originMm, right, up;               ///< of the plane; unit
    double lowestMm = -1e9, highestMm = 1e9;      ///< along `up`: nothing under or over it is drawn
    geometry::ScalarFunction before, own, ideal;  ///< signed distances; `ideal` may be empty
};
/// Where `f` is zero in the plane, between two corners of it [mm from its origin]; lines lie within 0.02 mm.
[[nodiscard]] std::vector<SectionLine> linesIn(const SectionOutlines& plane, const core::Vec2& low,
                                               const core::Vec2& high, const geometry::ScalarFunction& f);
/// Unit, out of the tooth as it is cut, at a place of its surface; `otherwise` where that has no direction.
[[nodiscard]] core::Vec3 outwardAt(const measure::ToothProbe& probe, double voxelMm, const core::Vec3& placeMm,
                                   const core::Vec3& otherwise);
/// Uncut surface, ideal and own as one <svg>, with a grid of millimetres; lines lie within 0.02 mm.
[[nodiscard]] std::string outlinesSvg(const SectionOutlines& outlines);

}  // namespace handpiece::report
