// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A preparation beside its ideal, drawn without a window.

#include "handpiece/app/report/assessment_report.h"
#include "handpiece/base/core/progress.h"
#include "handpiece/model/tooth/tooth_mirror.h"

namespace handpiece::report {

struct PictureSettings {
    int width = 360, height = 300;
};

/// `own`: what was cut of `teeth`, by their numbers in the task's case. Ideal and deviation only of a task with a
/// preparation. Without OpenGL it says so in `missing` and has no pictures. Throws core::Error when cancelled.
[[nodiscard]] AssessmentPictures assessmentPictures(const tasks::Task& task, const tooth::Teeth& teeth,
                                                    const tooth::StateDelta& own, const score::Assessment& assessment,
                                                    const rubric::Rubric& rubric, const PictureSettings& settings = {},
                                                    const core::Progress& progress = {});

}  // namespace handpiece::report
