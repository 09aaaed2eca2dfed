// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The paper's contact: convex hulls (Quickhull), distance by GJK, penetration by EPA. Feels the hull of the tooth, no cavity.

#include <memory>

#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/tick/contact/method.h"

namespace handpiece::contact {

/// Throws core::Error when either mesh has no volume (flat or fewer than four points).
[[nodiscard]] std::unique_ptr<Method> makeHullMethod(const geometry::TriangleMesh& tooth, const geometry::TriangleMesh& bur,
                                                     tooth::Tissue tissue = tooth::Tissue::enamel);

}  // namespace handpiece::contact
