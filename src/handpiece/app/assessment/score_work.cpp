// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/assessment/score_work.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "handpiece/app/simulation/session_player.h"
#include "handpiece/app/simulation/tissue_export.h"
#include "handpiece/assess/measures/preparation.h"
#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/model/case/attempt.h"

namespace handpiece::assessment {
namespace {

namespace fs = std::filesystem;

void requireSame(const fs::path& path, std::uint64_t caseKey, double voxelMm, const tasks::Task& task) {
    if (caseKey != cases::caseKey(task.toothCase))
        throw core::Error("this is work on another tooth than the exercise's", path.string(),
                          fmt::format("exercise {} is of {}", task.id, task.toothCase.name));
    if (std::abs(voxelMm - task.voxelMm) > 1e-9)
        throw core::Error(
            fmt::format("this was cut in a voxel of {:g} um", 1e3 * voxelMm), path.string(),
            fmt::format("exercise {} asks for {:g}: work on it as the exercise has it", task.id, 1e3 * task.voxelMm));
}

Work workOfSession(const fs::path& path, const tasks::Task& task, bool prove, const core::Progress& progress) {
    Work work;
    simulation::SessionPlayer player(path, {true, false, {}}, core::part(progress, 0.0, 0.2));
    requireSame(path, cases::caseKey(player.toothCase()), player.station().settings.field.voxelMm, task);
    core::Hasher hasher;
    hasher.add(std::span<const std::byte>(core::readFile(path)));
    work.sessionHashes = {rubric::hashText(hasher.value())};
    work.context.device = player.station().settings.capability.name;
    if (prove) {
        const simulation::Verdict verdict = player.compareAll(core::part(progress, 0.2, 1.0));
        work.isProven =
            verdict.matches && !verdict.isOtherEngine() && verdict.differingTicks == 0 && verdict.brokenSeams == 0;
        work.proof = work.isProven ? "cut again from its beginning, and the same tooth, bit for bit"
                     : verdict.isOtherEngine()
                         ? fmt::format("recorded by engine {}, and this is {}: put right at each key frame",
                                       verdict.engineRevision, core::kEngineRevision)
                     : verdict.recorded.empty() ? "it was cut off before it told a state"
                     : verdict.brokenSeams != 0
                         ? "where it goes on after a pause the tooth is not the one that was left"
                         : "cut again it leaves another tooth than it says";
    } else {
        work.proof = "not cut again";
        player.seek(player.durationS(), core::part(progress, 0.2, 1.0));
    }
    const auto take = [&work](const simulation::SessionPlayer& from) {
        work.teeth = from.station().teeth();
        work.state = from.state();
    };
    if (prove && !work.isProven) {
        // What the record itself says it came to, not what cutting it again did.
        simulation::SessionPlayer last(path, {true, false, {}});
        last.seek(last.durationS());
        take(last);
    } else {
        take(player);
    }
    return work;
}

/// What hands know: needs samples, which no tooth keeps.
measures::Measured notOfTheTooth(const rubric::Criterion& criterion) {
    measures::Measured measured;
    measured.kind = criterion.measure;
    measured.of = criterion.of;
    measured.reason = "measures of the hand are not taken yet";
    return measured;
}

}  // namespace

Work readWork(const fs::path& path, const tasks::Task& task, bool prove, const core::Progress& progress) {
    std::error_code ec;
    if (!fs::exists(path, ec))
        throw core::Error("there is no such work", path.string(), "name a session (.h5) or an attempt");
    if (path.extension() == ".h5" && !fs::is_directory(path, ec)) return workOfSession(path, task, prove, progress);
    if (!cases::isAttempt(path))
        throw core::Error("this is neither a session nor an attempt", path.string(),
                          "name session.h5, an attempt's folder or a .handpiece file");
    const cases::OpenAttempt open = cases::openAttempt(path);
    requireSame(path, cases::caseKey(open.toothCase), open.attempt.voxelMm, task);
    Work work;
    std::optional<simulation::CutTeeth> cut = simulation::readCutTeeth(path, {}, true, progress);
    work.teeth = std::move(cut->teeth);
    work.state = std::move(cut->state);
    work.proof = "an attempt says what the tooth is like, not how it came to be so";
    return work;
}

Result scoreWork(const Work& work, const tasks::Task& task, const rubric::Rubric& rubric) {
    const cases::Case& toothCase = task.toothCase;
    std::vector<std::unique_ptr<tooth::ToothMirror>> mirrors;
    for (std::size_t number = 0; number < work.teeth.size(); ++number) {
        if (work.teeth[number])
            mirrors.push_back(
                std::make_unique<tooth::ToothMirror>(work.teeth[number], static_cast<std::uint16_t>(number)));
        else
            mirrors.push_back(nullptr);
        if (mirrors.back()) mirrors.back()->apply(work.state);
    }
    measures::Preparation preparation;
    preparation.whole = work.teeth.front();
    preparation.cut = mirrors.front().get();
    preparation.landmarks = toothCase.landmarks;
    preparation.axes = measures::axesOf(toothCase.landmarks, toothCase.buccalSign);
    std::vector<measures::Preparation::Other> others;
    for (std::size_t number = 1; number < work.teeth.size() && number <= toothCase.others.size(); ++number)
        if (mirrors[number]) {
            const cases::PlacedTooth& other = toothCase.others[number - 1];
            others.push_back({work.teeth[number], mirrors[number].get(), other.inCase, other.fdiNumber});
        }
    preparation.others = others;
    // Of both jaws: which of them surrounds the tooth, the measure finds.
    geometry::TriangleMesh gums;
    for (const cases::Part& part : toothCase.scenery) {
        if (part.tissue != cases::Tissue::gum) continue;
        const auto first = static_cast<std::uint32_t>(gums.vertices.size());
        gums.vertices.insert(gums.vertices.end(), part.mesh.vertices.begin(), part.mesh.vertices.end());
        for (const geometry::Triangle& t : part.mesh.triangles)
            gums.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    std::optional<geometry::TriangleTree> gingiva;
    if (!gums.triangles.empty()) preparation.gingiva = &gingiva.emplace(gums);
    std::optional<preparation::Laid> laid;
    if (task.preparation) {
        laid = preparation::layOn(toothCase, *task.preparation);
        preparation.axes.draw = laid->draw;
        if (task.preparation->preparation == "crown") preparation.form = measures::Form::crown;
        preparation.zones = laid->zones.get();
    }

    std::vector<measures::Request> requests;
    std::vector<measures::Measured> measured;
    for (const rubric::Criterion& criterion : rubric.criteria) {
        const measures::MeasureKind* kind = measures::findMeasureKind(criterion.measure);
        if (kind != nullptr && kind->subject == measures::Subject::tooth)
            requests.push_back({criterion.measure, criterion.of});
        else
            measured.push_back(notOfTheTooth(criterion));
    }
    for (measures::Measured& one : measures::measure(preparation, requests))
        measured.push_back(std::move(one));

    Result result;
    result.assessment = score::evaluate(rubric, measured, work.context);
    result.identity.exercise = task.id;
    result.identity.exerciseHash = rubric::hashText(tasks::contentHash(task));
    result.identity.caseKey = rubric::hashText(cases::caseKey(toothCase));
    result.identity.stateHash = rubric::hashText(tooth::stateHash(work.state));
    result.identity.sessionHashes = work.sessionHashes;
    result.identity.proven = work.isProven;
    result.identity.engineRevision = core::kEngineRevision;
    result.proof = work.proof;
    return result;
}

}  // namespace handpiece::assessment
