// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Dual contouring of one brick: a vertex for every sheet of surface in every cell. Private to this room.

#include <array>
#include <cstdint>
#include <vector>

#include "handpiece/model/case/tissue.h"
#include "handpiece/senses/surface/brick_source.h"

namespace handpiece::surface {

/// A vertex that stands for one sheet in one cell, or for several where detail is less.
struct SheetVertex {
    std::array<float, 3> positionMm, normal;
    std::uint16_t cell = 0;  ///< x + 8 y + 64 z in its brick
    bool isSharp = false;    ///< on an edge or a corner: it has no one normal
    cases::Tissue tissue = cases::Tissue::none;
    /// Of a sharp one: unit, out of the two surfaces that meet in it; zero where they are not told apart.
    std::array<std::array<float, 3>, 2> sides{};

    friend bool operator==(const SheetVertex&, const SheetVertex&) = default;
};

/// Bit x of row y + 9 z: a node of a brick.
using NodeMask = std::array<std::uint16_t, 81>;
/// Bit x of row y + 8 z: a cell of a brick.
using CellMask = std::array<std::uint8_t, 64>;

/// What other bricks and the triangles need of a brick. Depends on the brick's values and on two layers of nodes of the
/// neighbours named by `reach`.
struct BrickContour {
    std::array<std::uint16_t, 81> rows;    ///< row y + 9 z, bit x: node inside
    std::array<std::uint16_t, 512> cases;  ///< number in cellCases(); 0: no surface
    std::array<std::uint16_t, 512> first;  ///< of a cell that the surface passes through: its first vertex
    std::vector<SheetVertex> vertices;     ///< by cell, then by sheet
    std::uint8_t reach = 0;  ///< bit 2 k: depends on the brick below along axis k; 2 k + 1: on the one above
    CellMask kinked;         ///< cells that looked two nodes on from their own; the others looked one on
};

/// Those nodes of a brick that are set, in the order of its values.
[[nodiscard]] NodeMask maskOf(const std::array<bool, field::kBrickValues>& nodes);
/// Cells that ask for the value of a node that has changed: of those changed in the brick itself, and in the six beside
/// it (2 k: below along axis k); null where none has. `kinked`: of the brick's contour; null where it has none.
[[nodiscard]] CellMask cellsThatAsk(const NodeMask* own, const std::array<const NodeMask*, 6>& beside,
                                    const CellMask* kinked);
/// Cells of `mask` through which the surface passes.
[[nodiscard]] bool hasActive(const CellMask& mask, const BrickContour& contour);
/// Who sees that `before` has become `now`. Bit 0: they differ at all; bit s > 0: they differ in a cell that the brick
/// in slot s of neighbours above looks at (bit k of a slot: one brick up along axis k).
[[nodiscard]] std::uint8_t whoSees(const BrickContour& before, const BrickContour& now);

/// False when no surface passes through the brick (then `out` counts for nothing). Where `before` is given it is the
/// brick's contour as it was, and what it has for cells not in `dirty` holds still; only new vertices lack their
/// tissue.
bool contourBrick(const BrickSource& source, std::uint32_t dense, BrickContour& out,
                  const BrickContour* before = nullptr, const CellMask* dirty = nullptr);

}  // namespace handpiece::surface
