// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The page of a piece of work, with its sessions to look through.

#include <string>

#include "handpiece/app/assessment/score_work.h"
#include "handpiece/app/report/assessment_report.h"

namespace handpiece::assessment {

/// report::studentReport; where all sessions of the work are known and still there they are played in their order and
/// are in the page. `isDrawn`: with pictures of them. Throws core::Error as report::reviewOf, "cancelled" when asked to
/// stop.
[[nodiscard]] std::string studentPage(const Work& work, const Result& result, const tasks::Task& task,
                                      const rubric::Rubric& rubric, const report::AssessmentPictures& pictures,
                                      bool isDrawn = true, const core::Progress& progress = {});

}  // namespace handpiece::assessment
