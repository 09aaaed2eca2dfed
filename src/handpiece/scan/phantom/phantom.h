// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A scanner for teeth whose truth is known: a case imaged as CBCT or micro-CT would.

#include <cstdint>
#include <string>

#include "handpiece/base/core/progress.h"
#include "handpiece/model/tooth/tooth.h"
#include "handpiece/scan/volume/volume.h"

namespace handpiece::phantom {

enum class Scanner { microCt, cbct };

struct Settings {
    Scanner scanner = Scanner::microCt;
    double voxelUm = 50;
    double noise = 0.03;                       ///< standard deviation, of the step from outside to enamel
    double blurVoxels = 0.7;                   ///< standard deviation of the point spread
    double ring = 0.0;                         ///< amplitude of rings about the scan's axis, same unit as noise
    double metal = 0.0;                        ///< streaks of a filling, same unit; above 0 a filling is put in
    double marginMm = 1.0;                     ///< air around the tooth
    bool scenery = false;                      ///< neighbours, gum and bone too
    core::Quat turn = core::Quat::Identity();  ///< of the tooth in the scanner
    std::uint64_t seed = 1;
};

/// What the scanner saw, and what was there.
struct Image {
    volume::Volume volume;                                 ///< CBCT: Hounsfield-like; micro-CT: 0..65535
    volume::Labels truth;                                  ///< volume::Labels' numbers by voxel centre, same grid
    core::Pose toothInScan;                                ///< where the case's frame lies in the scanner's
    std::array<double, tooth::kTissueCount> volumesMm3{};  ///< of the case's own surfaces
};
/// Sharp tissues sampled below the voxel, blurred, with noise; the same bytes at any thread count.
[[nodiscard]] Image image(const tooth::Case& toothCase, const Settings& settings = {},
                          const core::Progress& progress = {});

}  // namespace handpiece::phantom
