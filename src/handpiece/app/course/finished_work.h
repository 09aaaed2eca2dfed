// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// From a recording that ended to what its student is shown: the score, one's own tooth and the ideal as surfaces.

#include <filesystem>
#include <memory>
#include <vector>

#include "handpiece/app/assessment/score_work.h"
#include "handpiece/base/core/progress.h"

namespace handpiece::course {

using Parts = std::shared_ptr<const std::vector<cases::Part>>;

/// A piece of work, scored.
struct FinishedWork {
    std::shared_ptr<const tasks::Task> task;
    std::filesystem::path session;
    assessment::Work work;
    rubric::Rubric rubric;
    score::Result result;
    Parts own;
    core::Vec3 draw =
        core::Vec3::UnitZ();  ///< the preparation's path of draw, out of the tooth: from there one sees into it
};

/// Its rubric, sound. Throws core::Error, also for a task that has none.
[[nodiscard]] rubric::Rubric rubricOf(const tasks::Task& task);

/// Cuts the session again, measures and judges it. Throws core::Error; "cancelled" when asked to stop.
[[nodiscard]] FinishedWork finish(const std::filesystem::path& session, std::shared_ptr<const tasks::Task> task,
                                  const core::Progress& progress = {});

/// The tooth as the task asks for it, a surface a tissue. Null: it asks for no preparation. Throws as finish().
[[nodiscard]] Parts idealOf(const tasks::Task& task, const core::Progress& progress = {});

}  // namespace handpiece::course
