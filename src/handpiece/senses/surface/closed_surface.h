// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The cut tooth as files want it: one closed mesh of the whole, or of each tissue.

#include "handpiece/base/core/progress.h"
#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/model/field/tissue_map.h"
#include "handpiece/senses/surface/brick_source.h"

namespace handpiece::surface {

/// The whole surface at full detail: closed, oriented, two-manifold; empty when there is none. Islands
/// and bubbles that hold less than one voxel are left out. Where faces would cross, vertices are drawn back into their
/// cells, up to half a voxel, until none do. In parallel, the same bytes at any thread count. Throws
/// core::Error when cancelled.
[[nodiscard]] geometry::TriangleMesh closedSurface(const BrickSource& source, const core::Progress& progress = {});

/// What is left of one tissue: the part of the tooth that `tissues` says is of it. As closedSurface(); where two
/// tissues meet, their surfaces run along each other within rounding of the map.
[[nodiscard]] geometry::TriangleMesh closedPart(const BrickSource& source, const field::TissueMap& tissues,
                                                cases::Tissue tissue, const core::Progress& progress = {});

}  // namespace handpiece::surface
