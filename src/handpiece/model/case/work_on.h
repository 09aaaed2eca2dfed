// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Which tooth of a mouth is worked on, which others its bur may nick, and its jaws closed and opened.

#include <numbers>

#include "handpiece/model/case/case.h"

namespace handpiece::cases {

/// The same mouth with another of its teeth as the one worked on: its frame becomes the case's, what stood in the old
/// one is moved along, and which others are cuttable is decided anew. An exercise is of its tooth and goes. Throws
/// core::Error when the case has no tooth of that number; as it is when that one is worked on already.
[[nodiscard]] Case workOn(Case toothCase, int fdi);

/// Of the others, those next to the tooth in its arch and those that come within 0.3 mm of it with the jaws closed can
/// be cut; the rest is only felt.
void chooseCuttable(Case& toothCase);

/// The same mouth with its jaws closed, in the frame of its own tooth; what stands around goes with the arch whose
/// teeth it is nearer to. As it is when nothing says how it was opened.
[[nodiscard]] Case inOcclusion(Case toothCase);

// Bonwill's triangle of 4 inches, tipped by Balkwill's angle of 22 degrees [R]: from the lower incisal edges back and
// up to the hinge between the condyles.
inline constexpr double kBonwillHeightMm = 88.0, kBalkwillRad = 22.0 * (std::numbers::pi / 180.0);

/// Where the mandible has gone that turns about a hinge (`left`: unit, to the patient's left) until the incisal edges
/// stand so far apart.
[[nodiscard]] core::Pose openedAbout(const core::Vec3& hingeMm, const core::Vec3& left,
                                     const core::Vec3& upperIncisalMm, const core::Vec3& lowerIncisalMm,
                                     double openingMm);

/// Opens the jaws until the incisal edges stand so far apart [mm], by turning the lower jaw about a hinge where
/// Bonwill's triangle has it. Which way is up and in front is told by the teeth and their FDI numbers; where the front
/// teeth are missing their place is guessed from the others. False, and nothing is moved, where one of the arches is
/// missing or the jaws stand wider open already.
bool openJaws(Case& toothCase, double incisalOpeningMm);

}  // namespace handpiece::cases
