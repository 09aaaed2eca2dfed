// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How decay is to be taken out: lesion by lesion, from where each lies nearest to the surface, and not into the pulp.

#include <limits>
#include <vector>

#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/model/case/case.h"
#include "handpiece/tick/device/motion.h"
#include "studies/cutting_motion.h"

namespace handpiece::studies {

/// What is to be done about one lesion. Volumes are counts of a grid of a third of the bur's radius.
struct LesionPlan {
    geometry::TriangleMesh mesh;
    core::Vec3 centreMm = core::Vec3::Zero();
    core::Vec3 axis = core::Vec3::UnitZ();                           ///< along which the bur goes in, out of the tooth
    double decayMm3 = 0.0, reachedMm3 = 0.0;                         ///< of the lesion; what of it the path takes
    double soundMm3 = 0.0;                                           ///< what goes with it
    double guardedMm3 = 0.0;                                         ///< decay that stays because the pulp is near
    double nearestPulpMm = std::numeric_limits<double>::infinity();  ///< of the planned floor
};

struct Excavation {
    device::Motion motion;
    std::vector<LesionPlan> lesions;
};

/// The tooth, its bur, its decay and its pulp, for planExcavation(); the station by reference. Without rates.
[[nodiscard]] CuttingScene excavationScene(const simulation::SimulationSetup& station, const cases::Case& toothCase);

/// The way of the hand through all lesions: in along an axis of its own for each, layer by layer in strokes no wider
/// than the decay (wider only where the bur is), out again, round the tooth with the pedal up, and on. With rates the
/// hand presses, by being ahead of where the bur is to go, and waits at each place for as long as the bur needs there.
/// Throws core::Error when there is no decay, or none that the bur can come to.
[[nodiscard]] Excavation planExcavation(const CuttingScene& scene, const CuttingOptions& options = {});

/// What came of one lesion, counted on a grid. Sound tooth that is gone belongs to the lesion that is nearest to it.
struct LesionOutcome {
    double decayMm3 = 0.0, takenMm3 = 0.0, soundMm3 = 0.0;
};
/// From the signed distances to the tooth's surface before the cut and after it.
[[nodiscard]] std::vector<LesionOutcome> lesionOutcomes(const std::vector<LesionPlan>& lesions,
                                                        const core::Box& toothBounds,
                                                        const std::function<double(const core::Vec3&)>& beforeMm,
                                                        const std::function<double(const core::Vec3&)>& afterMm);

}  // namespace handpiece::studies
