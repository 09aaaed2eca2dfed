// SPDX-License-Identifier: Apache-2.0
// handpiece reproduce: the paper's tables and figures with ours beside them, on one page.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>

#include "cli/commands.h"
#include "cli/inputs.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/geometry/decimate.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/starter/paper.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/contact/hull/hull_method.h"
#include "studies/progress_bar.h"
#include "studies/reproduce.h"

namespace handpiece::cli {
namespace {

namespace fs = std::filesystem;

struct ReproduceOptions {
    MeshUnit unit;  ///< of --tooth
    std::string out, tooth, scan;
    double spacingMm = 0.0;
    bool quick = false, json = false, labels = false;
};

constexpr std::array kPercent{6.0, 12.0, 25.0, 50.0, 100.0};  // as the paper's resolutions are called
constexpr std::size_t kQuickTeeth = 2;

/// What is there from an earlier run is used when it has the faces wanted.
bool isThere(const fs::path& file, std::size_t faces) {
    std::error_code ec;
    constexpr std::uint64_t kHeader = 84, kFacet = 50;
    return faces > 0 && fs::file_size(file, ec) == kHeader + kFacet * faces && !ec;
}

void feel(studies::Surface& s, const fs::path& felt, const std::shared_ptr<const instrument::Bur>& bur) {
    s.tooth = tooth::loadModel(cases::readCase(felt));
    s.field = contact::makeFieldMethod(s.tooth, bur);
    s.hull = contact::makeHullMethod(s.tooth->outer, bur->mesh());
}

void addSurface(studies::Reproduction& r, studies::Surface s, const fs::path& felt) {
    geometry::TriangleMesh mesh;
    s.loadMs = studies::loadMsOf(s.file, mesh);
    s.vertices = mesh.vertices.size();
    s.faces = mesh.triangles.size();
    feel(s, felt, r.bur);
    r.surfaces.push_back(std::move(s));
}

/// The surface given with --tooth; empty without.
geometry::TriangleMesh ownSurface(const ReproduceOptions& o) {
    if (o.tooth.empty()) return {};
    ContactInputs inputs;
    inputs.tooth = o.tooth;
    inputs.unit = o.unit;
    cases::Case given = readToothOf(inputs);
    geometry::TriangleMesh own = std::move(!given.outer.triangles.empty() ? given.outer : given.parts.front().mesh);
    cases::requireSolid(own, o.tooth);
    return own;
}

void makeSurfaces(studies::Reproduction& r, const ReproduceOptions& o, const geometry::TriangleMesh& own) {
    const fs::path folder = fs::path(o.out) / "teeth";
    core::prepareOutputFolder(folder);
    r.step("the plane");
    geometry::writeMesh(folder / "plane.stl", starter::makePlane());
    geometry::writeMesh(folder / "slab.stl", starter::makePlaneSlab());
    studies::Surface plane;
    plane.name = starter::kPaperPlane.name;
    plane.file = folder / "plane.stl";
    plane.paperVertices = starter::kPaperPlane.vertices;
    plane.paperFaces = starter::kPaperPlane.faces;
    addSurface(r, std::move(plane), folder / "slab.stl");

    const auto resolutions = starter::paperResolutions();
    const std::size_t count = o.quick ? kQuickTeeth : resolutions.size();
    for (std::size_t i = 0; i < count; ++i) {
        r.step(fmt::format("the tooth of {}", resolutions[i].name));
        studies::Surface s;
        s.name = resolutions[i].name;
        s.paperVertices = resolutions[i].vertices;
        s.paperFaces = resolutions[i].faces;
        if (own.triangles.empty()) {
            s.file = folder / fmt::format("starter-{:03.0f}.stl", kPercent[i]);
            if (!isThere(s.file, (s.paperFaces + 1) / 2 * 2))
                geometry::writeMesh(s.file, starter::makeOuter(starter::ToothKind::lowerFirstMolar, s.paperFaces));
        } else {
            s.file = folder / fmt::format("own-{:03.0f}.stl", kPercent[i]);
            const auto faces = static_cast<std::size_t>(0.01 * kPercent[i] * static_cast<double>(own.triangles.size()));
            geometry::writeMesh(s.file, geometry::decimate(own, faces).mesh);
        }
        const fs::path felt = s.file;
        addSurface(r, std::move(s), felt);
    }
}

void introduce(studies::Reproduction& r, const ReproduceOptions& o) {
    r.report.paragraph(
        "Each experiment of the paper with its numbers as printed and ours measured now, by both contact methods: the "
        "field (ours, the concave tooth) and the hull (the paper's own way: convex hulls, GJK and EPA).");
    r.report.paragraph(fmt::format("Measured on: {}. Bur: the paper's, {} vertices. Tooth: {}.{}",
                                   studies::machineDescription(), r.bur->mesh().vertices.size(),
                                   o.tooth.empty() ? "the starter molar" : fs::path(o.tooth).filename().string(),
                                   o.quick ? " Quick: the two coarsest teeth, shorter drops." : ""),
                       report::HtmlReport::Tone::note);
}

void conclude(studies::Reproduction& r) {
    r.report.heading("What did not come out as it should");
    if (r.remarks.empty()) r.report.paragraph("Nothing: every check above holds.");
    for (const std::string& remark : r.remarks)
        r.report.paragraph(remark);
    r.results["remarks"] = r.remarks;
}

void reproduce(const ReproduceOptions& o) {
    const geometry::TriangleMesh own = ownSurface(o);  // first: a bad one leaves no folder behind
    core::prepareOutputFolder(o.out);
    studies::ProgressBar bar("reproducing");
    const core::Progress progress = bar.listener();
    // Surfaces, timings, steps and drops of both methods on each, cuts on each, sixteen runs that touch, six that cut,
    // four pictures; slices, their surface, five resolutions drawn.
    const double surfaces = 1.0 + static_cast<double>(o.quick ? kQuickTeeth : kPercent.size());
    const double steps = surfaces * (2.0 + 3.0 * 2.0) + 39.0;
    double done = 0.0;
    studies::Reproduction r;
    r.quick = o.quick;
    r.out = o.out;
    r.ownTooth = !o.tooth.empty();
    r.scan = {o.scan, o.spacingMm > 0.0 ? std::optional(o.spacingMm) : std::nullopt, o.labels};
    r.step = [&](const std::string&) { core::report(progress, std::min(1.0, done++ / steps)); };
    r.bur = std::make_shared<instrument::Bur>(instrument::makeBur("paper"));
    introduce(r, o);
    r.results["machine"] = studies::machineDescription();
    makeSurfaces(r, o, own);
    studies::reproduceTables(r);
    studies::reproduceFigures(r);
    conclude(r);
    bar.finish();
    const std::string json = r.results.dump(1, ' ', false, studies::Json::error_handler_t::replace) + "\n";
    core::writeFile(fs::path(o.out) / "results.json", json);
    core::writeFile(fs::path(o.out) / "report.html", r.report.text());
    if (o.json) {
        fmt::print("{}", json);
        return;
    }
    fmt::print("{}: the paper's tables and figures, ours beside them\n{}: every number\n",
               (fs::path(o.out) / "report.html").string(), (fs::path(o.out) / "results.json").string());
    for (const std::string& remark : r.remarks)
        fmt::print("  not as it should be: {}\n", remark);
}

}  // namespace

void addReproduceCommand(Command& app) {
    Command command =
        app.subcommand("reproduce", "The paper's tables and figures with ours beside them: report.html, results.json");
    const auto options = std::make_shared<ReproduceOptions>();
    command.option("--out", options->out, "folder for the report; the teeth are kept in it").required();
    command.option("--tooth", options->tooth, "case folder or mesh file instead of the starter molar");
    addUnitOptions(command, options->unit, false);
    Option scan = command.option("--scan", options->scan,
                                 "slices for Table II instead of the starter molar as the phantom scanner images it");
    command.option("--spacing", options->spacingMm, "distance of the scan's voxels [mm], where its files do not tell")
        .check(positive())
        .needs(scan);
    command.flag("--labels", options->labels, "the scan holds tissue numbers, not grey values").needs(scan);
    command.flag("--quick", options->quick, "the two coarsest teeth and shorter drops only");
    command.flag("--json", options->json, "print results.json");
    command.footer(
        "Examples:\n  handpiece reproduce --quick --out paper\n  handpiece reproduce --tooth molar.stl --out paper");
    command.callback([options] { reproduce(*options); });
}

}  // namespace handpiece::cli
