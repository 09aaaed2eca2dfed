// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Lips and cheeks: felt, and in pictures as if held aside.

#include <algorithm>
#include <array>
#include <string_view>

#include "handpiece/model/case/case.h"

namespace handpiece::cases {

/// The names of such parts of the scenery.
inline constexpr std::array<std::string_view, 4> kHeldAside = {"left-cheek", "right-cheek", "upper-lip", "lower-lip"};
[[nodiscard]] inline bool isHeldAside(const Part& part) {
    return std::find(kHeldAside.begin(), kHeldAside.end(), part.name) != kHeldAside.end();
}

}  // namespace handpiece::cases
