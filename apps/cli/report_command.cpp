// SPDX-License-Identifier: Apache-2.0
// handpiece report: a session as one page to print.
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>

#include "cli/commands.h"
#include "cli/inputs.h"
#include "handpiece/app/assessment/score_work.h"
#include "handpiece/app/report/session_report.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/parallel.h"
#include "studies/progress_bar.h"

namespace handpiece::cli {
namespace {

struct ReportOptions {
    std::string session, out, exercise;
    bool noPictures = false, noCache = false;
    std::size_t threads = 0;
};

void report(const ReportOptions& o) {
    core::setThreadCount(o.threads);
    std::optional<tasks::Task> task;
    std::optional<rubric::Rubric> judged;
    std::optional<score::Result> result;
    if (!o.exercise.empty()) {
        task = exerciseOf(o.exercise).task;
        if (!task->rubric.empty()) {
            studies::ProgressBar scoring("scoring");
            judged = rubric::parseRubric(task->rubric, o.exercise + "/rubric.toml");
            rubric::requireSound(*judged);
            // Whether it is proven the page finds out by itself.
            result = assessment::scoreWork(assessment::readWork(o.session, *task, false, scoring.listener()), *task,
                                           *judged);
            scoring.finish();
        }
    }
    studies::ProgressBar preparing("preparing the tooth");
    simulation::SessionPlayer player(o.session, {!o.noCache, true, {}}, preparing.listener());
    preparing.finish();
    report::ReportSettings settings;
    settings.pictures = !o.noPictures;
    if (task) settings.against.task = &*task;
    if (result) {
        settings.against.result = &*result;
        settings.against.rubric = &*judged;
    }
    studies::ProgressBar bar("cutting again");
    const std::string page = report::sessionReport(player, settings, bar.listener());
    bar.finish();
    core::writeFile(o.out, page);
    fmt::print("{}\n", o.out);
}

}  // namespace

void addReportCommand(Command& app) {
    Command command = app.subcommand("report", "Write a session as one page to print");
    const auto options = std::make_shared<ReportOptions>();
    command.option("session", options->session, "session file (.h5)").required();
    command.option("--out", options->out, "the page (.html)").required();
    command.option("--exercise", options->exercise,
                   "what the work is held against (folder, .handpiece file, or id of one that comes along): the page "
                   "then shows lost points and the deviation from the ideal");
    command.flag("--no-pictures", options->noPictures, "without pictures of the tooth");
    command.flag("--no-cache", options->noCache, "build the fields anew");
    command.option("--threads", options->threads, "threads for long work; 0: all cores")
        .check(range(std::size_t{0}, std::size_t{1024}))
        .showDefault();
    command.footer(
        "The page needs nothing beside it: the tooth to turn, with a time line, views before and after, volumes, "
        "times, forces, speed, events, settings,\n"
        "and whether the tooth comes out the same when it is cut again.\n"
        "Example:\n  handpiece report session.h5 --out report.html");
    command.callback([options] { report(*options); });
}

}  // namespace handpiece::cli
