// SPDX-License-Identifier: Apache-2.0
// handpiece score: work held against its exercise and judged by a rubric.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "cli/inputs.h"
#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/assessment/judge_file.h"
#include "handpiece/app/assessment/score_work.h"
#include "handpiece/app/assessment/student_page.h"
#include "handpiece/app/report/assessment_pictures.h"
#include "handpiece/app/scan_work/scan_work.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/case/attempt.h"
#include "studies/progress_bar.h"

namespace handpiece::cli {
namespace {

struct ScoreOptions {
    std::string work, exercise, rubric, out, classFolder, before;
    MeshUnit unit;
    bool json = false, noReplay = false, noPictures = false, anew = false;
    std::size_t threads = 0;
};

void tell(const assessment::Result& result) {
    const score::Assessment& a = result.assessment;
    for (const score::CriterionScore& c : a.criteria) {
        const std::string of = fmt::format("{}{}{}", c.id, c.critical == score::Verdict::yes ? " CRITICAL" : "",
                                           c.borderline ? " (borderline: the teacher decides)" : "");
        if (c.standing == score::Standing::judged)
            fmt::print("  {:<44} {:>9.3f} +- {:<6.3f} {:<4}{:>14} {}\n", of, *c.value, c.uncertainty, c.unit, c.band,
                       c.points ? fmt::format("{:.1f} of {:.1f}", *c.points, c.maxPoints) : "shown only");
        else
            fmt::print("  {:<44} {}: {}\n", of, score::nameOf(c.standing), c.reason);
    }
    if (const auto& c = a.completeness; c && !c->value)
        fmt::print("  completeness was not measured, and nothing is taken off for it: {}\n", c->reason);
    else if (c && c->factor < 1.0)
        fmt::print(
            "  not finished: {:.1f} +- {:.1f} {} of it is done, so points count {:.0f} % ({:.1f} lost by that)\n",
            *c->value, c->uncertainty, c->unit, 100.0 * c->factor, a.lostUndone());
    fmt::print("{:.1f} of {:.1f} points ({:.1f} to {:.1f}); passed: {}{}\n", a.score, a.maxScore, a.leastScore,
               a.mostScore, score::nameOf(a.passed), a.why.empty() ? "" : ", " + a.why);
    fmt::print("{}: {}\n", result.identity.proven ? "proven" : "not proven", result.proof);
}

/// For which exercise it was handed in, and what its student expected.
void tellHandIn(const ScoreOptions& o, const assessment::Result& result) {
    if (!cases::isPackageName(o.work)) return;
    const std::optional<cases::Attempt::HandIn> in = cases::readAttempt(o.work).handIn;
    if (!in) return;
    const bool isThis = in->exerciseHash == result.identity.exerciseHash;
    fmt::print("handed in for exercise {} version {}{}\n", in->exercise, in->version,
               isThis ? "" : fmt::format(" (hash {}), which is not the one that it is held against", in->exerciseHash));
    if (in->expectedPercent)
        fmt::print("its student expected {:g} %{}\n", *in->expectedPercent,
                   in->expectedWords.empty() ? "" : ": " + in->expectedWords);
}

/// The page of a class, of results that are there.
void runClass(const ScoreOptions& o) {
    if (o.out.empty()) throw core::Error("the class has no page yet", "--out", "name the page (.html)");
    const std::vector<report::ClassEntry> entries = assessment::readClass(o.classFolder);
    core::writeFile(o.out, report::classReport(entries));
    fmt::print("{}: {} results\n", o.out, entries.size());
}

using Files = std::vector<std::pair<std::filesystem::path, std::vector<std::byte>>>;

/// What `--out` asks for: the result, its pictures, the page.
Files filesOf(const ScoreOptions& o, const assessment::Work& work, const assessment::Result& result,
              const std::string& json, const tasks::Task& task, const rubric::Rubric& judged) {
    const std::filesystem::path folder(o.out);
    Files files;
    const auto keep = [&](const std::string& name, std::span<const std::byte> data) {
        if (!data.empty()) files.emplace_back(folder / name, std::vector<std::byte>(data.begin(), data.end()));
    };
    keep("result.json", std::as_bytes(std::span(json)));
    report::AssessmentPictures pictures;
    if (!o.noPictures) {
        studies::ProgressBar bar("pictures");
        pictures =
            report::assessmentPictures(task, work.teeth, work.state, result.assessment, judged, {}, bar.listener());
        bar.finish();
    }
    for (const report::AssessmentPictures::View& view : pictures.views) {
        keep(view.name + "-own.png", view.own);
        keep(view.name + "-ideal.png", view.ideal);
        keep(view.name + "-deviation.png", view.deviation);
    }
    keep("undone.png", pictures.undone);
    for (const auto& [criterion, png] : pictures.places)
        keep("error-" + criterion + ".png", png);
    studies::ProgressBar bar("looking through it");
    const std::string page =
        assessment::studentPage(work, result, task, judged, pictures, !o.noPictures, bar.listener());
    bar.finish();
    keep("report.html", std::as_bytes(std::span(page)));
    return files;
}

/// All of them; where one cannot be written, none that was not there before.
void writeAll(const std::filesystem::path& folder, const Files& files) {
    const bool isNew = !core::isThere(folder);
    core::prepareOutputFolder(folder);
    std::vector<std::filesystem::path> made;
    try {
        for (const auto& [path, data] : files) {
            const bool wasThere = core::isThere(path);
            core::writeFile(path, data);
            if (!wasThere) made.push_back(path);
        }
    } catch (const core::Error&) {
        std::error_code ignored;
        for (const std::filesystem::path& path : made)
            std::filesystem::remove(path, ignored);
        if (isNew) std::filesystem::remove(folder, ignored);
        throw;
    }
}

void run(const ScoreOptions& o) {
    core::setThreadCount(o.threads);
    if (!o.classFolder.empty()) return runClass(o);
    if (o.work.empty()) throw core::Error("there is no work to judge", "score", "name a session, an attempt or a scan");
    if (o.exercise.empty())
        throw core::Error("which exercise is it?", "--exercise",
                          "name its folder or file, or the id of one that comes along");
    const tasks::Task task = exerciseOf(o.exercise).task;
    const rubric::Rubric judged = assessment::rubricFor(task, o.rubric, o.exercise);
    assessment::WorkFile file{o.work, {}, o.unit.mmPerUnit(), !o.noReplay, !o.anew};
    if (!o.before.empty()) file.before = o.before;
    studies::ProgressBar bar(scan_work::isScan(o.work) ? "registering the scan" : "cutting it again");
    const auto [work, result] = assessment::judgeFile(file, task, judged, bar.listener());
    bar.finish();
    const std::string json = assessment::resultJson(result.assessment, result.identity);
    if (!o.out.empty()) writeAll(o.out, filesOf(o, work, result, json, task, judged));
    if (o.json) {
        fmt::print("{}", json);
    } else {
        tell(result);
        tellHandIn(o, result);
    }
}

}  // namespace

void addScoreCommand(Command& app) {
    Command command = app.subcommand("score", "Judge work on an exercise by its rubric");
    const auto options = std::make_shared<ScoreOptions>();
    ScoreOptions& o = *options;
    command.option("WORK", o.work,
                   "a session (.h5), a folder with all sessions of one piece of work, an attempt, or a scan of a "
                   "preparation (.stl, .ply)");
    command.option("--exercise", o.exercise, "folder, .handpiece file, or id of one that comes along");
    command.option("--rubric", o.rubric, "instead of the exercise's own: a file, or one that comes with the program");
    addUnitOptions(command, o.unit, false);
    command.option("--before", o.before,
                   "an earlier scan, before anything was cut, of the same tooth and those beside it (.stl, .ply): to "
                   "register a scan on");
    command.flag("--no-replay", o.noReplay, "do not cut a session again: quicker, and not proven");
    command.flag("--anew", o.anew, "cut it again although it was proven before, and keep nothing");
    command.flag("--json", o.json, "as JSON (docs/formats/rubric.md)");
    command.flag("--no-pictures", o.noPictures, "without pictures of the tooth");
    command.option("--class", o.classFolder,
                   "instead of work: a folder with a folder of results a student; --out is the class's page");
    command.option("--out", o.out, "folder for result.json, report.html and pictures; of --class the page (.html)");
    command.option("--threads", o.threads, "threads for long work; 0: all cores").check(range(0, 64)).showDefault();
    command.footer(
        "Examples:\n  handpiece score out/cut/session.h5 --exercise class-one --out result\n"
        "  handpiece score --class results --out class.html");
    command.callback([options] { run(*options); });
}

}  // namespace handpiece::cli
