// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/marking/scoring.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <mutex>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/assessment/side_by_side.h"
#include "handpiece/app/simulation/live_tooth.h"
#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/senses/view/renderer.h"

namespace handpiece::marking {

namespace fs = std::filesystem;

namespace {

/// Whoever wrote it: the rubric's criteria, each once, in its order.
bool fits(const score::Assessment& assessment, const rubric::Rubric& rubric) {
    return std::equal(assessment.criteria.begin(), assessment.criteria.end(), rubric.criteria.begin(),
                      rubric.criteria.end(), [](const score::CriterionScore& s, const rubric::Criterion& c) {
                          return s.id == c.id && s.measure == c.measure && s.of == c.of;
                      });
}

}  // namespace

/// What was found before, by what it was found of: FOLDER/KEY.json, its proof and its picture beside.
struct Kept {
    fs::path folder;
    std::string key;

    Kept(const ReturnedWork& work, const tasks::Task& task, const rubric::Rubric& rubric, const ScoreSettings& settings)
        : folder(settings.kept) {
        core::Hasher hasher;
        hasher.add(std::string_view(work.id));
        hasher.add(std::string_view(task.id));  // what was handed in for another is refused
        hasher.add(tasks::contentHash(task));
        hasher.add(rubric::hashOf(rubric));
        hasher.add(core::kEngineRevision);
        hasher.add(measures::kMeasuresRevision);
        hasher.add(settings.prove);
        key = rubric::hashText(hasher.value());
    }
    [[nodiscard]] fs::path file(const char* ending) const { return folder / (key + ending); }

    [[nodiscard]] std::optional<Scored> read(const rubric::Rubric& rubric, bool withPicture) const {
        if (folder.empty() || !core::isThere(file(".json"))) return {};
        const auto text = [](const fs::path& path) {
            const std::vector<std::byte> bytes = core::readFile(path, 8u << 20);
            return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        };
        try {
            Scored scored;
            scored.result_ = assessment::parseResult(text(file(".json")), file(".json").string());
            if (!fits(scored.result_->assessment, rubric)) return {};
            scored.result_->proof = text(file(".txt"));
            if (withPicture && core::isThere(file(".png"))) scored.picture_ = view::readPng(file(".png"));
            return scored;
        } catch (const core::Error&) {
            return {};  // what cannot be read is made again
        }
    }
    /// Where nothing can be kept (a full disk, a folder that is read only) it is made again the next time.
    void write(const Scored& scored) const {
        if (folder.empty() || !scored.result_) return;
        try {
            core::prepareOutputFolder(folder, true);
            if (!scored.picture_.rgba.empty()) view::writePng(scored.picture_, file(".png"));
            core::writeFile(file(".txt"), scored.result_->proof, {true, false});
            core::writeFile(file(".json"), assessment::resultJson(scored.result_->assessment, scored.result_->identity),
                            {true, false});
        } catch (const core::Error&) {
            return;
        }
    }
};

namespace {

/// Throws core::Error: it is of another exercise, by another rubric.
void requireOf(const assessment::Result& result, const tasks::Task& task, const rubric::Rubric& rubric,
               const fs::path& path) {
    if (result.identity.exerciseHash != rubric::hashText(tasks::contentHash(task)))
        throw core::Error("this is a result of another exercise", path.string()).as("other-result");
    if (result.assessment.rubricHash != rubric::hashOf(rubric))
        throw core::Error(
            fmt::format("this is a result by another rubric: {} version {}, hash {}", result.assessment.rubric,
                        result.assessment.rubricVersion, rubric::hashText(result.assessment.rubricHash)),
            path.string())
            .as("other-rubric", {result.assessment.rubric, result.assessment.rubricVersion});
    if (!fits(result.assessment, rubric))
        throw core::Error("this result has other criteria than its rubric", path.string()).as("other-criteria");
}

Scored readLoneResult(const ReturnedWork& work, const tasks::Task& task, const rubric::Rubric& rubric) {
    const std::vector<std::byte> bytes = core::readFile(work.path, 8u << 20);
    assessment::Result result =
        assessment::parseResult({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, work.path.string());
    requireOf(result, task, rubric, work.path);
    // Who wrote it nobody can tell.
    result.identity.proven = false;
    result.proof = "the result came without the work that it is of";
    return Scored::of(std::move(result));
}

/// What was handed in for another exercise may be of the same tooth: its score would be another's.
void requireSameExercise(const fs::path& path, const tasks::Task& task) {
    if (!cases::isAttempt(path)) return;
    const std::optional<cases::Attempt::HandIn> handIn = cases::readAttempt(path).handIn;
    if (handIn && handIn->exercise != task.id)
        throw core::Error(fmt::format("this was handed in for another exercise, {}", handIn->exercise), path.string(),
                          "choose that exercise, or take the work out of the folder")
            .as("other-exercise", {handIn->exercise});
}

}  // namespace

view::Image pictureOf(const assessment::Work& work, const view::Standing& standing, int widthPx, int heightPx) {
    const view::Viewport viewport{widthPx, heightPx};
    tooth::StateDelta own;
    for (const tooth::StateDelta::Brick& brick : work.state.bricks)
        if (tooth::toothOf(brick.id) == 0) own.bricks.push_back(brick);
    own.removedMm3.own = work.state.removedMm3.own;
    simulation::LiveTooth live(work.teeth.front(), own);
    live.settle();
    const core::Box bounds = live.model().outer.bounds();
    view::Renderer renderer;
    renderer.setTooth(bounds);
    renderer.updateBricks(live.uncutSurface(), true);
    renderer.updateBricks(live.takeNews());
    view::Look look;
    look.palette = view::Palette::textbook;
    look.bur = look.turbine = look.debris = look.spray = false;
    look.backgroundTop = look.backgroundBottom = {236, 239, 243};
    view::Moment moment;
    moment.burShown = false;
    const view::Camera camera = view::standardView(view::StandardView::occlusal, bounds, standing, viewport);
    view::Image image;
    for (int i = 0; i < 8 && (renderer.draw(camera, viewport, look, moment, image).refining || i == 0); ++i) {
    }
    return image;
}

Scored Scored::failed(core::Error error) {
    Scored scored;
    scored.error_ = std::move(error);
    return scored;
}

Scored Scored::of(assessment::Result result, view::Image picture) {
    Scored scored;
    scored.result_ = std::move(result);
    scored.picture_ = std::move(picture);
    return scored;
}

Judged judgeReturned(const fs::path& work, const tasks::Task& task, const rubric::Rubric& rubric, bool prove,
                     bool pictures, const fs::path& unpacked, const core::Progress& progress) {
    requireSameExercise(work, task);
    const assessment::Work done = assessment::readWork(work, task, prove, core::part(progress, 0.0, 0.8), unpacked);
    core::report(progress, 0.8);
    Judged judged{assessment::scoreWork(done, task, rubric)};
    core::report(progress, 0.95);
    if (!pictures) return judged;
    try {
        judged.picture = pictureOf(done, view::standingOf(task.toothCase.fdiNumber, task.toothCase.buccalSign),
                                   kPictureWidth, kPictureHeight);
    } catch (const core::Error&) {
        judged.picture = {};  // no OpenGL: the score stands without a picture
    }
    return judged;
}

Scored scoreReturned(const ReturnedWork& work, const tasks::Task& task, const rubric::Rubric& rubric,
                     const ScoreSettings& settings, const core::Progress& progress) {
    if (work.error) return Scored::failed(*work.error);
    // Cancelling is told apart from what is wrong with the work by asking, not by the words of an error.
    std::atomic<bool> isCancelled{false};
    const core::Progress heard = [&progress, &isCancelled](double fraction) {
        if (progress && !progress(fraction)) isCancelled = true;
        return !isCancelled;
    };
    try {
        if (work.isResultOnly) return readLoneResult(work, task, rubric);
        const Kept kept(work, task, rubric, settings);
        if (std::optional<Scored> before = kept.read(rubric, settings.pictures)) return std::move(*before);
        Judged judged = settings.judge
                            ? settings.judge(work, heard)
                            : judgeReturned(work.path, task, rubric, settings.prove, settings.pictures, {}, heard);
        requireOf(judged.result, task, rubric, work.path);
        Scored scored = Scored::of(std::move(judged.result), std::move(judged.picture));
        kept.write(scored);
        return scored;
    } catch (const std::exception& error) {
        if (isCancelled) throw core::Error("cancelled");
        return Scored::failed(core::asError(error));
    }
}

void scoreAll(std::span<const ReturnedWork> works, const tasks::Task& task, const rubric::Rubric& rubric,
              const ScoreSettings& settings, const core::Progress& progress,
              const std::function<void(std::size_t which, Scored scored)>& done) {
    if (works.empty()) return core::report(progress, 1.0);
    constexpr std::size_t kMost = 4;  // each holds a tooth
    std::mutex telling;
    assessment::eachSideBySide(works.size(), kMost, progress, [&](std::size_t i, const core::Progress& its) {
        Scored scored = scoreReturned(works[i], task, rubric, settings, its);
        const std::lock_guard lock(telling);
        done(i, std::move(scored));
    });
}

}  // namespace handpiece::marking
