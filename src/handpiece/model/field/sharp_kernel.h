// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The field between its nodes to third order, with edges kept sharp. Plain data, compiled once per instruction set,
/// the same bits at each. Derivation and errors: docs/contact.md, "Between the nodes".

#include "handpiece/model/field/field_view.h"

namespace handpiece::field {

inline constexpr int kSharpNodes = 6;   ///< nodes along each axis about a cell: 2 before its own two, 2 after
inline constexpr int kSharpStride = 8;  ///< a row of them, with room for whole vectors

/// The nodes about one cell; x fastest.
struct alignas(32) SharpBlock {
    float values[kSharpNodes][kSharpNodes][kSharpStride];
    float kinkMm;  ///< third differences below this are no edges
    float bendMm;  ///< second differences of a wall are no larger
};

struct SharpKernels {
    /// Fills the block of a cell (its first node counted from the grid's origin). Nodes without a brick count as
    /// `farOutMm` outside the tooth, as -`farInMm` in it; those outside the grid as the nearest in it.
    void (*gather)(const FieldView& field, const std::int32_t (&cell)[3], float farOutMm, float farInMm,
                   SharpBlock& block) noexcept;
    /// Signed distance at a place of the cell, 0 <= t <= 1.
    float (*at)(const SharpBlock& block, const float (&t)[3]) noexcept;
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
