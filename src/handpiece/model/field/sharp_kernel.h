// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The field between its nodes to third order, with edges kept sharp. Plain data, compiled once per instruction set,
/// the same bits at each. Derivation and errors: docs/contact.md, "Between the nodes".

#include "handpiece/model/field/field_view.h"

namespace handpiece::field {

inline constexpr int kSharpNodes = 6;   ///< nodes along each axis about a cell: 2 before its own two, 2 after
inline constexpr int kSharpStride = 8;  ///< a row of them, with room for whole vectors
inline constexpr int kSharpPlaces = 8;  ///< looked up at a time

/// The nodes about one cell; x fastest.
struct alignas(32) SharpBlock {
    float values[kSharpNodes][kSharpNodes][kSharpStride];  ///< by z, y, x
    /// Each line along z as a polynomial, by y and x: from the value before the cell t first + tt second + ttt third
    /// and, where two parabolas meet in the cell, the other one; `sign` is 1 where the larger counts, -1 where the
    /// smaller does, else 0. Only of a block that is not smooth.
    struct Lines {
        float first[kSharpStride], second[kSharpStride], third[kSharpStride];
        float otherStart[kSharpStride], otherFirst[kSharpStride], otherSecond[kSharpStride], sign[kSharpStride];
    } lines[kSharpNodes];
    bool meets[kSharpNodes];  ///< lines of this y with a sign
    bool isSmooth;            ///< no edge in or beside the cell: one polynomial holds
    float kinkMm;             ///< third and fourth differences below this are no edges
    float bendMm;             ///< second differences of a wall are no larger
};

/// Places in the grid, each with its cell (counted from the grid's origin).
struct alignas(32) SharpPlaces {
    double mm[3][kSharpPlaces];
    std::int32_t cell[3][kSharpPlaces];
    float t[3][kSharpPlaces];  ///< where in it, 0 .. 1
    std::int32_t isInGrid[kSharpPlaces];
    const SharpBlock* block[kSharpPlaces];
};

/// A polynomial at a place: value [mm] and derivatives by voxels.
struct SharpJet {
    float value, slope[3];
    float xx, yy, zz, yz, xz, xy;
};

struct SharpKernels {
    /// Sets cells and places in them from `mm`.
    void (*locate)(const FieldView& field, SharpPlaces& places) noexcept;
    /// Fills the block of a cell. Nodes without a brick count as `farOutMm` outside the tooth, as -`farInMm` in it;
    /// those outside the grid as the nearest in it.
    void (*gather)(const FieldView& field, const std::int32_t (&cell)[3], float farOutMm, float farInMm,
                   SharpBlock& block) noexcept;
    /// Signed distances of those places that have a block; each as if it were asked alone.
    void (*at)(const SharpPlaces& places, float (&out)[kSharpPlaces]) noexcept;
    /// Signed distance at a place of a cell that is asked but once: edges are looked for on its own lines alone.
    float (*once)(const FieldView& field, const std::int32_t (&cell)[3], const float (&t)[3], float farOutMm,
                  float farInMm) noexcept;
    /// Of a smooth block.
    void (*jet)(const SharpBlock& block, const float (&t)[3], SharpJet& out) noexcept;
};

namespace simd_base {
SharpKernels sharpKernels() noexcept;
}
namespace simd_avx2 {
SharpKernels sharpKernels() noexcept;
}
namespace simd_avx512 {
SharpKernels sharpKernels() noexcept;
}

}  // namespace handpiece::field
