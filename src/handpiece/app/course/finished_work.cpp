// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/course/finished_work.h"

#include <fmt/format.h>

#include <algorithm>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/model/tooth/tooth_mirror.h"
#include "handpiece/record/session/session_reader.h"
#include "handpiece/senses/surface/brick_source.h"
#include "handpiece/senses/surface/closed_surface.h"

namespace handpiece::course {
namespace {

Parts partsOf(const std::shared_ptr<const tooth::ToothModel>& model, const tooth::StateDelta& state,
              const core::Progress& progress) {
    tooth::ToothMirror mirror(model);
    mirror.apply(state);
    const surface::MirrorSource source(mirror);
    auto parts = std::make_shared<std::vector<cases::Part>>();
    const std::vector<cases::Tissue> tissues = model->tissues.tissues();
    for (std::size_t i = 0; i < tissues.size(); ++i) {
        const double share = 1.0 / static_cast<double>(tissues.size());
        geometry::TriangleMesh mesh = surface::closedPart(
            source, model->tissues, tissues[i],
            core::part(progress, share * static_cast<double>(i), share * static_cast<double>(i + 1)));
        if (mesh.triangles.empty()) continue;
        const std::string name(cases::properties(tissues[i]).name);
        parts->push_back({name, tissues[i], static_cast<int>(i), std::move(mesh)});
    }
    return parts;
}

}  // namespace

rubric::Rubric rubricOf(const tasks::Task& task) {
    if (task.rubric.empty())
        throw core::Error("this exercise has no rubric", task.id,
                          "ask your teacher for one that has: it cannot be judged");
    rubric::Rubric rubric = rubric::parseRubric(task.rubric, task.id + "/" + tasks::kRubricFile);
    rubric::requireSound(rubric);
    return rubric;
}

namespace {
/// Measured and judged; `own` stays empty.
void judge(FinishedWork& done, const core::Progress& progress) {
    const assessment::MeasuredWork measured =
        assessment::measureWork(done.work, *done.task, assessment::requestsOf(done.rubric), progress);
    done.result = assessment::judge(measured, done.rubric);
    done.bearings = report::bearingsOf(*done.task);
}
}  // namespace

FinishedWork judged(const std::filesystem::path& work, std::shared_ptr<const tasks::Task> task,
                    const core::Progress& progress) {
    FinishedWork done;
    done.task = std::move(task);
    done.session = work;
    done.rubric = rubricOf(*done.task);
    done.work = assessment::readWork(work, *done.task, true, core::part(progress, 0.0, 0.8));
    judge(done, core::part(progress, 0.8, 1.0));
    return done;
}

FinishedWork finish(std::span<const assessment::ChainLink> chain, std::shared_ptr<const tasks::Task> task,
                    const core::Progress& progress) {
    FinishedWork done;
    done.task = std::move(task);
    done.rubric = rubricOf(*done.task);
    done.work = assessment::readChain(chain, *done.task, true, core::part(progress, 0.0, 0.7));
    done.session = chain.back().in;
    judge(done, core::part(progress, 0.7, 0.85));
    done.own = partsOf(done.work.teeth.front(), done.work.state, core::part(progress, 0.85, 1.0));
    return done;
}

FinishedWork finish(const std::filesystem::path& session, std::shared_ptr<const tasks::Task> task,
                    const core::Progress& progress) {
    const assessment::ChainLink link{session.filename().string(), session, false};
    return finish(std::span(&link, 1), std::move(task), progress);
}

FinishedWork reopen(score::Result result, std::span<const assessment::ChainLink> chain,
                    std::shared_ptr<const tasks::Task> task, const core::Progress& progress) {
    FinishedWork done;
    done.task = std::move(task);
    const std::vector<std::string> hashes = result.identity.sessionHashes;
    const bool isSame = result.identity.exerciseHash == rubric::hashText(tasks::contentHash(*done.task));
    if (isSame && !done.task->rubric.empty())
        if (rubric::Rubric its = rubricOf(*done.task); rubric::hashOf(its) == result.assessment.rubricHash)
            done.rubric = std::move(its);
    const bool isWhole = isSame && !chain.empty() && chain.size() == hashes.size() &&
                         std::all_of(chain.begin(), chain.end(),
                                     [](const assessment::ChainLink& link) { return core::isThere(link.in); });
    done.result = std::move(result);
    done.bearings = report::bearingsOf(*done.task);
    if (!isWhole) return done;
    assessment::Work work = assessment::readChain(chain, *done.task, false, core::part(progress, 0.0, 0.6));
    if (work.sessionHashes != hashes ||
        rubric::hashText(tooth::stateHash(work.state)) != done.result.identity.stateHash)
        return done;
    done.work = std::move(work);
    done.session = chain.back().in;
    done.own = partsOf(done.work.teeth.front(), done.work.state, core::part(progress, 0.6, 1.0));
    return done;
}

void handIn(const FinishedWork& done, const HandInWords& words, const std::filesystem::path& file) {
    if (!cases::isPackageName(file)) throw core::Error("a hand-in is one file", file.string(), "name it .handpiece");
    const tasks::Task& task = *done.task;
    cases::Attempt attempt;
    attempt.caseFile = file;
    attempt.caseKey = cases::contentKey(task.toothCase);
    attempt.caseName = task.toothCase.name;
    attempt.state = tooth::encodeState(done.work.state, tooth::identityOf(done.work.teeth));
    attempt.voxelMm = task.voxelMm;
    attempt.removedMm3 = done.work.state.removedMm3.own;
    attempt.student = words.student;
    attempt.handedIn = true;
    attempt.exercise = tasks::taskToml(task);
    attempt.rubric = task.rubric;
    attempt.handIn = cases::Attempt::HandIn{task.id,
                                            task.version,
                                            done.result.identity.exerciseHash,
                                            assessment::resultJson(done.result.assessment, done.result.identity),
                                            words.expectedPercent,
                                            words.expectedWords};
    cases::PackageFiles sessions;
    for (const assessment::Recording& one : done.work.recordings) {
        const std::string name = one.path.filename().string();
        const session::SessionReader reader(one.path);
        attempt.elapsedS += static_cast<double>(reader.endTick()) / reader.info().rateHz;
        const simulation::SimulationSettings settings =
            simulation::settingsFromJson(reader.info().settings, one.path.string());
        if (settings.bur) attempt.bur = settings.bur->name();
        attempt.cuttingParameters = settings.cuttingParameters.name;
        attempt.drive = settings.drive.name;
        if (!sessions.emplace(name, core::readFile(one.path, cases::kMaxRecordingBytes)).second)
            throw core::Error(fmt::format("two of its sessions are called {}", name), one.path.string(),
                              "give them other names");
        attempt.recordings.push_back({name, true});
        attempt.session = name;
    }
    if (attempt.bur.empty() && task.toothCase.exercise) attempt.bur = task.toothCase.exercise->bur;
    cases::writeAttempt(attempt, file, &task.toothCase, std::move(sessions));
}

Parts idealOf(const tasks::Task& task, const core::Progress& progress) {
    if (!task.preparation) return nullptr;
    tooth::LoadSettings settings;
    settings.field = simulation::fieldSettingsAt(task.voxelMm);
    const auto model = tooth::loadModel(task.toothCase, settings, core::part(progress, 0.0, 0.6));
    const preparation::Laid laid = preparation::layOn(task.toothCase, *task.preparation);
    core::report(progress, 0.65);
    const tooth::StateDelta state = zones::idealState(*laid.zones, model);
    return partsOf(model, state, core::part(progress, 0.75, 1.0));
}

}  // namespace handpiece::course
