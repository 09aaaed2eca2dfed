// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Lookups of a row of points in the tooth's field, eight at a time. Plain data, compiled once per instruction set.

#include "handpiece/model/tooth/field_view.h"

namespace handpiece::contact {

/// Points centre + cosines[i] x + sines[i] y of the tooth frame; arrays are readable up to a multiple of eight.
struct FieldRow {
    double centre[3], x[3], y[3];
    const double* cosines = nullptr;
    const double* sines = nullptr;
    /// Where no brick is stored the surface is at least this far [mm].
    float farOutMm = 0.0f, farInMm = 0.0f;
};

/// Eight signed distances and the field's gradient there (not of unit length; zero where no brick is stored).
struct FieldEight {
    float distance[8], x[8], y[8], z[8];
    std::uint8_t tissue[8];  ///< of the nearest node; kDeepTissue where no brick is stored
};
inline constexpr std::uint8_t kDeepTissue = 0xff;

struct RingKernels {
    /// Signed distances of points first .. first + 7. Where no brick is stored: the sign, and a bound of the distance.
    void (*distances)(const tooth::FieldView& field, const FieldRow& row, int first, float* out) noexcept;
    void (*gradients)(const tooth::FieldView& field, const FieldRow& row, int first, FieldEight& out) noexcept;
};

namespace simd_base {
RingKernels ringKernels() noexcept;
}
namespace simd_avx2 {
RingKernels ringKernels() noexcept;
}
namespace simd_avx512 {
RingKernels ringKernels() noexcept;
}

}  // namespace handpiece::contact
