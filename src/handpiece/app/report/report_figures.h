// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The figures of a session's report: from the record alone, in one pass.

#include <array>
#include <vector>

#include "handpiece/app/simulation/session_player.h"

namespace handpiece::report {

struct SessionFigures {
    double totalS = 0.0, pedalS = 0.0, contactS = 0.0, cuttingS = 0.0;
    double meanForceN = 0.0, p95ForceN = 0.0, peakForceN = 0.0;  ///< of the ticks in contact
    double limitedShare = 0.0;  ///< of the ticks in contact, force at the device's limit
    double meanCuttingRpm = 0.0, mostRpm = 0.0;
    std::uint64_t ticks = 0, missedPeriods = 0;
    std::array<double, cases::kTissueCount> removedMm3{};  ///< at the end
};

/// Reads the whole record by stretches; memory does not grow with it.
[[nodiscard]] SessionFigures figuresOf(const session::SessionReader& reader);

struct EventMark {
    double timeS;
    std::string name;
};
/// A line plot of one member of the points over time as one <svg>, with marks at the events.
[[nodiscard]] std::string timePlot(const std::vector<simulation::PlotPoint>& points,
                                   float simulation::PlotPoint::*value, const std::vector<EventMark>& marks,
                                   const std::string& label, const std::string& unit);

/// For text inside HTML.
[[nodiscard]] std::string escapedText(std::string_view text);
/// Bytes as base64, for a data: address.
[[nodiscard]] std::string base64Of(const std::vector<std::uint8_t>& bytes);

}  // namespace handpiece::report
