// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/simd.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace handpiece::core {
namespace {

SimdLevel detect() {
    SimdLevel best = SimdLevel::base;
#if defined(__x86_64__) && defined(__GNUC__)
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx2")) best = SimdLevel::avx2;
    if (best == SimdLevel::avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw"))
        best = SimdLevel::avx512;
#endif
    if (const char* asked = std::getenv("HANDPIECE_SIMD")) {
        const std::string_view name(asked);
        const SimdLevel cap = name == "base" ? SimdLevel::base : name == "avx2" ? SimdLevel::avx2 : SimdLevel::avx512;
        best = std::min(best, cap);
    }
    return best;
}

}  // namespace

SimdLevel simdLevel() {
    static const SimdLevel level = detect();
    return level;
}

}  // namespace handpiece::core
