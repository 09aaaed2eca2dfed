// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The outline of a preparation, seen along its path of draw.

#include <vector>

#include "handpiece/base/core/vec.h"

namespace handpiece::zones {

/// A shape in a plane [mm]: what strokes of a width cover and what areas hold, less holes.
struct Outline {
    struct Stroke {
        std::vector<core::Vec2> points;  ///< one or more
        double halfWidthMm = 0.5;
        bool isClosed = false;  ///< back to its first point
    };
    std::vector<Stroke> strokes;
    std::vector<std::vector<core::Vec2>> areas, holes;  ///< simple polygons, either way round

    [[nodiscard]] bool isEmpty() const { return strokes.empty() && areas.empty(); }
    /// Signed distance, negative inside: exact outside of everything, inside never more than the true one.
    [[nodiscard]] double distanceMm(const core::Vec2& p) const;
    /// Low and high corner of what it covers, holes not taken out.
    [[nodiscard]] std::pair<core::Vec2, core::Vec2> bounds() const;
};

/// A circle's points, so many that chords lie within a micron of it.
[[nodiscard]] std::vector<core::Vec2> circle(const core::Vec2& centre, double radiusMm);
/// From one angle to another, counter-clockwise where `toRad` is the larger.
[[nodiscard]] std::vector<core::Vec2> arc(const core::Vec2& centre, double radiusMm, double fromRad, double toRad);
/// The convex hull, counter-clockwise.
[[nodiscard]] std::vector<core::Vec2> convexOutline(std::vector<core::Vec2> points);

}  // namespace handpiece::zones
