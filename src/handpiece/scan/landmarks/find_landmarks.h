// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Landmarks found on a tooth's surfaces by their shape, where it shows them.

#include <optional>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/model/case/case.h"

namespace handpiece::landmarks {

/// In the tooth's own frame, with the source `found`. What a tooth of this FDI number has and where about comes from
/// the dentition's average tooth, laid over this one; where it is, from this surface alone, and what the surface does
/// not show (worn, smooth, noisy, open) is left out. Of a tooth without the number of a permanent one only what goes
/// around it. The cemento-enamel junction needs a dentine part, pulp horns a pulp part. `adjacent`: teeth in the same
/// frame; a contact is where this one comes nearest to them, if it comes near. Deterministic.
[[nodiscard]] std::vector<cases::Landmark> findLandmarks(const cases::Tooth& tooth,
                                                         const std::vector<geometry::TriangleMesh>& adjacent = {},
                                                         const core::Progress& progress = {});
/// How far [rad] a permanent tooth's crown is turned about z, anticlockwise from above, from how one of its FDI number
/// stands in its own frame, by its shape; 0 where it may as well stand as it should. Landmarks of a turned crown are
/// found, and named, as it is turned.
[[nodiscard]] double turnOfCrown(const cases::Tooth& tooth);
/// How a tooth lies, by the average one of its number.
struct Lie {
    core::Pose surfaceInTooth;  ///< from the surface's frame to the tooth's own
    double misfitMm = 0.0;      ///< of the crown, between the two: mean
};
/// Lays the average tooth of a permanent one's FDI number into a closed surface, stretched along its axes, from where
/// `roughly` (the same way) says that it lies; none where the two do not come together. Deterministic.
[[nodiscard]] std::optional<Lie> lieOf(int fdiNumber, const geometry::TriangleMesh& surface, const core::Pose& roughly);
/// Of the tooth that is worked on, beside its adjacent teeth.
[[nodiscard]] std::vector<cases::Landmark> findLandmarks(const cases::Case& toothCase,
                                                         const core::Progress& progress = {});

/// `own` with what was found: what a person set and what is known stays, and what was found before goes.
[[nodiscard]] std::vector<cases::Landmark> withFound(const std::vector<cases::Landmark>& own,
                                                     const std::vector<cases::Landmark>& found);

/// What the average tooth of a permanent one's FDI number has, where it has them. Of other teeth nothing is known.
[[nodiscard]] std::vector<cases::Landmark> expectedLandmarks(int fdiNumber);
/// Of `expected` those of which `own` has none of the same kind and name.
[[nodiscard]] std::vector<cases::Landmark> lackedLandmarks(const std::vector<cases::Landmark>& expected,
                                                           const std::vector<cases::Landmark>& own);

}  // namespace handpiece::landmarks
