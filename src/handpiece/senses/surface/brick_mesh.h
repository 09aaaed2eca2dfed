// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The triangles of one brick, ready for a renderer.

#include <array>
#include <cstdint>
#include <vector>

#include "handpiece/model/case/tissue.h"

namespace handpiece::surface {

struct SurfaceVertex {
    std::array<float, 3> positionMm;  ///< tooth frame
    std::array<float, 3> normal;      ///< unit, out of the tooth; the triangle's own on an edge of the solid
    cases::Tissue tissue;             ///< the same for all three corners of a triangle

    friend bool operator==(const SurfaceVertex&, const SurfaceVertex&) = default;
};

/// Triangles counter-clockwise from outside. Where bricks, levels of detail and tissues meet, positions are the same
/// bits on both sides.
struct BrickMesh {
    std::uint32_t dense = 0;  ///< which brick
    int level = 0;            ///< of detail: 0 fine, 1 and 2 with cells of 2^3 and 4^3 in one
    std::vector<SurfaceVertex> vertices;
    std::vector<std::array<std::uint16_t, 3>> triangles;

    friend bool operator==(const BrickMesh&, const BrickMesh&) = default;
};

}  // namespace handpiece::surface
