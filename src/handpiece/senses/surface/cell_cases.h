// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How many sheets of surface pass through a cell, and which of its edges each of them crosses. Private to this room.

#include <array>
#include <cstdint>

namespace handpiece::surface {

inline constexpr std::uint8_t kNoSheet = 0xff;

/// A cell's corners are numbered x + 2 y + 4 z, its faces 2 a (low along axis a) and 2 a + 1. Edge 4 a + du + 2 dw runs
/// along axis a from the corner at du along axis (a + 1) % 3 and dw along axis (a + 2) % 3. A case has bit c for every
/// corner inside, and bit 8 + f for every face whose two inside corners, diagonal to each other, are joined across it.
struct CellCase {
    std::uint8_t sheets = 0;  ///< 0 to 4
    std::uint8_t edgeCount = 0;
    std::array<std::uint8_t, 12> edges{};    ///< those crossed, rising
    std::array<std::uint8_t, 12> sheetOf{};  ///< of each edge; kNoSheet when not crossed
};
inline constexpr std::size_t kCellCases = 1u << 14;
[[nodiscard]] const std::array<CellCase, kCellCases>& cellCases();

/// Faces of the first 256 cases where the inside corners are diagonal to each other.
[[nodiscard]] const std::array<std::uint8_t, 256>& ambiguousFaces();
/// Of the first 256 cases those with one sheet and no such face.
[[nodiscard]] const std::array<bool, 256>& plainCases();
/// Corners of a face in turn.
[[nodiscard]] constexpr std::array<int, 4> faceCorners(int face) {
    const int axis = face / 2, at = (face & 1) << axis, u = 1 << ((axis + 1) % 3), w = 1 << ((axis + 2) % 3);
    return {at, at | u, at | u | w, at | w};
}

/// Corner at which an edge begins.
[[nodiscard]] constexpr int edgeCorner(int edge) {
    const int a = edge / 4, u = (a + 1) % 3, w = (a + 2) % 3;
    return (edge & 1) << u | (edge >> 1 & 1) << w;
}

}  // namespace handpiece::surface
