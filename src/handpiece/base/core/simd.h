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
