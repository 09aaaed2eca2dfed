// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A target that a bur can be drawn out of: an outline, walls, a floor.

#include <optional>
#include <vector>

#include "handpiece/assess/zones/outline.h"
#include "handpiece/assess/zones/zones.h"
#include "handpiece/base/geometry/triangle_tree.h"

namespace handpiece::zones {

/// Of a target's frame: +z out of the tooth, along the path of draw.
struct Floor {
    enum class Kind {
        flat,   ///< square to the path of draw, at `heightMm`
        along,  ///< everywhere `depthMm` under the uncut surface, along the path of draw
        near    ///< everywhere `depthMm` under the uncut surface, the shortest way
    };
    Kind kind = Kind::flat;
    double heightMm = 0.0;  ///< of a flat floor, in the target's frame; of the others: nowhere lower
    double depthMm = 0.0;
};

struct Cavity {
    core::Pose inTooth;  ///< of its frame, whose +z is the path of draw
    Outline outline;     ///< at the floor; of a floor that is not flat, at height 0
    Floor floor;
    double wallRad = 0.0;  ///< of the walls against the path of draw: positive opens outwards, negative converges
};

/// All of these together. `whole`: the uncut surface, kept by reference; only floors that follow it ask for it. Throws
/// core::Error for no cavity, an empty outline, a floor that needs the surface where there is none.
[[nodiscard]] TargetFunction targetOf(std::vector<Cavity> cavities, const geometry::TriangleTree* whole);
/// That holds the part of the target which lies between its floors and `topMm` over them in each cavity's frame.
[[nodiscard]] core::Box boundsOf(const std::vector<Cavity>& cavities, double topMm);

}  // namespace handpiece::zones
