// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The other side of sandboxed.h: what the program that is locked in does.

#include "handpiece/base/sandbox/sandbox.h"

namespace handpiece::sandboxed {

/// sandbox::Work.
[[nodiscard]] sandbox::Answer answer(const std::string& request, const core::Progress& progress);

}  // namespace handpiece::sandboxed
