// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A picture of a stability map: the controller off on the left, on on the right.

#include <string>
#include <vector>

#include "handpiece/tick/loop/stability_map.h"

namespace handpiece::cli {

/// One cell a combination of stiffness, rate (down), hand, friction and delay (across), over all tissues of one motion:
/// blue where every tissue's loop is passive, orange with the number that are not.
[[nodiscard]] std::string stabilitySvg(const loop::StabilitySweep& sweep, const std::vector<loop::StabilityRow>& rows,
                                       loop::LoopMotion motion);

}  // namespace handpiece::cli
