// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// One's own work and the ideal in a section through one place, with how deep both are there.

#include <optional>
#include <string_view>
#include <vector>

#include "handpiece/app/report/bearings.h"
#include "handpiece/model/tooth/tooth_mirror.h"

namespace handpiece::report {

/// In the section's plane [mm], right and up.
struct SectionLine {
    core::Vec2 from, to;
};

/// The place is its origin.
struct PlaceSection {
    core::Vec3 right, up;                         ///< unit, tooth frame; up is from where one works
    double halfMm = 0.0;                          ///< so much is drawn to each side
    double highMm = 0.0;                          ///< and up to so high, twice that in all: the uncut surface is seen
    std::string_view leftSide, rightSide;         ///< of measures::kSides; empty: the tooth has none
    std::vector<SectionLine> before, ideal, own;  ///< the uncut tooth, how it should be, as it was cut
    /// Under the uncut surface, along the way in, where that meets a floor: of one's own and of the ideal; 0 where
    /// nothing was to be cut.
    std::optional<double> ownDeepMm, idealDeepMm;
};

/// Across the wall or the floor at a place (tooth frame); none for one that is not on `own`'s surface. Without an ideal
/// where the task has no preparation. Throws core::Error for one that cannot be laid on. Takes some tenths of a second.
[[nodiscard]] std::optional<PlaceSection> placeSection(const tasks::Task& task, const tooth::ToothMirror& own,
                                                       const Bearings& bearings, const core::Vec3& placeMm);

/// Signed distance from a place to the ideal tooth [mm], negative in it: positive on one's own surface is tissue that
/// should be gone, negative tissue that should be there.
[[nodiscard]] double toIdealMm(const zones::Zones& zones, const geometry::TriangleTree& whole, const core::Vec3& p);

}  // namespace handpiece::report
