// SPDX-License-Identifier: Apache-2.0
// handpiece export: a session's samples or events as CSV; what is left of each tissue as STL; results as xAPI.
#include <fmt/format.h>

#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "handpiece/app/simulation/tissue_export.h"
#include "handpiece/app/statements/statements.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/case/tissue.h"
#include "handpiece/record/session/session_reader.h"
#include "handpiece/school/store/store.h"
#include "studies/csv.h"
#include "studies/progress_bar.h"

namespace handpiece::cli {
namespace {

struct ExportOptions {
    std::string session, out = "-";
    bool csv = false, events = false, stl = false, xapi = false, noCache = false;
    statements::Actor actor;
    double voxelUm = 50.0;
    std::size_t threads = 0;
};

void writeRecord(std::string& out, const session::Record& r, double rateHz) {
    const session::Inputs in = session::inputsOf(r);
    const auto to = std::back_inserter(out);
    fmt::format_to(to, "{},{:.6f}", r.tick, static_cast<double>(r.tick) / rateHz);
    for (const double x : in.positionMm)
        fmt::format_to(to, ",{:.7f}", x);
    for (const double x : in.orientation)
        fmt::format_to(to, ",{:.10f}", x);
    for (const auto* three : {&r.velocityMmS, &r.forceN, &r.torqueNmm})
        for (const float x : *three)
            fmt::format_to(to, ",{:.4f}", x);
    fmt::format_to(to, ",{:.5f},{:.0f},{:.5f},{},{:.4f},{:.4f},{},{},{}", r.depthMm, r.speedRpm, in.pedal, r.buttons,
                   r.loadTorqueNmm, r.feedMmS, cases::properties(static_cast<cases::Tissue>(r.tissue)).name, r.flags,
                   r.elapsedPeriods);
    for (std::size_t t = 1; t < cases::kTissueCount; ++t)
        fmt::format_to(to, ",{:.6f}", r.removedMm3[t]);
    out += '\n';
}

void writeSamples(const session::SessionReader& reader, studies::TextWriter& out) {
    std::string text =
        "tick,t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,vx_mm_s,vy_mm_s,vz_mm_s,fx_N,fy_N,fz_N,tx_Nmm,ty_Nmm,tz_Nmm,depth_mm,rpm,"
        "pedal,buttons,load_torque_Nmm,feed_mm_s,tissue,flags,elapsed_periods";
    for (std::size_t t = 1; t < cases::kTissueCount; ++t)
        fmt::format_to(std::back_inserter(text), ",removed_{}_mm3",
                       cases::properties(static_cast<cases::Tissue>(t)).name);
    text += '\n';
    constexpr std::size_t kStretch = 10000;
    for (std::uint64_t first = 0; first < reader.size(); first += kStretch) {
        if (studies::cancelled()) throw core::Error("cancelled");
        for (const session::Record& r : reader.records(first, kStretch))
            writeRecord(text, r, reader.info().rateHz);
        out.write(text);
        text.clear();
    }
    out.write(text);
}

/// As RFC 4180 has it: in quotes, which are doubled inside.
std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text)
        result += c == '"' ? std::string("\"\"") : std::string(1, c);
    return result + '"';
}

void writeEvents(const session::SessionReader& reader, studies::TextWriter& out) {
    out.write("tick,t_s,name,text\n");
    for (const session::Event& e : reader.events()) {
        out.write(fmt::format("{},{:.6f},{},{}\n", e.tick, static_cast<double>(e.tick) / reader.info().rateHz,
                              quoted(e.name), quoted(e.text)));
    }
}

/// Into a folder: a closed surface of each tissue.
void exportSurfaces(const ExportOptions& o) {
    if (o.csv || o.events)
        throw core::Error("a table and surfaces cannot be written at once", "export", "give --csv or --stl");
    if (o.out == "-") throw core::Error("surfaces need a folder", "--out", "name one");
    core::setThreadCount(o.threads);
    studies::ProgressBar preparing("preparing the tooth");
    const simulation::ToothOfFile found =
        simulation::toothOf(o.session, 1e-3 * o.voxelUm, !o.noCache, preparing.listener());
    preparing.finish();
    studies::ProgressBar bar("surfaces");
    const auto files = simulation::exportTissues(found.base, found.state, o.out, bar.listener());
    bar.finish();
    for (const std::filesystem::path& file : files)
        fmt::print("{}\n", file.string());
}

/// Whatever the store of results holds.
void exportStatements(const ExportOptions& o) {
    if (o.csv || o.events || o.stl)
        throw core::Error("statements are not written with anything else", "export", "give --xapi alone");
    if (!std::filesystem::is_regular_file(o.session))
        throw core::Error("there is no such file", o.session, "give the store of results, results.db");
    school::Store store(o.session);
    std::map<std::string, std::string> titles;
    for (const school::Exercise& exercise : store.exercises())
        titles[exercise.id] = exercise.title;
    std::vector<statements::Work> works;
    for (const school::Attempt& attempt : store.attempts())
        works.push_back({attempt, titles[attempt.exercise], store.returnedOf(attempt.id)});
    studies::TextWriter out(o.out);
    out.write(statements::statementsOf(works, o.actor));
    out.commit();
}

void exportSession(const ExportOptions& o) {
    if (o.stl) return exportSurfaces(o);
    if (o.xapi) return exportStatements(o);
    if (!o.csv) throw core::Error("there is no format to export to", "export", "add --csv, --stl or --xapi");
    const session::SessionReader reader(o.session);
    studies::TextWriter out(o.out);
    if (o.events) {
        writeEvents(reader, out);
    } else {
        writeSamples(reader, out);
    }
    out.commit();
}

}  // namespace

void addExportCommand(Command& app) {
    Command command =
        app.subcommand("export", "A session's samples or events as a table; tissues as surfaces; results as xAPI");
    const auto options = std::make_shared<ExportOptions>();
    command
        .option("session", options->session,
                "session file (.h5); one that was cut off is read as far as it goes. With --stl also an attempt or "
                "a case: folder, .handpiece file or mesh; with --xapi the store of results, results.db")
        .required();
    command.flag("--csv", options->csv, "as comma-separated values");
    command.flag("--events", options->events, "what happened at which tick, instead of the samples");
    command.flag("--stl", options->stl,
                 "what is left of each tissue as a closed surface of its own: enamel.stl, dentine.stl, ... (mm)");
    command.flag("--xapi", options->xapi, "results as statements for a learning record store (xAPI 1.0.3, JSON)");
    command.option("--person", options->actor.code, "of --xapi: the code that the school knows the person by");
    command.option("--home-page", options->actor.homePage, "of --xapi: the school's address, https://...");
    command.option("--out", options->out, "file to write, - for standard output; of --stl the folder").showDefault();
    command.option("--voxel", options->voxelUm, "of --stl for a case or a mesh, voxel of the field [um], 10 to 400")
        .check(range(10.0, 400.0))
        .showDefault();
    command.flag("--no-cache", options->noCache, "of --stl: build the fields anew");
    command.option("--threads", options->threads, "threads for long work; 0: all cores")
        .check(range(std::size_t{0}, std::size_t{1024}))
        .showDefault();
    command.footer(
        "One row a tick: pose of the bur's tip as read from the device, force on the hand, speed, what was removed.\n"
        "--stl writes the tooth as a session leaves it, as an attempt was saved, or as a case is.\n"
        "Example:\n  handpiece export session.h5 --csv --out session.csv\n"
        "  handpiece export session.h5 --stl --out tissues\n"
        "  handpiece export results.db --xapi --person s017 --home-page https://school.example --out statements.json");
    command.callback([options] { exportSession(*options); });
}

}  // namespace handpiece::cli
