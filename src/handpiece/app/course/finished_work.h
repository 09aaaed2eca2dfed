// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// From a recording that ended to what its student is shown: the score, one's own tooth and the ideal as surfaces.

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "handpiece/app/assessment/score_work.h"
#include "handpiece/app/report/bearings.h"
#include "handpiece/base/core/progress.h"

namespace handpiece::course {

using Parts = std::shared_ptr<const std::vector<cases::Part>>;

/// A piece of work, scored.
struct FinishedWork {
    std::shared_ptr<const tasks::Task> task;
    std::filesystem::path session;  ///< the last of the chain
    assessment::Work work;
    rubric::Rubric rubric;
    score::Result result;
    Parts own;
    report::Bearings bearings;  ///< of its places; along its path of draw one sees into the tooth
};

/// Its rubric, sound. Throws core::Error, also for a task that has none.
[[nodiscard]] rubric::Rubric rubricOf(const tasks::Task& task);

/// Cuts a session, a chain of them or an attempt again, measures and judges it; `own` stays empty. Throws core::Error;
/// "cancelled" when asked to stop.
[[nodiscard]] FinishedWork judged(const std::filesystem::path& work, std::shared_ptr<const tasks::Task> task,
                                  const core::Progress& progress = {});
/// Cuts the sessions again, measures and judges what they left. Throws core::Error; "cancelled" when asked to stop.
[[nodiscard]] FinishedWork finish(std::span<const assessment::ChainLink> chain, std::shared_ptr<const tasks::Task> task,
                                  const core::Progress& progress = {});
/// Of one session, which begins with the whole tooth.
[[nodiscard]] FinishedWork finish(const std::filesystem::path& session, std::shared_ptr<const tasks::Task> task,
                                  const core::Progress& progress = {});

/// A result of before. Where all its sessions are still there, byte for byte, and the task is the one that it was
/// judged by, with the tooth and its recordings; else these are empty, and `session` too. Throws as finish().
[[nodiscard]] FinishedWork reopen(score::Result result, std::span<const assessment::ChainLink> chain,
                                  std::shared_ptr<const tasks::Task> task, const core::Progress& progress = {});

/// What a student says of work that is handed in.
struct HandInWords {
    std::string student;  ///< a code
    std::optional<double> expectedPercent;
    std::string expectedWords;
};
/// One file for a teacher: the tooth, its case, all sessions of the chain, for which exercise (its hash), the result
/// that it got here, and what its student expected. `score` and the marking desk read it as any attempt and judge it
/// anew. Throws core::Error: sessions that are gone or too large together, what cannot be written.
void handIn(const FinishedWork& done, const HandInWords& words, const std::filesystem::path& file);

/// The tooth as the task asks for it, a surface a tissue. Null: it asks for no preparation. Throws as finish().
[[nodiscard]] Parts idealOf(const tasks::Task& task, const core::Progress& progress = {});

}  // namespace handpiece::course
