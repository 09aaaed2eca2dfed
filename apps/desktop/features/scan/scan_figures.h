// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a person wants to know of a case that came out of a scan. Any thread, no widgets.

#include <string>
#include <vector>

#include "handpiece/app/scan_case/scan_job.h"
#include "handpiece/model/case/case_check.h"

namespace handpiece::desktop {

/// A thickness, measured from point to nearest point [mm].
struct Thickness {
    bool isKnown = false;
    double leastMm = 0, medianMm = 0, mostMm = 0;
};
struct ScanFigures {
    core::Vec3 sizeMm = core::Vec3::Zero();  ///< mesiodistal, buccolingual, crown to apex
    Thickness enamel;                        ///< over the dentine, where enamel is the outside
    Thickness overPulp;                      ///< from the pulp's surface in the crown to the outside
    std::size_t vertices = 0, faces = 0;     ///< of all surfaces together
    double errorBoundMm = 0;                 ///< of the reduction, the worst surface
    std::vector<cases::CaseFinding> findings;
};
[[nodiscard]] ScanFigures figuresOf(const scan_case::ScanResult& result, const std::vector<cases::Part>& shownParts,
                                    const core::Progress& progress = {});

}  // namespace handpiece::desktop
