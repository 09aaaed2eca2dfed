// SPDX-License-Identifier: Apache-2.0
// handpiece passivity: where the closed loop of hand, device and tooth stays passive, as a table and a map.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "studies/passivity.h"
#include "studies/progress_bar.h"
#include "studies/stability_picture.h"

namespace handpiece::cli {
namespace {

struct PassivityOptions {
    std::string out;
    double stiffness = 1.0, damping = 1.0, limit = 0.0;
    bool map = false, quick = false;
    std::vector<std::string> motions;
    double assumedDelayMs = -1.0;
};

/// One cell a combination: rows are tissues and rates, columns hands, frictions and delays. Blue holds, orange with a
/// cross does not; a dot marks a ripple at rest that grows.
std::string mapSvg(const studies::PassivitySweep& sweep, const std::vector<studies::PassivityRow>& rows) {
    constexpr int kCell = 22, kLeft = 190, kTop = 96;
    const std::size_t columns = sweep.hands.size() * sweep.frictionN.size() * sweep.delayS.size();
    const std::size_t lines = sweep.tissues.size() * sweep.rateHz.size();
    const int width = kLeft + static_cast<int>(columns) * kCell + 20,
              height = kTop + static_cast<int>(lines) * kCell + 40;
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
        "font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
        width, height);
    const auto text = [&](double x, double y, const std::string& words, const char* anchor) {
        svg += fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"{}\" fill=\"#222\">{}</text>\n", x, y, anchor,
                           words);
    };
    text(8, 18, "Passivity: hand, friction [N] and delay [ms] across; tissue and rate down", "start");
    const std::size_t delays = sweep.delayS.size(), frictions = sweep.frictionN.size();
    for (std::size_t c = 0; c < columns; ++c) {
        const double x = kLeft + (static_cast<double>(c) + 0.5) * kCell;
        text(x, kTop - 8, fmt::format("{:.0f}", 1e3 * sweep.delayS[c % delays]), "middle");
        if (c % delays == 0)
            text(x + 0.5 * kCell * static_cast<double>(delays - 1), kTop - 26,
                 fmt::format("{:.2f} N", sweep.frictionN[c / delays % frictions]), "middle");
        if (c % (delays * frictions) == 0)
            text(x + 0.5 * kCell * static_cast<double>(delays * frictions - 1), kTop - 46,
                 std::string(sweep.hands[c / (delays * frictions)].name), "middle");
    }
    std::size_t at = 0;
    for (std::size_t c = 0; c < columns; ++c)
        for (std::size_t l = 0; l < lines; ++l, ++at) {
            const studies::PassivityRow& row = rows[at];
            const double x = kLeft + static_cast<double>(c) * kCell, y = kTop + static_cast<double>(l) * kCell;
            if (c == 0)
                text(kLeft - 8, y + 15,
                     fmt::format("{} {:.0f} kHz", cases::properties(row.tissue).name, 1e-3 * row.rateHz), "end");
            svg += fmt::format(
                "<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"{}\" height=\"{}\" fill=\"{}\" stroke=\"#fff\"><title>{} "
                "hand, {} N, {} ms, "
                "{}, {:.0f} Hz: margin {:.4f} N mm</title></rect>\n",
                x, y, kCell, kCell, row.holds ? "#4a90c2" : "#e08a2e", row.hand, row.frictionN, 1e3 * row.delayS,
                cases::properties(row.tissue).name, row.rateHz, row.marginNmm);
            if (!row.holds)
                svg += fmt::format("<path d=\"M{:.0f} {:.0f}l10 10m0 -10l-10 10\" stroke=\"#222\"/>\n", x + 6, y + 6);
            if (row.growing)
                svg += fmt::format("<circle cx=\"{:.0f}\" cy=\"{:.0f}\" r=\"3\" fill=\"#222\"/>\n", x + 11, y + 11);
        }
    text(kLeft, height - 14, "blue: holds   orange, crossed: does not   dot: the ripple at rest grows", "start");
    return svg + "</svg>\n";
}

/// Every loop twice, the controller off and on.
void stabilityMap(const PassivityOptions& o) {
    studies::StabilitySweep sweep = o.quick ? studies::quickStabilitySweep() : studies::StabilitySweep{};
    if (!std::isfinite(o.assumedDelayMs) || o.assumedDelayMs > 10.0)
        throw core::Error(fmt::format("a delay of {} ms", o.assumedDelayMs), "--assume-delay",
                          "give 0 to 10; leave it out for the true one");
    sweep.assumedDelayS = 1e-3 * o.assumedDelayMs;
    if (!o.motions.empty()) {
        std::vector<studies::LoopMotion> chosen;
        for (const std::string& name : o.motions) {
            const auto found = std::find_if(sweep.motions.begin(), sweep.motions.end(),
                                            [&](studies::LoopMotion m) { return studies::nameOf(m) == name; });
            if (found == sweep.motions.end())
                throw core::Error(fmt::format("no motion is called \"{}\"", name), "--motion",
                                  "there are touch, slide, cut, wedge, between and head");
            chosen.push_back(*found);
        }
        sweep.motions = chosen;
    }
    core::prepareOutputFolder(o.out);
    studies::ProgressBar bar("touching, sliding, cutting, wedged, between two teeth, head and bur");
    const std::vector<studies::StabilityRow> rows = studies::stabilityMap(sweep, bar.listener());
    bar.finish();
    const std::filesystem::path out(o.out);
    core::writeFile(out / "stability.csv", studies::stabilityCsv(rows));
    for (const studies::LoopMotion motion : sweep.motions) {
        const std::filesystem::path picture = out / fmt::format("stability-{}.svg", studies::nameOf(motion));
        core::writeFile(picture, studies::stabilitySvg(sweep, rows, motion));
        std::size_t all = 0, off = 0, on = 0;
        for (const studies::StabilityRow& row : rows) {
            if (row.motion != motion) continue;
            ++all;
            off += row.off.holds;
            on += row.on.holds;
        }
        fmt::print("{}: passive in {} of {} loops with the controller off, in {} with it on; {}\n",
                   studies::nameOf(motion), off, all, on, picture.string());
    }
    fmt::print("{}\n", (out / "stability.csv").string());
}

void passivity(const PassivityOptions& o) {
    if (o.map || o.quick) return stabilityMap(o);
    if (!(o.limit >= 0.0) || !std::isfinite(o.limit))
        throw core::Error(fmt::format("a stiffness limit of {} N/mm", o.limit), "--stiffness-limit",
                          "give a positive number; 0: the device's own");
    studies::PassivitySweep sweep;
    sweep.parameters.stiffnessMultiplier = o.stiffness;
    sweep.parameters.dampingMultiplier = o.damping;
    if (o.limit > 0.0) sweep.capability.maxStiffnessNPerMm = o.limit;
    core::prepareOutputFolder(o.out);
    studies::ProgressBar bar("tapping every tissue");
    const std::vector<studies::PassivityRow> rows = studies::passivityMap(sweep, bar.listener());
    bar.finish();
    const std::filesystem::path out(o.out);
    core::writeFile(out / "passivity.csv", studies::passivityCsv(rows));
    core::writeFile(out / "passivity.svg", mapSvg(sweep, rows));
    for (const double delayS : sweep.delayS) {
        std::size_t all = 0, holding = 0, growing = 0;
        for (const studies::PassivityRow& row : rows)
            if (row.delayS == delayS) {
                ++all;
                holding += row.holds;
                growing += row.growing;
            }
        fmt::print("delay {:.0f} ms: passive in {} of {} loops, ripple at rest grows in {}\n", 1e3 * delayS, holding,
                   all, growing);
    }
    fmt::print("{}\n", (out / "passivity.svg").string());
}

}  // namespace

void addPassivityCommand(Command& app) {
    Command command = app.subcommand("passivity", "Map where hand, device and tooth stay passive together");
    const auto options = std::make_shared<PassivityOptions>();
    command.option("--out", options->out, "folder for the table and the pictures").required();
    command.option("--stiffness", options->stiffness, "multiplier on every tissue's stiffness").showDefault();
    command.option("--damping", options->damping, "multiplier on every tissue's damping").showDefault();
    command.option("--stiffness-limit", options->limit, "the device's stiffness limit [N/mm]; 0: its own");
    Option map = command.flag("--map", options->map,
                              "the whole stability map instead: contacts of 0.1 to 5 N/mm touched, slid over, cut and "
                              "wedged, with the passivity controller off and on (minutes)");
    Option quick = command.flag("--quick", options->quick, "a small part of that map (seconds)");
    command.option("--motion", options->motions,
                   "of the map: touch, slide, cut, wedge, between, head; several allowed");
    command.option("--assume-delay", options->assumedDelayMs,
                   "of the map: the longest delay [ms] the controller is told; left out: the true one");
    for (const char* name : {"--stiffness", "--damping", "--stiffness-limit"}) {
        map.excludes(name);
        quick.excludes(name);
    }
    command.footer(
        "The formula, the hands, the device and the controller are in docs/physics.md.\n"
        "Examples:\n  handpiece passivity --out out/passivity\n  handpiece passivity --map --out out/stability");
    command.callback([options] { passivity(*options); });
}

}  // namespace handpiece::cli
