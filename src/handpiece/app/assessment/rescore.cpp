// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/assessment/rescore.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/assessment/found_work.h"
#include "handpiece/app/assessment/side_by_side.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/csv_cell.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/case/case_bytes.h"
#include "handpiece/record/session/session_reader.h"

namespace handpiece::assessment {
namespace {

namespace fs = std::filesystem;
using core::csvCell;
using measures::Request;

/// Stands for the hash of an exercise that a piece of work is not held against.
constexpr const char* kOwnCase = "own-case";

bool isSession(const fs::path& path) {
    return path.extension() == ".h5";
}

bool isAttempt(const fs::path& work) {
    return core::isFolder(work) ? cases::isAttempt(work) : !isSession(work);
}

/// The case that a piece of work is of, as an exercise that asks for nothing.
tasks::Task ownTask(const fs::path& work) {
    tasks::Task task;
    if (isAttempt(work)) {
        cases::OpenAttempt open = cases::openAttempt(work);
        task.toothCase = std::move(open.toothCase);
        task.voxelMm = open.attempt.voxelMm;
        return task;
    }
    const fs::path first = core::isFolder(work) ? sessionsIn(work).front() : work;
    const session::SessionReader reader(first);
    task.toothCase = cases::decodeCase(reader.info().tooth, first.string());
    if (!reader.info().scenery.empty()) {
        const cases::Case around = cases::decodeCase(reader.info().scenery, first.string());
        task.toothCase.scenery.insert(task.toothCase.scenery.end(), around.parts.begin(), around.parts.end());
    }
    task.voxelMm = simulation::settingsFromJson(reader.info().settings, first.string()).field.voxelMm;
    return task;
}

/// Measures what is asked and not in the store.
MeasuredWork measureOrFind(const fs::path& work, const std::optional<tasks::Task>& task, const std::string& exercise,
                           std::span<const Request> asked, const MeasureStore& store, const core::Progress& progress,
                           bool& isKept) {
    std::optional<tasks::Task> own;
    StoreKey key{workHash(work), exercise};
    if (!task && isAttempt(work)) {
        // An attempt names its case, which may lie elsewhere and have other landmarks by now; a session holds it.
        own = ownTask(work);
        key.exercise = rubric::hashText(tasks::contentHash(*own));
    }
    std::optional<MeasuredWork> kept = store.find(key);
    std::vector<Request> missing;
    for (const Request& request : asked)
        if (!kept || findMeasured(*kept, request.kind, request.of) == nullptr) missing.push_back(request);
    isKept = kept && missing.empty();
    if (isKept) return std::move(*kept);

    if (!task && !own) own = ownTask(work);
    const tasks::Task& against = task ? *task : *own;
    const core::Progress reading = core::part(progress, 0.0, 0.9), measuring = core::part(progress, 0.9, 1.0);
    if (kept) {
        // Its proof is kept; that it is the same tooth shows that it is the same work.
        const MeasuredWork more = measureWork(readWork(work, against, false, reading), against, missing, measuring);
        if (takeMissing(*kept, more)) {
            store.keep(key, *kept);
            return std::move(*kept);
        }
    }
    MeasuredWork whole = measureWork(readWork(work, against, true, reading), against, asked, measuring);
    store.keep(key, whole);
    return whole;
}

}  // namespace

std::vector<fs::path> worksIn(const fs::path& folder) {
    std::vector<fs::path> works;
    // What cannot be read says so in its row.
    for (const FoundWork& one : findWork(folder))
        if (!one.isResultOnly) works.push_back(one.path);
    if (works.empty())
        throw core::Error("there is nothing to score in it", folder.string(),
                          "sessions (.h5), attempts, folders with the sessions of one piece of work");
    return works;
}

std::vector<Rescored> rescore(std::span<const fs::path> works, const std::optional<tasks::Task>& task,
                              const rubric::Rubric& rubric, const MeasureStore& store, const core::Progress& progress) {
    rubric::requireSound(rubric);
    const std::vector<Request> asked = requestsOf(rubric);
    const std::string exercise = task ? rubric::hashText(tasks::contentHash(*task)) : std::string(kOwnCase);
    std::vector<Rescored> all(works.size());
    const auto scoreOne = [&](std::size_t i, const core::Progress& mine) {
        Rescored& one = all[i];
        one.work = works[i];
        try {
            const MeasuredWork measured = measureOrFind(works[i], task, exercise, asked, store, mine, one.isKept);
            one.result = judge(measured, rubric);
            // Kept measures are told by what they hold, not by what the exercise is called now.
            if (task) one.result->identity.exercise = task->id;
        } catch (const std::exception& e) {
            one.problem = core::asError(e).what();
        }
    };
    eachSideBySide(works.size(), works.size(), progress, scoreOne);
    return all;
}

std::string nameOf(const fs::path& work, std::span<const Rescored> all) {
    fs::path root = work.parent_path();
    for (const Rescored& one : all)
        if (const fs::path its = one.work.parent_path(); its.string().size() < root.string().size()) root = its;
    return work.lexically_relative(root).generic_string();
}

std::string rescoredCsv(std::span<const Rescored> all, const rubric::Rubric& rubric) {
    std::string csv =
        "work,error,proven,proof,sessions,exercise,exercise_hash,case_key,state_hash,device,rubric,"
        "rubric_version,rubric_hash,score,max_score,percent,least_score,most_score,passed,why,borderline,"
        "critical,completeness,completeness +-,completeness factor,completeness not measured";
    for (const rubric::Criterion& c : rubric.criteria)
        csv += fmt::format(",{0},{0} +-,{0} band,{0} points,{0} not measured", c.id);
    csv += '\n';
    for (const Rescored& one : all) {
        csv += csvCell(nameOf(one.work, all)) + "," + csvCell(one.problem);
        if (!one.result) {
            csv += std::string(24 + 5 * rubric.criteria.size(), ',') + "\n";
            continue;
        }
        const score::Identity& of = one.result->identity;
        const score::Assessment& a = one.result->assessment;
        std::string critical;
        for (const score::CriticalError& e : a.critical)
            critical += fmt::format("{}{}{}", critical.empty() ? "" : " ", e.criterion, e.borderline ? "?" : "");
        csv += fmt::format(",{},{},{},{},{},{},{},{},{},{},{},{},{},{:.2f},{},{},{},{},{},{}", of.proven ? "yes" : "no",
                           csvCell(one.result->proof), of.sessionHashes.size(), csvCell(of.exercise), of.exerciseHash,
                           of.caseKey, of.stateHash, csvCell(a.context.device), csvCell(a.rubric),
                           csvCell(a.rubricVersion), rubric::hashText(a.rubricHash), a.score, a.maxScore, a.percent(),
                           a.leastScore, a.mostScore, score::nameOf(a.passed), csvCell(a.why),
                           a.borderline ? "yes" : "no", csvCell(critical));
        const score::Completeness none, &done = a.completeness ? *a.completeness : none;
        csv += done.value ? fmt::format(",{},{},{},", *done.value, done.uncertainty, done.factor)
                          : ",,,," + csvCell(done.reason);
        for (const score::CriterionScore& c : a.criteria)
            csv += fmt::format(",{},{},{},{},{}", c.value ? fmt::format("{}", *c.value) : "",
                               c.value ? fmt::format("{}", c.uncertainty) : "", csvCell(c.band),
                               c.points ? fmt::format("{}", *c.points) : "", csvCell(c.reason));
        csv += '\n';
    }
    return csv;
}

std::string rescoredJson(std::span<const Rescored> all) {
    using Json = nlohmann::ordered_json;
    Json list = Json::array();
    for (const Rescored& one : all) {
        Json row = {{"work", nameOf(one.work, all)}};
        if (one.result)
            row.update(Json::parse(resultJson(one.result->assessment, one.result->identity)));
        else
            row["error"] = one.problem;
        list.push_back(std::move(row));
    }
    return list.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace handpiece::assessment
