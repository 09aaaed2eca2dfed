// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Stands the border of an open scan on a flat base. Only repair.cpp includes it.

#include <cstdint>
#include <vector>

#include "handpiece/base/geometry/repair.h"

namespace handpiece::geometry {

/// Closes the borders with walls down to a plane and a floor there: of each shell its longest loop, if that goes round
/// as much as the shell's box measures from corner to corner. `depthMm` below the border's lowest place; negative: a
/// twentieth of that diagonal, 1 mm at least and 5 mm at most. Vertices must be manifold and neighbours agree.
/// Throws core::Error where there is no border, or every base would cross the surface.
std::vector<MadeBase> addBases(TriangleMesh& mesh, double depthMm);

}  // namespace handpiece::geometry
