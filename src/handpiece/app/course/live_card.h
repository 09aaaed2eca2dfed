// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The numbers that will be judged, while one works, taken as the score takes them.

#include <optional>
#include <string>
#include <vector>

#include "handpiece/app/report/wanted.h"
#include "handpiece/app/simulation/live_tooth.h"
#include "handpiece/assess/task/task.h"

namespace handpiece::course {

struct LiveValue {
    std::string criterion, unit;
    std::optional<double> value;  ///< none: it cannot be taken yet
    report::Wanted wanted;
    report::Off off = report::Off::no;
};
/// Of the criteria of a rubric that are lengths and angles of the tooth, in its order; volumes and what is hidden from
/// a dentist (what is left over the pulp) are not among them. Takes a second or so of this thread and of no other.
[[nodiscard]] std::vector<LiveValue> liveValues(const tasks::Task& task, const rubric::Rubric& rubric,
                                                const preparation::Laid& laid, const simulation::LiveTooth& tooth);

}  // namespace handpiece::course
