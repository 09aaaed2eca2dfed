// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The other side of sandboxed.h: what the program that is locked in does.

#include "handpiece/base/sandbox/sandbox.h"

namespace handpiece::sandboxed {

/// Of the sessions that come along with something else, all together.
inline constexpr std::size_t kMostCarriedBytes = 320u << 20;

/// sandbox::Work.
[[nodiscard]] sandbox::Answer answer(const std::string& request, const core::Progress& progress);

}  // namespace handpiece::sandboxed
