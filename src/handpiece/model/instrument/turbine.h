// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A high-speed air-turbine handpiece as a mesh: head, push button, neck, handle with its grip, coupling.

#include "handpiece/base/geometry/triangle_mesh.h"

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

}  // namespace handpiece::instrument
