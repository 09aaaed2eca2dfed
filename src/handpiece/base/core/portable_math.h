// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Sine and its kin with the same bits on every machine. The C library's differ from one library, version and processor
/// to the next, so whatever a hash, a mesh, a table, a force or a score rests on takes these (tools/check_math.py).
/// They are made of + - * / and sqrt, which IEEE 754 rounds exactly, and of integers. What `<cmath>` has that is exact
/// may be used beside them: sqrt, floor, ceil, trunc, round, lround, nearbyint, fmod, fma, abs, copysign, ldexp, frexp.
///
/// Errors are in units of the last place of the exact result, held against MPFR by portable_math_test. Special values
/// are those of C. Results below the smallest normal number are within one unit.

#include <cfloat>
#include <cmath>

#include "handpiece/base/core/realtime.h"

namespace handpiece::core {

static_assert(FLT_EVAL_METHOD == 0, "doubles must be computed as doubles: -msse2 -mfpmath=sse on 32-bit x86");

/// Within 0.8 units, the tangent within 1.1, of any finite angle, however large.
[[nodiscard]] double sin(double rad) noexcept HANDPIECE_REALTIME;
[[nodiscard]] double cos(double rad) noexcept HANDPIECE_REALTIME;
[[nodiscard]] double tan(double rad) noexcept HANDPIECE_REALTIME;
/// Within 0.51 units.
[[nodiscard]] double acos(double x) noexcept HANDPIECE_REALTIME;
[[nodiscard]] double atan(double x) noexcept HANDPIECE_REALTIME;
[[nodiscard]] double atan2(double y, double x) noexcept HANDPIECE_REALTIME;
/// Within 0.55 units.
[[nodiscard]] double exp(double x) noexcept HANDPIECE_REALTIME;
/// Within 0.51 units.
[[nodiscard]] double log(double x) noexcept HANDPIECE_REALTIME;
/// Within 0.65 units.
[[nodiscard]] double pow(double x, double y) noexcept HANDPIECE_REALTIME;
/// sqrt(x^2 + y^2 + z^2) where squares overflow or vanish; for hypot() alone.
[[nodiscard]] double scaledHypot(double x, double y, double z) noexcept HANDPIECE_REALTIME;

/// Within 1.5 units; of three sides within 2.
[[nodiscard]] inline double hypot(double x, double y, double z = 0.0) noexcept HANDPIECE_REALTIME {
    const double squared = x * x + y * y + z * z;
    return squared > 0x1p-900 && squared < 0x1p1000 ? std::sqrt(squared) : scaledHypot(x, y, z);
}

}  // namespace handpiece::core
