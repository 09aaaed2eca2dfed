// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The figures of a session's report: from the record alone, in one pass.

#include <array>
#include <map>
#include <vector>

#include "handpiece/app/simulation/session_player.h"

namespace handpiece::report {

struct SessionFigures {
    double totalS = 0.0, pedalS = 0.0, contactS = 0.0, cuttingS = 0.0;
    double byMirrorS = 0.0, fingerRestS = 0.0;                   ///< as `working way` events tell
    std::map<int, double> atHourS;                               ///< by the operator's hour; none where none was chosen
    double meanForceN = 0.0, p95ForceN = 0.0, peakForceN = 0.0;  ///< of the ticks in contact
    double limitedShare = 0.0;  ///< of the ticks in contact, force at the device's limit
    double meanCuttingRpm = 0.0, mostRpm = 0.0;
    std::uint64_t ticks = 0, missedPeriods = 0;
    std::array<double, cases::kTissueCount> removedMm3{};  ///< at the end
};

/// Reads the whole record by stretches; memory does not grow with it.
[[nodiscard]] SessionFigures figuresOf(const session::SessionReader& reader);

}  // namespace handpiece::report
