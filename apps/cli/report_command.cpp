// SPDX-License-Identifier: Apache-2.0
// handpiece report: a session as one page to print.
#include <fmt/format.h>

#include <memory>
#include <string>

#include "cli/commands.h"
#include "handpiece/app/report/session_report.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/parallel.h"
#include "studies/progress_bar.h"

namespace handpiece::cli {
namespace {

struct ReportOptions {
    std::string session, out;
    bool noPictures = false, noCache = false;
    std::size_t threads = 0;
};

void report(const ReportOptions& o) {
    core::setThreadCount(o.threads);
    studies::ProgressBar preparing("preparing the tooth");
    simulation::SessionPlayer player(o.session, {!o.noCache, true, {}}, preparing.listener());
    preparing.finish();
    report::ReportSettings settings;
    settings.pictures = !o.noPictures;
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
    command.flag("--no-pictures", options->noPictures, "without pictures of the tooth");
    command.flag("--no-cache", options->noCache, "build the fields anew");
    command.option("--threads", options->threads, "threads for long work; 0: all cores")
        .check(range(std::size_t{0}, std::size_t{1024}))
        .showDefault();
    command.footer(
        "The page needs nothing beside it: views before and after, volumes, times, forces, speed, events, settings,\n"
        "and whether the tooth comes out the same when it is cut again.\n"
        "Example:\n  handpiece report session.h5 --out report.html");
    command.callback([options] { report(*options); });
}

}  // namespace handpiece::cli
