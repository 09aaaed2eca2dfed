// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/assessment/judge_file.h"

#include <utility>

#include "handpiece/app/assessment/measure_store.h"
#include "handpiece/app/assessment/scan_work.h"
#include "handpiece/base/core/error.h"

namespace handpiece::assessment {

rubric::Rubric rubricFor(const tasks::Task& task, const std::string& nameOrFile, const std::string& where) {
    if (nameOrFile.empty() && task.rubric.empty())
        throw core::Error("this exercise has no rubric", where,
                          "give one with --rubric: a file, or a name of handpiece rubric show");
    rubric::Rubric judged = nameOrFile.empty() ? rubric::parseRubric(task.rubric, where + "/rubric.toml")
                                               : rubric::rubricByNameOrFile(nameOrFile);
    rubric::requireSound(judged);
    return judged;
}

JudgedFile judgeFile(const WorkFile& file, const tasks::Task& task, const rubric::Rubric& rubric,
                     const core::Progress& progress) {
    const bool isScan = scan_work::isScan(file.work);
    if (file.before && !isScan)
        throw core::Error("an earlier scan belongs to a scan", "--before", "leave it out, or name a scan to judge");
    const bool isKept = !isScan && file.prove && file.keep;
    const auto store = isKept ? MeasureStore::usual() : MeasureStore({});
    StoreKey key;
    if (isKept) key = {workHash(file.work), rubric::hashText(tasks::contentHash(task))};
    JudgedFile judged;
    if (isScan) {
        scan_work::Files files{file.work, {}, file.mmPerUnit};
        if (file.before) files.before = *file.before;
        judged.work = assessment::readScan(files, task, progress);
    } else {
        judged.work = isKept ? readProvenOnce(file.work, task, key, store, progress)
                             : readWork(file.work, task, file.prove, progress);
    }
    const MeasuredWork measured = measureWork(judged.work, task, requestsOf(rubric));
    if (isKept) store.add(key, measured);
    judged.result = judge(measured, rubric);
    return judged;
}

}  // namespace handpiece::assessment
