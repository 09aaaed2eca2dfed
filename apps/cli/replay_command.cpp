// SPDX-License-Identifier: Apache-2.0
// handpiece replay: cuts a session's tooth again with the hand that was recorded, and compares what is left.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/commands.h"
#include "handpiece/app/report/report_figures.h"
#include "handpiece/app/simulation/session_player.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "studies/progress_bar.h"
#include "studies/told_json.h"

namespace handpiece::cli {
namespace {

struct ReplayOptions {
    std::string session;
    bool json = false, noCache = false;
    std::size_t threads = 0;
};

void replay(const ReplayOptions& o) {
    core::setThreadCount(o.threads);
    studies::ProgressBar preparing("preparing the tooth");
    simulation::SessionPlayer player(o.session, {!o.noCache, false, {}}, preparing.listener());
    preparing.finish();
    studies::ProgressBar bar("cutting again");
    const simulation::Verdict v = player.compareAll(bar.listener());
    bar.finish();
    const std::vector<simulation::NickedTooth> nicked = simulation::nickedTeeth(player.station());
    const report::SessionFigures figures = report::figuresOf(player.reader());
    if (o.json) {
        fmt::print("{}\n", studies::toJson(v, player).dump(2));
    } else {
        fmt::print("state_hash {}\nmatches {}\n", v.hash, v.matches);
        for (const simulation::NickedTooth& tooth : nicked)
            fmt::print("nicked {}: {:.4f} mm3\n", tooth.name, tooth::sumOf(tooth.removedMm3));
        if (figures.byMirrorS > 0.0 || figures.fingerRestS > 0.0)
            fmt::print("by mirror {:.1f} s, with a finger rest {:.1f} s, of {:.1f} s\n", figures.byMirrorS,
                       figures.fingerRestS, figures.totalS);
        if (v.differingTicks > 0)
            fmt::print("{} ticks differ, the first is {}\n", v.differingTicks, v.firstDifferingTick);
        if (v.seams > 0)
            fmt::print("goes on {} times, {} of them on another tooth than was left\n", v.seams, v.brokenSeams);
    }
    if (v.isOtherEngine())
        throw core::Error(fmt::format("recorded by engine revision {}; this program's is {}: replayed approximately, "
                                      "which proves nothing",
                                      v.engineRevision, core::kEngineRevision),
                          o.session, "prove it with the version of Handpiece that recorded it");
    if (v.recorded.empty())
        throw core::Error("the session was cut off before it told a state to compare with", o.session);
    if (v.brokenSeams > 0)
        throw core::Error("the session goes on, after a pause, on another tooth than was left", o.session);
    if (!v.matches) throw core::Error("the tooth that was cut again is another", o.session);
}

}  // namespace

void addReplayCommand(Command& app) {
    Command command = app.subcommand("replay", "Cut a session's tooth again and prove that it is the same");
    const auto options = std::make_shared<ReplayOptions>();
    command.option("session", options->session, "session file (.h5)").required();
    command.flag("--json", options->json, "print the result as JSON");
    command.flag("--no-cache", options->noCache, "build the fields anew");
    command.option("--threads", options->threads, "threads for long work; 0: all cores")
        .check(range(std::size_t{0}, std::size_t{1024}))
        .showDefault();
    command.footer(
        "The session holds the tooth, the bur and the hand. state_hash is that of the cut tooth, bit for bit, at the "
        "session's\nend, or at its last key frame when it was cut off; matches says whether it was the same then. A "
        "session of "
        "another\nengine revision is cut again approximately, and cannot be proven.\n"
        "Example:\n  handpiece replay session.h5 --json");
    command.callback([options] { replay(*options); });
}

}  // namespace handpiece::cli
