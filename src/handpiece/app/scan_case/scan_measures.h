// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How thick, how large and how good: the figures of a scanned case's report.

#include <optional>
#include <string>
#include <vector>

#include "handpiece/app/scan_case/scan_job.h"
#include "handpiece/base/core/progress.h"

namespace handpiece::scan_case {

/// Of many places, by their nearest distance to the next tissue [mm].
struct Thickness {
    double leastMm = 0.0, medianMm = 0.0, mostMm = 0.0;
    std::size_t places = 0;
    core::Vec3 leastAtMm = core::Vec3::Zero();  ///< tooth frame
};
/// One surface of one resolution.
struct SurfaceQuality {
    std::string name;
    double percent = 100.0;
    std::size_t vertices = 0, faces = 0, shells = 0, openEdges = 0, nonManifoldEdges = 0, crossings = 0;
    std::optional<std::int64_t> genus;
    double volumeMm3 = 0.0, areaMm2 = 0.0, errorBoundMm = 0.0;
    bool isClosed = false;
};
struct ScanMeasures {
    std::array<double, cases::kTissueCount> volumesMm3{};
    double toothMm3 = 0.0;
    core::Vec3 sizeMm = core::Vec3::Zero();  ///< tooth frame: mesial, buccal, occlusal
    double crownMm = 0.0;                    ///< from the neck to the highest cusp
    /// Of the enamel: the upper third of the crown where it looks up, and its sides between neck and that.
    std::optional<Thickness> enamelTop, enamelSides;
    std::optional<Thickness> dentineOverPulp;  ///< from the pulp's surface in the crown to the dentine's
    double scanVoxelMm = 0.0, voxelMm = 0.0, blurMm = 0.0, noise = 0.0;
    /// Noise over the step from dentine to enamel; 0 for labels.
    double noiseShare = 0.0;
    std::vector<SurfaceQuality> surfaces;
};

/// Of a finished result. The same at any thread count.
[[nodiscard]] ScanMeasures measure(const ScanResult& result, const core::Progress& progress = {});
/// What this scan cannot show, as plain sentences.
[[nodiscard]] std::vector<std::string> limitsOf(const ScanResult& result, const ScanMeasures& measures);

}  // namespace handpiece::scan_case
