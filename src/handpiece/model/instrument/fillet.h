// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A bur with its sharp edges rounded off: no grid of voxels holds a sharp inner corner, so none is felt with one.

#include "handpiece/model/instrument/bur.h"

namespace handpiece::instrument {

/// The bur with every convex corner of its outline that turns by more than kFilletCornerRad rounded by an arc of
/// `radiusMm`, or of what room there is: an opening of the bur by a ball, lying wholly in it. Corners on the axis and
/// blunter ones stay. The same bur when there is nothing to round.
[[nodiscard]] Bur filleted(const Bur& bur, double radiusMm);
inline constexpr double kFilletCornerRad = 0.35;

}  // namespace handpiece::instrument
