// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A scanner for teeth whose truth is known: a case imaged as CBCT or micro-CT would.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "handpiece/base/core/progress.h"
#include "handpiece/model/case/case.h"
#include "handpiece/scan/volume/volume.h"

namespace handpiece::phantom {

enum class Scanner { microCt, cbct };
/// "micro-ct" or "cbct"; throws core::Error naming them.
[[nodiscard]] Scanner scannerByName(std::string_view name);
[[nodiscard]] std::string_view nameOf(Scanner scanner);

struct Settings {
    Scanner scanner = Scanner::microCt;
    double voxelUm = 50;
    double noise = 0.03;                       ///< standard deviation, of the step from outside to enamel
    double blurVoxels = 0.7;                   ///< standard deviation of the point spread
    double ring = 0.0;                         ///< amplitude of rings about the scan's axis, same unit as noise
    double metal = 0.0;                        ///< streaks of a filling, same unit; above 0 a filling is put in
    double marginMm = 1.0;                     ///< air around the tooth
    bool scenery = false;                      ///< neighbours, gum and bone too; the scan then holds the neighbours
    core::Quat turn = core::Quat::Identity();  ///< of the tooth in the scanner
    std::uint64_t seed = 1;
};

/// Settings::noise is of the volume as it comes out: normal, added after the blur, white before a light smoothing of
/// its own (this many voxels), as reconstructions have it: neighbours are correlated by about a quarter.
inline constexpr double kNoiseSpreadVoxels = 0.5;
/// Neighbours in the truth, where volume::Labels has no number.
inline constexpr std::uint8_t kNeighbourLabel = 8;

/// Grey value of the pure tissue; Tissue::none is what surrounds the tooth.
[[nodiscard]] double greyOf(Scanner scanner, cases::Tissue tissue);
/// As volume::Labels numbers it.
[[nodiscard]] std::uint8_t labelOf(cases::Tissue tissue);

/// What the scanner saw, and what was there.
struct Image {
    volume::Volume volume;                                 ///< CBCT: Hounsfield-like; micro-CT: 0..65535; whole numbers
    volume::Labels truth;                                  ///< volume::Labels' numbers by voxel centre, same grid
    core::Pose toothInScan;                                ///< where the case's frame lies in the scanner's
    std::array<double, cases::kTissueCount> volumesMm3{};  ///< of the tooth, each tissue where no other lies on it
    std::optional<cases::Part> filling;                    ///< that was put in, in the tooth's frame
};
/// Throws core::Error for settings out of range, naming the option of `handpiece make scan`.
void check(const Settings& settings);
/// Sharp tissues averaged over each voxel, blurred, with noise; the same bytes at any thread count.
///
/// A point of the tooth is of the part of highest priority that holds it; slits between parts are shared by those
/// beside them. Throws core::Error for settings out of range, a scan that is too large, and surfaces that are open.
[[nodiscard]] Image image(const cases::Case& toothCase, const Settings& settings = {},
                          const core::Progress& progress = {});

/// Image::volumesMm3 of a case, independent of any scan: lengths of some hundred thousand rays through its surfaces.
[[nodiscard]] std::array<double, cases::kTissueCount> volumesMm3(const cases::Case& toothCase,
                                                                 const core::Progress& progress = {});
/// The filling that Settings::metal puts in: in the middle of the biting surface, sunk into it.
[[nodiscard]] cases::Part makeFilling(const cases::Case& toothCase);

}  // namespace handpiece::phantom
