// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A high-speed air-turbine handpiece as a mesh: head, push button, neck, handle with its grip, coupling.

#include <memory>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/model/instrument/body_part.h"
#include "handpiece/model/instrument/bur.h"

namespace handpiece::instrument {

/// How far a bur's tip stands out of the head [mm]: about that of a standard 21 mm friction-grip bur [R].
inline constexpr double kBurReachMm = 9.0;

/// The handpiece that holds a bur, in that bur's frame: tip of the bur at the origin, shank along +z into the head,
/// whose lower face is at z = `burReachMm`; the handle runs along +x and rises away from the teeth.
///
/// Of the complexity of the paper's (Table I: 11,458 vertices, 20,988 faces) within 1 %. A closed surface of so many
/// faces has only half as many vertices, plus two for each part, so the paper's had open or doubled seams; this one is
/// made of closed outward parts throughout, most of them the raised points of the grip, and its counts survive an STL
/// file. Throws core::Error unless burReachMm is finite.
[[nodiscard]] geometry::TriangleMesh turbineMesh(double burReachMm = kBurReachMm);

/// A convex piece of the instrument behind the bur: a solid of revolution about its own z axis, and where that lies.
struct BodyPiece {
    std::shared_ptr<const Bur> solid;
    core::Pose inBur;  ///< the piece's frame in the bur's
    BodyPart part = BodyPart::shank;
};
/// What can touch behind this bur: its shank (as it is drawn: a neck that widens; none when the bur itself reaches into
/// the head), the head, neck and handle. They cover turbineMesh() but for its grip's points, ports and coupling to
/// within kBodyToleranceMm, and stand out of it by no more than kBodyExcessMm, where the drawn head is not convex.
[[nodiscard]] std::vector<BodyPiece> bodyPieces(const Bur& bur, double burReachMm = kBurReachMm);
inline constexpr double kBodyToleranceMm = 0.15, kBodyExcessMm = 0.8;

}  // namespace handpiece::instrument
