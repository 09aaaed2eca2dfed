// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A target that is painted on a tooth: strokes of a round brush, and how deep to go under them.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "handpiece/assess/zones/zones.h"
#include "handpiece/base/config/table.h"
#include "handpiece/base/geometry/triangle_tree.h"

namespace handpiece::preparation {

/// One stroke of the brush over the uncut surface. Later ones win over earlier ones.
struct BrushStroke {
    std::vector<core::Vec3> pointsMm;  ///< on the surface, tooth frame; one or more
    double radiusMm = 0.5;             ///< straight from the middle of the brush
    bool erases = false;
    friend bool operator==(const BrushStroke&, const BrushStroke&) = default;
};

/// Of a whole painting; beyond it is refused before anything is made room for.
inline constexpr std::size_t kMostStrokes = 1000, kMostBrushPoints = 5000;
inline constexpr double kLeastBrushMm = 0.05, kMostBrushMm = 5.0;

/// `[[stroke]]` of a table, and back as `[[prefix.stroke]]`. Throws core::Error with file and line for radii and places
/// out of their range, a stroke without points, too many of either.
[[nodiscard]] std::vector<BrushStroke> readStrokes(const config::Table& table);
[[nodiscard]] std::string strokesToml(std::span<const BrushStroke> strokes, const std::string& prefix = {});

struct Painting {
    zones::TargetFunction target;  ///< walls square to the uncut surface
    core::Box box;                 ///< holds it
    core::Vec3 draw;  ///< of occlusal, buccal, lingual, mesial and distal what the painted surface faces most
};
/// As deep as `depthMm` under what is painted, the shortest way. The brush reaches as far as the surface hangs together
/// within it: not through the tooth, nor over a gap. `whole`: of `mesh`. Throws core::Error for a stroke that does not
/// lie on the tooth, and where nothing is painted.
[[nodiscard]] Painting paintedTarget(std::span<const BrushStroke> strokes, double depthMm, const zones::Leeway& leeway,
                                     const geometry::TriangleMesh& mesh,
                                     std::shared_ptr<const geometry::TriangleTree> whole);

}  // namespace handpiece::preparation
