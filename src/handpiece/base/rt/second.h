// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// From nanoseconds of the clock to seconds and milliseconds.

#include <cstdint>

namespace handpiece::rt {

inline constexpr double kNsPerS = 1e9;
inline constexpr std::int64_t kNsPerMs = 1'000'000;

}  // namespace handpiece::rt
