// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A picture of a stability map: the controller off on the left, on on the right.

#include <string>
#include <vector>

#include "studies/stability_map.h"

namespace handpiece::studies {

/// One cell a combination of stiffness, rate (down), hand, friction and delay (across), over all tissues of one motion:
/// blue where every tissue's loop is passive, orange with the number that are not.
[[nodiscard]] std::string stabilitySvg(const studies::StabilitySweep& sweep,
                                       const std::vector<studies::StabilityRow>& rows, studies::LoopMotion motion);

}  // namespace handpiece::studies
