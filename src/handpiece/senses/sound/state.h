// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the ear is told: plain data, from samples to sound. Nothing here knows OpenAL.

#include <array>
#include <filesystem>

#include "handpiece/base/core/vec.h"
#include "handpiece/base/messages/haptic_sample.h"
#include "handpiece/model/case/tissue.h"

namespace handpiece::sound {

/// The drill at a moment. Tooth frame, mm.
struct DrillState {
    double speedRpm = 0.0;
    double freeSpeedRpm = 400000.0;              ///< of the drive: pitch and level of the air go with the share of it
    double pedal = 0.0;                          ///< air and water
    double loadTorqueNmm = 0.0;                  ///< on the bur
    double removalMm3S = 0.0;                    ///< all tissues
    cases::Tissue tissue = cases::Tissue::none;  ///< under the bur
    double burRadiusMm = 0.5;
    int edges = 6;
    bool cutting = false, stalled = false;
    bool water = true;
    core::Vec3 positionMm = core::Vec3::Zero();  ///< tip of the bur
    core::Vec3 axis = core::Vec3::UnitZ();       ///< unit, from the tip up the shank, where the motor is
};
/// Of two successive samples; `periodS` of the loop. Water follows the pedal.
[[nodiscard]] DrillState drillStateOf(const messages::HapticSample& before, const messages::HapticSample& now,
                                      double periodS, double burRadiusMm, int edges, double freeSpeedRpm);

/// The listener: the eye of the view. Directions are those of the picture. The picture shows the tooth as a loupe does,
/// so distances count kMagnification times: an eye 72 mm away hears as from 0.36 m, where an operator's head is.
struct Ear {
    core::Vec3 eyeMm{0, -60, 40}, forward{0, 0.832050, -0.554700}, up{0, 0.554700, 0.832050};
};
inline constexpr double kMagnification = 5.0;
/// At this distance of the eye a source has the level it was made with; half of it at twice the distance, and no more
/// than three times of it however near.
inline constexpr double kReferenceMm = 72.0;

/// The paper's sound control and its mixing ratio.
struct Mix {
    double motor = 1.0, cutting = 1.0;  ///< volumes 0..1
    double balance = 0.5;               ///< 0: motor alone, 1: cutting alone, 0.5: both as they are
    bool muted = false;
};

/// Where a source's sound comes from: the synthesis, or a recording that is pitch-shifted by the speed.
struct Recording {
    std::filesystem::path file;  ///< WAV; empty: the synthesis
    double recordedAtRpm = 0.0;  ///< speed at which it was taken; 0: pitch stays
};

}  // namespace handpiece::sound
