// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Numbers of a preparation as handles in its picture: where each lies on the tooth, and what moving it makes of it.

#include <string_view>
#include <vector>

#include "handpiece/assess/preparation/preparation.h"

namespace handpiece::draft {

/// A place on the border of what a number decides.
struct Handle {
    std::string_view number;  ///< a parameter of the template: "depth_mm"
    core::Vec3 placeMm;       ///< tooth frame
    core::Vec3 way;           ///< unit
    double perMm = 1.0;       ///< what the number gains per millimetre that way; of an angle: how often it counts
    double armMm = 0.0;       ///< of an angle: from the place about which it turns; 0: no angle
};
/// One for each number that has a natural place; `laid`: of this recipe on this tooth.
[[nodiscard]] std::vector<Handle> handlesOf(const cases::Tooth& tooth, const preparation::Recipe& recipe,
                                            const preparation::Laid& laid);
/// What the number becomes when its handle has moved that far its way: on a step of 0.05 mm or half a degree, within
/// what the template allows.
[[nodiscard]] double valueOf(const Handle& handle, const preparation::Recipe& recipe, double movedMm);

}  // namespace handpiece::draft
