// SPDX-License-Identifier: Apache-2.0
// handpiece bench: how long our own methods take on this machine.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/inputs.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/contact/hull/hull_method.h"
#include "studies/progress_bar.h"
#include "studies/timing.h"

namespace handpiece::cli {
namespace {

using Json = nlohmann::ordered_json;

struct BenchOptions {
    std::vector<std::size_t> faces{9760, 68152, 325312};
    BurInput bur;
    bool quick = false, json = false;
};

struct Row {
    std::size_t faces;
    std::string method, where;
    studies::Timing us, constant;
};

Json timingJson(const studies::Timing& t) {
    return {{"p50_us", t.p50}, {"p99_us", t.p99}, {"p999_us", t.p999}, {"max_us", t.max}};
}

void bench(const BenchOptions& o) {
    const std::vector<std::size_t> faces = o.quick ? std::vector<std::size_t>{9760} : o.faces;
    const std::size_t count = o.quick ? 2000 : 10000;
    const auto bur = loadBur(o.bur);
    std::vector<Row> rows;
    for (const std::size_t n : faces) {
        studies::ProgressBar bar(fmt::format("{} faces", n));
        const core::Progress progress = bar.listener();
        cases::Case made;
        made.name = fmt::format("starter {}", n);
        made.outer =
            starter::makeOuter(starter::ToothKind::lowerFirstMolar, n, [&](double f) { return progress(0.4 * f); });
        tooth::LoadSettings settings;
        settings.useCache = false;
        const auto tooth = tooth::loadModel(made, settings, [&](double f) { return progress(0.4 + 0.3 * f); });
        const auto field = contact::makeFieldMethod(tooth, bur);
        const auto hull = contact::makeHullMethod(tooth->outer, bur->mesh());
        for (const double depthMm : {0.1, -1.0}) {
            const std::string where = depthMm > 0.0 ? "touch" : "hover";
            const auto add = [&](contact::Method& method, bool withPatches, std::string name) {
                const std::vector<core::Pose> poses = studies::sweepAt(method, tooth->outer.bounds(), depthMm, count);
                const studies::Timing timing = studies::timeQueries(method, poses, withPatches);
                rows.push_back({n, std::move(name), where, timing, studies::timeConstantLoad(timing.p50, count)});
                if (!progress(0.7 + 0.3 * static_cast<double>(rows.size() % 6) / 6.0)) throw core::Error("cancelled");
            };
            add(*field, false, "exact");
            add(*field, true, "exact with patches");
            add(*hull, false, "hull");
        }
    }
    if (o.json) {
        Json out = Json::array();
        for (const Row& r : rows) {
            Json row{{"faces", r.faces}, {"method", r.method}, {"where", r.where}};
            row.update(timingJson(r.us));
            row["constant_load"] = timingJson(r.constant);
            out.push_back(std::move(row));
        }
        fmt::print("{}\n",
                   Json{{"machine", studies::machineDescription()}, {"bur", o.bur.name}, {"rows", out}}.dump(2));
        return;
    }
    fmt::print("{}\nbur {}, lower first molar; one query after the other along a sweep over the crown, {} places\n\n",
               studies::machineDescription(), o.bur.name, count);
    fmt::print("{:>7} {:<5} {:<19}{:>9}{:>9}{:>9}{:>9}   constant load:{:>7}{:>9}\n", "faces", "", "method", "p50 us",
               "p99", "p99.9", "worst", "p50", "p99.9");
    for (const Row& r : rows)
        fmt::print("{:>7} {:<5} {:<19}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.1f}{:>24.2f}{:>9.2f}\n", r.faces, r.where, r.method,
                   r.us.p50, r.us.p99, r.us.p999, r.us.max, r.constant.p50, r.constant.p999);
    fmt::print(
        "\ntouch: 0.1 mm deep, hover: 1 mm away. The constant load is plain arithmetic that takes as long as p50 and\n"
        "shows the machine's own tails. Other libraries beside ours: build/release/bench/contact_bench.\n");
}

}  // namespace

void addBenchCommand(Command& app) {
    Command command = app.subcommand("bench", "Time our contact methods on this machine");
    const auto options = std::make_shared<BenchOptions>();
    command.option("--faces", options->faces, "triangles of the teeth").showDefault();
    addBurOption(command, options->bur);
    command.flag("--quick", options->quick, "the coarsest tooth only, fewer places");
    command.flag("--json", options->json, "print JSON instead of a table");
    command.footer(
        "Examples:\n  handpiece bench --quick\n  handpiece bench --faces 68150 --bur round-4 --json\n"
        "Beside other libraries: cmake --preset release, then build/release/bench/contact_bench.");
    command.callback([options] { bench(*options); });
}

}  // namespace handpiece::cli
