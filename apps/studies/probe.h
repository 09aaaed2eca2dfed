// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How a list of poses is probed.

#include <cstddef>

namespace handpiece::studies {

/// A method forgets its warm start before each stretch of so many poses: answers hang on the list alone, not on how
/// many methods and threads share it.
inline constexpr std::size_t kProbeStretch = 64;

}  // namespace handpiece::studies
