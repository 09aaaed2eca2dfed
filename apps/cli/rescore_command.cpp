// SPDX-License-Identifier: Apache-2.0
// handpiece rescore: many pieces of work under one rubric.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "cli/commands.h"
#include "handpiece/app/assessment/rescore.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "studies/progress_bar.h"

namespace handpiece::cli {
namespace {

struct RescoreOptions {
    std::string folder, exercise, rubric, out;
    bool json = false, anew = false;
};

void rescore(const RescoreOptions& o) {
    const rubric::Rubric judged = rubric::rubricByNameOrFile(o.rubric);
    rubric::requireSound(judged);
    const std::optional<tasks::Task> task =
        o.exercise.empty() ? std::nullopt : std::optional(exerciseOf(o.exercise).task);
    const std::vector<std::filesystem::path> works = assessment::worksIn(o.folder);
    const assessment::MeasureStore store = o.anew ? assessment::MeasureStore({}) : assessment::MeasureStore::usual();
    studies::ProgressBar bar("scoring");
    const std::vector<assessment::Rescored> all = assessment::rescore(works, task, judged, store, bar.listener());
    bar.finish();
    core::writeFile(o.out, assessment::rescoredCsv(all, judged));
    if (o.json) {
        fmt::print("{}", assessment::rescoredJson(all));
        return;
    }
    for (const assessment::Rescored& one : all) {
        const std::string name = assessment::nameOf(one.work, all);
        if (one.result)
            fmt::print("  {:<32} {:>6.1f} of {:<6.1f} passed: {:<8} {}\n", name, one.result->assessment.score,
                       one.result->assessment.maxScore, score::nameOf(one.result->assessment.passed),
                       one.result->identity.proven ? "proven" : "not proven");
        else
            fmt::print("  {:<32} {}\n", name, one.problem);
    }
    const auto failed = std::count_if(all.begin(), all.end(), [](const auto& one) { return !one.result; });
    const auto kept = std::count_if(all.begin(), all.end(), [](const auto& one) { return one.isKept; });
    fmt::print("{} scored, {} of them as measured before; {} could not be scored: {}\n",
               static_cast<std::ptrdiff_t>(all.size()) - failed, kept, failed, o.out);
}

}  // namespace

void addRescoreCommand(Command& app) {
    Command command = app.subcommand("rescore", "Judge a folder of sessions and attempts by a rubric");
    const auto options = std::make_shared<RescoreOptions>();
    RescoreOptions& o = *options;
    command.option("FOLDER", o.folder, "of sessions, attempts, and folders with the sessions of one piece of work")
        .required();
    command.option("--rubric", o.rubric, "a file, or one that comes with the program").required();
    command.option("--out", o.out, "table (CSV), a line for each piece of work").required();
    command.option("--exercise", o.exercise, "that all are of; else each is held against its own case");
    command.flag("--json", o.json, "results as JSON too, on the screen");
    command.flag("--anew", o.anew, "neither use nor keep what was measured before");
    command.footer(
        "What was measured once, and its proof, is kept in the user's cache folder: under another rubric nothing is "
        "cut\n"
        "again. Work that cannot be scored is a line with its reason. Ctrl-C stops; what was measured by then is "
        "kept.\n"
        "Example:\n  handpiece rescore handed-in --exercise class-one --rubric own.toml --out scores.csv");
    command.callback([options] { rescore(*options); });
}

}  // namespace handpiece::cli
