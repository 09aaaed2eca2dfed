// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The envelope of revolution of a mesh: what a spinning bur sweeps.

#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/model/instrument/profile.h"

namespace handpiece::instrument {

/// Outline of the solid swept by turning the mesh about the z axis: the largest radius at each height.
///
/// A mesh's edges turn into hyperbolas; their upper envelope is followed exactly at every vertex height on both sides
/// and by straight pieces in between, together within kEnvelopeToleranceMm (in stretches of height below a micrometre
/// the chord stands for the envelope). Lowest point at z = 0. Throws core::Error when the radius falls to nothing
/// between the ends.
[[nodiscard]] Profile envelopeOfRevolution(const geometry::TriangleMesh& mesh);
inline constexpr double kEnvelopeToleranceMm = 1e-3;

}  // namespace handpiece::instrument
