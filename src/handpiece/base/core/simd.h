// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Which instruction set this processor runs. Sources built by handpiece_simd_sources() exist once per level in the
/// namespaces simd_base, simd_avx2 and simd_avx512 and give the same bits; a caller picks one when it is constructed.

namespace handpiece::core {

enum class SimdLevel { base = 0, avx2 = 2, avx512 = 3 };

/// The best level of this machine, or what the environment variable HANDPIECE_SIMD (base, avx2, avx512) lowers it to.
/// Read once; not for the tick.
[[nodiscard]] SimdLevel simdLevel();

}  // namespace handpiece::core

/// The one of three functions of the same name, in simd_base, simd_avx2 and simd_avx512 beside the caller, that is for
/// a level. Elsewhere than on x86 there is the first alone.
#if defined(__x86_64__)
#define HANDPIECE_AT_SIMD_LEVEL(level, function)                             \
    ((level) == ::handpiece::core::SimdLevel::avx512 ? simd_avx512::function \
     : (level) == ::handpiece::core::SimdLevel::avx2 ? simd_avx2::function   \
                                                     : simd_base::function)
#else
#define HANDPIECE_AT_SIMD_LEVEL(level, function) (static_cast<void>(level), simd_base::function)
#endif
