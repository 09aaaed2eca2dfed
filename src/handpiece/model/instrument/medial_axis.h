// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The medial axis of a bur: the fewest inscribed balls whose union, linear in between, is the bur.

#include <vector>

#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/instrument/profile.h"

namespace handpiece::instrument {

/// The medial axis of a valid outline: first the curves on the axis, from the tip up, then the sheets.
///
/// Walks along the outline; at each point the largest inscribed ball that touches there is found in closed form (it
/// stops at the axis, at another line or arc, or at a reflex corner). That walk goes round the medial axis, a tree,
/// once: branches are kept on one of their two sides. Balls at the ends of curves and at corners are exact, balls in
/// between lie on the medial axis, as many as kMedialToleranceMm asks for.
[[nodiscard]] std::vector<MedialCurve> medialAxis(const Profile& profile);

}  // namespace handpiece::instrument
