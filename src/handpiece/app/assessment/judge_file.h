// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Work that lies in a file, judged: what `handpiece score` does, for other programs too.

#include <filesystem>
#include <optional>
#include <string>

#include "handpiece/app/assessment/score_work.h"
#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/assess/task/task.h"

namespace handpiece::assessment {

/// The exercise's own rubric, or another by its name or file. Throws core::Error; `where` names the exercise.
[[nodiscard]] rubric::Rubric rubricFor(const tasks::Task& task, const std::string& nameOrFile,
                                       const std::string& where);

struct WorkFile {
    std::filesystem::path work;                     ///< as readWork() takes it, or a scan of a preparation (.stl, .ply)
    std::optional<std::filesystem::path> before{};  ///< an earlier scan, of a scan alone
    double mmPerUnit = 1.0;                         ///< of scans
    bool prove = true;                              ///< cuts sessions again
    bool keep = true;  ///< what was proven and measured is kept in the user's cache, and found there
};
struct JudgedFile {
    Work work;
    Result result;
};
/// The work is read and measured, and judged by a sound rubric. Throws core::Error.
[[nodiscard]] JudgedFile judgeFile(const WorkFile& file, const tasks::Task& task, const rubric::Rubric& rubric,
                                   const core::Progress& progress = {});

}  // namespace handpiece::assessment
