// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/assessment/student_page.h"

#include <algorithm>
#include <vector>

#include "handpiece/app/report/review.h"
#include "handpiece/base/core/file.h"

namespace handpiece::assessment {

std::string studentPage(const Work& work, const Result& result, const tasks::Task& task, const rubric::Rubric& rubric,
                        const report::AssessmentPictures& pictures, bool isDrawn, const core::Progress& progress) {
    std::vector<report::Reviewed> chain;
    for (const Recording& one : work.recordings)
        // Its file's name alone: a page goes to others, and folders are their owner's.
        chain.push_back({one.path, one.path.filename().string(), one.untilTick});
    const bool isKept =
        std::all_of(chain.begin(), chain.end(), [](const report::Reviewed& one) { return core::isThere(one.path); });
    if (chain.empty() || !isKept) return report::studentReport(result, task, rubric, pictures);
    return report::studentReport(result, task, rubric, pictures, [&](std::size_t mostBytes) {
        return report::reviewOf(chain, task.toothCase.name, {&task, &result, &rubric}, isDrawn, mostBytes, progress);
    });
}

}  // namespace handpiece::assessment
