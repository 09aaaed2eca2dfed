// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A hand that cuts what a task asks for: its way by rows and layers, how steady it is, and the way without the arm.

#include <cstdint>
#include <functional>
#include <memory>

#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/assess/preparation/preparation.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/tick/device/motion.h"

namespace handpiece::studies {

/// Where the bur may be. Distances negative inside, tooth frame [mm].
struct HandScene {
    std::function<double(const core::Vec3&)> asideMm;   ///< to what may go
    std::function<double(const core::Vec3&)> toothMm;   ///< to the uncut tooth
    std::function<double(const core::Vec3&)> othersMm;  ///< to what stands beside it; empty: nothing does
    core::Box box;                                      ///< holds what may go of the tooth
    core::Vec3 draw = core::Vec3::UnitZ();              ///< along which the shank stands
};
struct PlanOptions {
    double cellMm = 0.1;  ///< of the grid that it plans on
    double rowMm = 0.2;   ///< between strokes; a round tip of 0.8 mm leaves ridges of 13 um
    double layerMm = 0.25;
    double feedMmS = 4.0, airMmS = 20.0;
    double clearanceMm = 0.05;  ///< off what stands beside the tooth
};

/// Rows both ways, layer by layer, wherever the whole bur lies in what may go, in the air or in neither, and then along
/// the floor; between them straight through what is free, else out along the shank and in again. The ends of rows are
/// sought to 5 um. Throws core::Error when the bur fits nowhere.
[[nodiscard]] device::Motion planPreparation(const HandScene& scene, const instrument::Bur& bur,
                                             const PlanOptions& options = {});
/// Of a task laid onto its tooth. `others`: distance to the teeth beside it.
[[nodiscard]] HandScene handSceneOf(const preparation::Laid& laid, std::function<double(const core::Vec3&)> others);

/// `motion`, and then down to a place along `draw` from outside, pressed `beyondMm` farther, and out.
[[nodiscard]] device::Motion withPlunge(const device::Motion& motion, const core::Vec3& placeMm, const core::Vec3& draw,
                                        double beyondMm, double fromMm = 25.0);

/// How a hand errs, root mean square along each axis [mm].
struct Steadiness {
    double tremorMm = 0.0;  ///< noise of 8 to 12 Hz, as withTremor()
    double driftMm = 0.0;   ///< and of 0.05 to 0.5 Hz
};
/// The same for the same seed.
[[nodiscard]] device::Motion withUnsteadiness(const device::Motion& motion, const Steadiness& hand, std::uint64_t seed);

/// Cuts the station's teeth with all that the bur sweeps along the motion while the pedal is down: by the engine's own
/// sweeping, without arm, contact, load and time.
void sweep(const simulation::SimulationSetup& station, const device::Motion& motion);

}  // namespace handpiece::studies
