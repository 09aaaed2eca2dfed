// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Lanes of float or double in GCC vector extensions: eight floats, and as many doubles as one register holds. For
/// sources built by handpiece_simd_sources alone: everything here has internal linkage, so that no copy compiled for
/// one instruction set is kept for another.

#include <cstdint>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace handpiece::contact {
namespace {

// No wider than a register: GCC takes the comparisons of wider ones lane by lane.
#if defined(__AVX512F__)
constexpr int kDoubleLanes = 8;
#elif defined(__AVX__)
constexpr int kDoubleLanes = 4;
#else
constexpr int kDoubleLanes = 2;
#endif
using Doubles = double __attribute__((vector_size(8 * kDoubleLanes)));
using Longs = long long __attribute__((vector_size(8 * kDoubleLanes)));
using Floats = float __attribute__((vector_size(32)));
using Ints = std::int32_t __attribute__((vector_size(32)));

inline Doubles splat(double x) {
    return Doubles{} + x;
}
inline Floats splatF(float x) {
    return Floats{} + x;
}
inline Doubles choose(Longs mask, Doubles a, Doubles b) {
    return mask ? a : b;
}
inline Doubles least(Doubles a, Doubles b) {
    return a < b ? a : b;
}
inline Doubles most(Doubles a, Doubles b) {
    return a > b ? a : b;
}
inline Floats leastF(Floats a, Floats b) {
    return a < b ? a : b;
}
inline Floats mostF(Floats a, Floats b) {
    return a > b ? a : b;
}
inline Doubles clampTo(Doubles x, Doubles low, Doubles high) {
    return least(most(x, low), high);
}
inline Floats absolute(Floats x) {
    return x < 0.0f ? -x : x;
}

/// Correctly rounded at every level, so the same bits. Negative input counts as zero.
inline Doubles root(Doubles x) {
    x = most(x, Doubles{});
#if defined(__AVX512F__)
    return (Doubles)_mm512_maskz_sqrt_pd(0xff, (__m512d)x);
#elif defined(__AVX__)
    return (Doubles)_mm256_sqrt_pd((__m256d)x);
#elif defined(__SSE2__)
    return (Doubles)_mm_sqrt_pd((__m128d)x);
#else
    for (int i = 0; i < kDoubleLanes; ++i)
        x[i] = __builtin_sqrt(x[i]);
    return x;
#endif
}

/// Lane by lane, built in a register: what is stored by lanes and loaded as a whole stalls.
template <class Of>
inline Doubles gather(const Of& of) {
#if defined(__AVX512F__)
    return Doubles{of(0), of(1), of(2), of(3), of(4), of(5), of(6), of(7)};
#elif defined(__AVX__)
    return Doubles{of(0), of(1), of(2), of(3)};
#else
    return Doubles{of(0), of(1)};
#endif
}

/// Bit i is set where lane i of the mask is.
inline unsigned bitsOfLongs(Longs mask) {
#if defined(__AVX512F__)
    return _mm512_movepi64_mask((__m512i)mask);
#elif defined(__AVX__)
    return static_cast<unsigned>(_mm256_movemask_pd((__m256d)mask));
#elif defined(__SSE2__)
    return static_cast<unsigned>(_mm_movemask_pd((__m128d)mask));
#else
    unsigned bits = 0;
    for (int i = 0; i < kDoubleLanes; ++i)
        bits |= (mask[i] ? 1u : 0u) << i;
    return bits;
#endif
}

inline Floats rootF(Floats x) {
    x = mostF(x, Floats{});
#if defined(__AVX__)
    return (Floats)_mm256_sqrt_ps((__m256)x);
#elif defined(__SSE2__)
    Floats r;
    using Quad = float __attribute__((vector_size(16)));
    for (int i = 0; i < 2; ++i) {
        Quad part;
        __builtin_memcpy(&part, reinterpret_cast<const char*>(&x) + 16 * i, 16);
        part = (Quad)_mm_sqrt_ps((__m128)part);
        __builtin_memcpy(reinterpret_cast<char*>(&r) + 16 * i, &part, 16);
    }
    return r;
#else
    Floats r;
    for (int i = 0; i < 8; ++i)
        r[i] = __builtin_sqrtf(x[i]);
    return r;
#endif
}

/// Bit i is set where lane i of the mask is.
inline unsigned bitsOf(Ints mask) {
#if defined(__AVX__)
    return static_cast<unsigned>(_mm256_movemask_ps((__m256)mask));
#else
    unsigned bits = 0;
    for (int i = 0; i < 8; ++i)
        bits |= (mask[i] ? 1u : 0u) << i;
    return bits;
#endif
}

inline Floats loadFloats(const float* p) {
    Floats v;
    __builtin_memcpy(&v, p, sizeof v);
    return v;
}

}  // namespace
}  // namespace handpiece::contact
