// SPDX-License-Identifier: Apache-2.0
// handpiece score: work held against its exercise and judged by a rubric.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "cli/commands.h"
#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/assessment/score_work.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "studies/progress_bar.h"

namespace handpiece::cli {
namespace {

struct ScoreOptions {
    std::string work, exercise, rubric, out;
    bool json = false, noReplay = false;
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
    fmt::print("{:.1f} of {:.1f} points ({:.1f} to {:.1f}); passed: {}{}\n", a.score, a.maxScore, a.leastScore,
               a.mostScore, score::nameOf(a.passed), a.why.empty() ? "" : ", " + a.why);
    fmt::print("{}: {}\n", result.identity.proven ? "proven" : "not proven", result.proof);
}

void run(const ScoreOptions& o) {
    const tasks::Task task = tasks::readTask(o.exercise);
    if (o.rubric.empty() && task.rubric.empty())
        throw core::Error("this exercise has no rubric", o.exercise,
                          "give one with --rubric: a file, or a name of handpiece rubric show");
    const rubric::Rubric judged = o.rubric.empty() ? rubric::parseRubric(task.rubric, o.exercise + "/rubric.toml")
                                                   : rubric::rubricByNameOrFile(o.rubric);
    rubric::requireSound(judged);
    studies::ProgressBar bar("cutting it again");
    const assessment::Work work = assessment::readWork(o.work, task, !o.noReplay, bar.listener());
    bar.finish();
    const assessment::Result result = assessment::scoreWork(work, task, judged);
    const std::string json = assessment::resultJson(result.assessment, result.identity);
    if (!o.out.empty()) {
        core::prepareOutputFolder(o.out);
        core::writeFile(std::filesystem::path(o.out) / "result.json", json);
    }
    if (o.json)
        fmt::print("{}\n", json);
    else
        tell(result);
}

}  // namespace

void addScoreCommand(Command& app) {
    Command command = app.subcommand("score", "Judge work on an exercise by its rubric");
    const auto options = std::make_shared<ScoreOptions>();
    ScoreOptions& o = *options;
    command.option("WORK", o.work, "a session (.h5), a folder with all sessions of one piece of work, or an attempt")
        .required();
    command.option("--exercise", o.exercise, "folder or .handpiece file").required();
    command.option("--rubric", o.rubric, "instead of the exercise's own: a file, or one that comes with the program");
    command.flag("--no-replay", o.noReplay, "do not cut a session again: quicker, and not proven");
    command.flag("--json", o.json, "as JSON (docs/formats/rubric.md)");
    command.option("--out", o.out, "folder for result.json");
    command.footer("Example:\n  handpiece score out/cut/session.h5 --exercise class-one");
    command.callback([options] { run(*options); });
}

}  // namespace handpiece::cli
