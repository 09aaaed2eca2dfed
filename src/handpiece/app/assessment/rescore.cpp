// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/assessment/rescore.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/case/case_bytes.h"
#include "handpiece/record/session/session_reader.h"

namespace handpiece::assessment {
namespace {

namespace fs = std::filesystem;
using measures::Measured;
using measures::Request;

/// Stands for the hash of an exercise that a piece of work is not held against.
constexpr const char* kOwnCase = "own-case";

bool isSession(const fs::path& path) {
    return path.extension() == ".h5";
}

/// The case that a piece of work is of, as an exercise that asks for nothing.
tasks::Task ownTask(const fs::path& work) {
    tasks::Task task;
    if (core::isFolder(work) ? cases::isAttempt(work) : !isSession(work)) {
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

const Measured* find(const MeasuredWork& in, const Request& request) {
    const auto at = std::find_if(in.measured.begin(), in.measured.end(),
                                 [&](const Measured& m) { return m.kind == request.kind && m.of == request.of; });
    return at == in.measured.end() ? nullptr : &*at;
}

/// Measures what is asked and not in the store.
MeasuredWork measureOrFind(const fs::path& work, const std::optional<tasks::Task>& task, const std::string& exercise,
                           std::span<const Request> asked, const MeasureStore& store, const core::Progress& progress,
                           bool& isKept) {
    const StoreKey key{workHash(work), exercise};
    std::optional<MeasuredWork> kept = store.find(key);
    std::vector<Request> missing;
    for (const Request& request : asked)
        if (!kept || find(*kept, request) == nullptr) missing.push_back(request);
    isKept = kept && missing.empty();
    if (isKept) return std::move(*kept);

    const std::optional<tasks::Task> own = task ? std::nullopt : std::optional(ownTask(work));
    const tasks::Task& against = task ? *task : *own;
    const core::Progress reading = core::part(progress, 0.0, 0.9), measuring = core::part(progress, 0.9, 1.0);
    if (kept) {
        // Its proof is kept; that it is the same tooth shows that it is the same work.
        const MeasuredWork more = measureWork(readWork(work, against, false, reading), against, missing, measuring);
        if (more.identity.stateHash == kept->identity.stateHash) {
            kept->measured.insert(kept->measured.end(), more.measured.begin(), more.measured.end());
            store.keep(key, *kept);
            return std::move(*kept);
        }
    }
    MeasuredWork whole = measureWork(readWork(work, against, true, reading), against, asked, measuring);
    store.keep(key, whole);
    return whole;
}

std::string csvText(const std::string& text) {
    // A table shall not take a file's name for a formula.
    const bool isFormula = !text.empty() && std::string_view("=+-@\t").find(text.front()) != std::string_view::npos;
    std::string out = isFormula ? "'" + text : text;
    if (out.find_first_of(",\"\r\n") == std::string::npos) return out;
    for (std::size_t i = out.find('"'); i != std::string::npos; i = out.find('"', i + 2))
        out.insert(i, 1, '"');
    return '"' + out + '"';
}

}  // namespace

std::vector<fs::path> worksIn(const fs::path& folder) {
    if (!core::isFolder(folder))
        throw core::Error("there is no such folder", folder.string(), "name the folder with sessions and attempts");
    std::vector<fs::path> works;
    std::error_code ec;
    for (fs::directory_iterator entry(folder, ec), end; !ec && entry != end; entry.increment(ec)) {
        const fs::path& path = entry->path();
        const bool isDirectory = fs::is_directory(path, ec);
        if (path.filename().string().starts_with('.')) continue;
        if (isDirectory ? cases::isAttempt(path) || !sessionsIn(path).empty() : isSession(path)) works.push_back(path);
        if (isDirectory || !cases::isPackageName(path)) continue;
        try {
            if (!cases::isAttempt(path)) continue;  // a case or an exercise
        } catch (const core::Error&) {
            // Says so in its row.
        }
        works.push_back(path);
    }
    if (ec) throw core::Error("the folder cannot be read", folder.string(), ec.message());
    if (works.empty())
        throw core::Error("there is nothing to score in it", folder.string(),
                          "sessions (.h5), attempts, folders with the sessions of one piece of work");
    std::sort(works.begin(), works.end());
    return works;
}

std::vector<Rescored> rescore(std::span<const fs::path> works, const std::optional<tasks::Task>& task,
                              const rubric::Rubric& rubric, const MeasureStore& store, const core::Progress& progress) {
    rubric::requireSound(rubric);
    const std::vector<Request> asked = requestsOf(rubric);
    const std::string exercise = task ? rubric::hashText(tasks::contentHash(*task)) : std::string(kOwnCase);
    std::vector<Rescored> all(works.size());
    std::vector<double> done(works.size(), 0.0);
    std::mutex mutex;
    std::atomic<std::size_t> next{0};
    std::atomic<bool> isCancelled{false};
    const auto scoreOne = [&](std::size_t i) {
        Rescored& one = all[i];
        one.work = works[i];
        const core::Progress mine = [&, i](double fraction) {
            const std::lock_guard lock(mutex);
            done[i] = fraction;
            double sum = 0.0;
            for (const double d : done)
                sum += d;
            if (!isCancelled && progress && !progress(sum / static_cast<double>(works.size()))) isCancelled = true;
            return !isCancelled.load();
        };
        try {
            if (!mine(0.0)) return;
            const MeasuredWork measured = measureOrFind(works[i], task, exercise, asked, store, mine, one.isKept);
            one.result = judge(measured, rubric);
            // Kept measures are told by what they hold, not by what the exercise is called now.
            if (task) one.result->identity.exercise = task->id;
        } catch (const std::exception& e) {
            one.problem = core::asError(e).what();
        }
        (void)mine(1.0);
    };
    // Threads of their own: each may wait for inner work without being given another's.
    const std::size_t side = session::readSideBySide() ? std::min(core::threadCount(), works.size()) : 1;
    {
        std::vector<std::jthread> others;
        const auto workOn = [&] {
            for (std::size_t i = next++; i < works.size() && !isCancelled; i = next++)
                scoreOne(i);
        };
        for (std::size_t i = 1; i < side; ++i)
            others.emplace_back(workOn);
        workOn();
    }
    if (isCancelled) throw core::Error("cancelled");
    return all;
}

std::string rescoredCsv(std::span<const Rescored> all, const rubric::Rubric& rubric) {
    std::string csv =
        "work,error,proven,proof,sessions,exercise,exercise_hash,case_key,state_hash,device,rubric,"
        "rubric_version,rubric_hash,score,max_score,percent,least_score,most_score,passed,why,borderline,"
        "critical";
    for (const rubric::Criterion& c : rubric.criteria)
        csv += fmt::format(",{0},{0} +-,{0} band,{0} points,{0} not measured", c.id);
    csv += '\n';
    for (const Rescored& one : all) {
        csv += csvText(one.work.filename().string()) + "," + csvText(one.problem);
        if (!one.result) {
            csv += std::string(20 + 5 * rubric.criteria.size(), ',') + "\n";
            continue;
        }
        const score::Identity& of = one.result->identity;
        const score::Assessment& a = one.result->assessment;
        std::string critical;
        for (const score::CriticalError& e : a.critical)
            critical += fmt::format("{}{}{}", critical.empty() ? "" : " ", e.criterion, e.borderline ? "?" : "");
        csv += fmt::format(",{},{},{},{},{},{},{},{},{},{},{},{},{},{:.2f},{},{},{},{},{},{}", of.proven ? "yes" : "no",
                           csvText(one.result->proof), of.sessionHashes.size(), csvText(of.exercise), of.exerciseHash,
                           of.caseKey, of.stateHash, csvText(a.context.device), csvText(a.rubric),
                           csvText(a.rubricVersion), rubric::hashText(a.rubricHash), a.score, a.maxScore, a.percent(),
                           a.leastScore, a.mostScore, score::nameOf(a.passed), csvText(a.why),
                           a.borderline ? "yes" : "no", csvText(critical));
        for (const score::CriterionScore& c : a.criteria)
            csv += fmt::format(",{},{},{},{},{}", c.value ? fmt::format("{}", *c.value) : "",
                               c.value ? fmt::format("{}", c.uncertainty) : "", csvText(c.band),
                               c.points ? fmt::format("{}", *c.points) : "", csvText(c.reason));
        csv += '\n';
    }
    return csv;
}

std::string rescoredJson(std::span<const Rescored> all) {
    using Json = nlohmann::ordered_json;
    Json list = Json::array();
    for (const Rescored& one : all) {
        Json row = {{"work", one.work.filename().string()}};
        if (one.result)
            row.update(Json::parse(resultJson(one.result->assessment, one.result->identity)));
        else
            row["error"] = one.problem;
        list.push_back(std::move(row));
    }
    return list.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace handpiece::assessment
