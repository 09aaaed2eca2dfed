// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How often a test tries its luck.

#include <algorithm>
#include <cstdlib>

namespace handpiece::test {

/// `few`, or as often as this variable of the environment says (tools/nightly).
inline int times(const char* variable, int few) {
    const char* const text = std::getenv(variable);
    return text ? std::max(1, std::atoi(text)) : few;
}

}  // namespace handpiece::test
