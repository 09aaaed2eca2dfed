// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Dual contouring of one brick: a vertex for every sheet of surface in every cell. Private to this room.

#include <array>
#include <cstdint>
#include <vector>

#include "handpiece/model/tooth/tissue.h"
#include "handpiece/senses/surface/brick_source.h"

namespace handpiece::surface {

/// A vertex that stands for one sheet in one cell, or for several where detail is less.
struct SheetVertex {
    std::array<float, 3> positionMm, normal;
    std::uint16_t cell = 0;  ///< x + 8 y + 64 z in its brick
    bool isSharp = false;    ///< on an edge or a corner: it has no one normal
    tooth::Tissue tissue = tooth::Tissue::none;

    friend bool operator==(const SheetVertex&, const SheetVertex&) = default;
};

/// What other bricks and the triangles need of a brick. Depends on the brick's values and on two layers of nodes of the
/// neighbours named by `reach`.
struct BrickContour {
    std::array<std::uint16_t, 81> rows;    ///< row y + 9 z, bit x: node inside
    std::array<std::uint16_t, 512> cases;  ///< number in cellCases(); 0: no surface
    std::array<std::uint16_t, 512> first;  ///< of a cell that the surface passes through: its first vertex
    std::vector<SheetVertex> vertices;     ///< by cell, then by sheet
    std::uint8_t reach = 0;  ///< bit 2 k: depends on the brick below along axis k; 2 k + 1: on the one above

    /// `first` follows from the rest.
    [[nodiscard]] bool isSame(const BrickContour& other) const {
        return rows == other.rows && cases == other.cases && reach == other.reach && vertices == other.vertices;
    }
};

/// False when no surface passes through the brick (then `out` counts for nothing).
bool contourBrick(const BrickSource& source, std::uint32_t dense, BrickContour& out);

}  // namespace handpiece::surface
