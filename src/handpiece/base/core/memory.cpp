// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/memory.h"

#include <cstdlib>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace handpiece::core {

void giveBackFreeMemory() noexcept {
#if defined(__GLIBC__)
    malloc_trim(0);
#endif
}

}  // namespace handpiece::core
