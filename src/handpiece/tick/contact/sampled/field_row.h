// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Lookups of a row of points in the tooth's field, eight at a time. Plain data, compiled once per instruction set.

#include "handpiece/model/field/field_view.h"

namespace handpiece::contact {

/// Points centre + cosines[i] x + sines[i] y of the tooth frame; arrays are readable up to a multiple of eight.
struct FieldRow {
    double centre[3], x[3], y[3];
    const double* cosines = nullptr;
    const double* sines = nullptr;
    /// Where no brick is stored the surface is at least this far [mm].
    float farOutMm = 0.0f, farInMm = 0.0f;
};

/// Signed distances of points first .. first + 7. Where no brick is stored: a lower bound of the distance, signed, and
/// kBoundMm further from zero.
inline constexpr float kBoundMm = 1024.0f;
using FieldLookup = void (*)(const field::FieldView& field, const FieldRow& row, int first, float* out) noexcept;

namespace simd_base {
FieldLookup fieldLookup() noexcept;
}
namespace simd_avx2 {
FieldLookup fieldLookup() noexcept;
}
namespace simd_avx512 {
FieldLookup fieldLookup() noexcept;
}

}  // namespace handpiece::contact
