// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// From what somebody did to a score: a session or an attempt, held against its exercise, measured, judged.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/assess/score/score.h"
#include "handpiece/assess/task/task.h"
#include "handpiece/base/core/progress.h"
#include "handpiece/model/tooth/tooth_mirror.h"

namespace handpiece::assessment {

/// What was done, as far as it goes into a score.
struct Work {
    tooth::Teeth teeth;  ///< by their numbers in the exercise's case
    tooth::StateDelta state;
    std::vector<std::string> sessionHashes;  ///< of the files; none of an attempt
    bool isProven = false;                   ///< cut again from its beginning it left this very tooth, bit for bit
    std::string proof;                       ///< in a sentence: that, or why not
    score::Context context;
    std::optional<score::ScanFit> scan{};  ///< of a scan; readScan() makes those
};

/// Of a session (.h5) or an attempt. A session is cut again unless `prove` is false; one that does not come to the same
/// tooth, or is of another engine, is taken from its last key frame and says so. Throws core::Error: neither; work on
/// another tooth than the exercise's, or in another voxel.
[[nodiscard]] Work readWork(const std::filesystem::path& path, const tasks::Task& task, bool prove = true,
                            const core::Progress& progress = {});

using Result = score::Result;
/// The same inputs, the same bits, at any thread count. Throws core::Error for a rubric that is not sound.
[[nodiscard]] Result scoreWork(const Work& work, const tasks::Task& task, const rubric::Rubric& rubric);

}  // namespace handpiece::assessment
