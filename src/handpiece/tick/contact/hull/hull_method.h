// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The paper's contact: convex hulls (Quickhull), distance by GJK, penetration by EPA. Feels the hull of the tooth, no
/// cavity.

#include <memory>

#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/tick/contact/method.h"

namespace handpiece::contact {

/// The method named "hull": distance and minimal translation of the convex hulls of `tooth` and `bur`.
///
/// Unlike other methods its depthMm is the classical penetration depth when they overlap: moving the bur by
/// depthMm * normal makes the hulls touch. That is never less than Depth's own definition for the same hulls. Apart,
/// both are minus the distance. The tissue is always the one given. No reach: the distance is right however far the bur
/// is. Depths hold to 1e-9 mm whatever was asked before; Status::truncated when EPA's polytope was full (depthMm is
/// then a lower bound). Hulls are built here, off the tick: about 0.1 s for 325,000 faces.
///
/// Throws core::Error when either mesh has no volume (flat or fewer than four points).
[[nodiscard]] std::unique_ptr<Method> makeHullMethod(const geometry::TriangleMesh& tooth,
                                                     const geometry::TriangleMesh& bur,
                                                     cases::Tissue tissue = cases::Tissue::enamel);

}  // namespace handpiece::contact
