// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The inner loop of OffAxisMedialSearch, in plain data so that it can be compiled once per instruction set.

namespace handpiece::contact {

/// Cells of a sheet side by side, in the bur's frame: four corners each, the radius at two and two of them, and what
/// the curved cell stands out of the flat one. A multiple of eight.
struct SheetCells {
    const float *x[4], *y[4], *z[4];
    const float *lowRadius, *highRadius;  ///< at corners 0, 1 and at 2, 3
    float* corner[4];                     ///< bounds of the depth at the corners, linear in between
    float* upper;                         ///< the highest of a cell's four, or below if the cell is done with
    int count;
};
/// The cell that could be deepest; of equals the first.
struct HighestCell {
    float upper;
    int cell;
};
/// A place of the tooth lowers what is left to hope for. No ball is deeper than its radius and its way to that place;
/// with `freeMm`, about a centre that far outside the tooth, less `freeMm`. That is convex: over a flat cell no higher
/// than linear between its corners, and so is every mean of two such bounds. Each cell takes the mean of the old bound
/// and the new whose highest corner is lowest. Cells below `floorMm` are left as they are.
using LowerCells = HighestCell (*)(const SheetCells& cells, const float place[3], float freeMm, float floorMm) noexcept;

namespace simd_base {
LowerCells lowerCells() noexcept;
}
namespace simd_avx2 {
LowerCells lowerCells() noexcept;
}
namespace simd_avx512 {
LowerCells lowerCells() noexcept;
}

}  // namespace handpiece::contact
