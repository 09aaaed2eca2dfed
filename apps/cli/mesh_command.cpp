// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/inputs.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/base/geometry/repair.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "studies/told_json.h"

namespace handpiece::cli {
namespace {

using Json = nlohmann::ordered_json;
using geometry::MeshReport;

void row(std::string_view label, const std::string& value) {
    fmt::print("  {:<22} {}\n", label, value);
}

std::string counted(std::size_t n, std::string_view one, std::string_view many) {
    return fmt::format("{} {}", n, n == 1 ? one : many);
}

std::string at(const std::optional<core::Vec3>& p) {
    return p ? fmt::format(", the first at ({:.3f}, {:.3f}, {:.3f})", p->x(), p->y(), p->z()) : std::string();
}

void printReport(const MeshReport& r) {
    const core::Vec3 size = r.boxMm.size(), &low = r.boxMm.min, &high = r.boxMm.max;
    row("vertices",
        fmt::format("{}{}{}", r.vertices,
                    r.duplicateVertices ? fmt::format(", {} at the place of another", r.duplicateVertices) : "",
                    r.unusedVertices ? fmt::format(", {} unused", r.unusedVertices) : ""));
    row("faces",
        fmt::format("{}{}{}", r.faces, r.degenerateFaces ? fmt::format(", {} without area", r.degenerateFaces) : "",
                    r.duplicateFaces ? fmt::format(", {} twice there", r.duplicateFaces) : ""));
    row("box", fmt::format("{:.4g} x {:.4g} x {:.4g} mm, from ({:.3f}, {:.3f}, {:.3f}) to ({:.3f}, {:.3f}, {:.3f})",
                           size.x(), size.y(), size.z(), low.x(), low.y(), low.z(), high.x(), high.y(), high.z()));
    row("area", fmt::format("{:.6g} mm2", r.areaMm2));
    row("volume", r.closed() ? fmt::format("{:.6g} mm3", r.volumeMm3) : "none, the surface is not closed");
    row("shells",
        fmt::format("{}{}", r.shells, r.insideOutShells ? fmt::format(", {} inside out", r.insideOutShells) : ""));
    row("open edges", r.openEdges ? fmt::format("{} around {}{}", r.openEdges,
                                                counted(r.boundaryLoops, "hole", "holes"), at(r.firstOpenEdgeMm))
                                  : "0");
    row("non-manifold edges", fmt::format("{}{}", r.nonManifoldEdges, at(r.firstNonManifoldEdgeMm)));
    row("non-manifold vertices", fmt::format("{}{}", r.nonManifoldVertices, at(r.firstNonManifoldVertexMm)));
    row("flipped faces", fmt::format("{}{}{}", r.flippedFaces, r.flippedFaces ? at(r.firstFlippedFaceMm) : "",
                                     r.orientable ? "" : "; the surface has only one side"));
    row("Euler characteristic",
        fmt::format("{}{}", r.eulerCharacteristic, r.genus ? fmt::format(", genus {}", *r.genus) : ""));
    row("probable unit", fmt::format("{} ({})", geometry::unitName(r.unit.unit), r.unit.reason));
}

struct RepairOptions {
    std::string in, out;
    MeshUnit unit;
    double weldMm = -1.0, baseDepthMm = -1.0;
    bool keepDebris = false, base = false, json = false;

    [[nodiscard]] geometry::RepairSettings settings() const {
        geometry::RepairSettings s;
        s.weldMm = weldMm;
        if (keepDebris) s.debrisAreaShare = 0.0;
        s.base = base || baseDepthMm >= 0.0;
        s.baseDepthMm = baseDepthMm;
        return s;
    }
};

/// What comes out of it as a file is a solid, or it is refused: a case takes it.
geometry::RepairReport mend(geometry::TriangleMesh& mesh, const geometry::RepairSettings& settings,
                            const std::string& in, geometry::MeshFormat format) {
    geometry::RepairReport report;
    try {
        report = geometry::repair(mesh, settings);
    } catch (const core::Error& e) {
        throw core::Error(e.problem(), e.where() == "mesh" ? in : e.where(), e.remedy());
    }
    geometry::requireUncrossed(report, settings, in);
    if (format != geometry::MeshFormat::stl) return report;
    geometry::ReadNotes ignored;
    const geometry::TriangleMesh rounded =
        geometry::readMesh(geometry::stlBytes(mesh, in), geometry::MeshFormat::stl, in, &ignored);
    const MeshReport after = geometry::inspect(rounded);
    if (!after.closed() || !after.oriented() || !geometry::selfIntersections(rounded, 1).empty())
        throw core::Error(
            "the mended surface is a solid no more once it is rounded to the short numbers of an STL file", in,
            "write it as .ply");
    return report;
}

/// Whether and how it can be mended: tried, not guessed.
struct Prospect {
    bool isNeeded = false, isPossible = false, isByBase = false;
    std::string reason;  ///< why not
};

Prospect prospectOf(const geometry::TriangleMesh& mesh, const MeshReport& r, std::size_t crossings,
                    const std::string& file) {
    Prospect prospect;
    prospect.isNeeded = !r.closed() || !r.oriented() || crossings > 0;
    if (!prospect.isNeeded) return prospect;
    for (const bool base : {false, true}) {
        geometry::RepairSettings settings;
        settings.base = base;
        geometry::TriangleMesh work = mesh;
        try {
            (void)mend(work, settings, file, geometry::MeshFormat::stl);
            prospect.isPossible = true;
            prospect.isByBase = base;
            return prospect;
        } catch (const core::Error& e) {
            if (!base) prospect.reason = e.problem();
        }
        if (r.openEdges == 0) break;
    }
    return prospect;
}

std::string flawOf(const MeshReport& r) {
    if (!r.closed()) return "not closed";
    return r.oriented() ? "closed and oriented, but it crosses itself" : "closed, but not consistently oriented";
}

std::string verdict(const MeshReport& r, const Prospect& prospect) {
    if (prospect.isPossible)
        return fmt::format("{}: handpiece mesh repair{} mends it", flawOf(r), prospect.isByBase ? " --base" : "");
    if (prospect.isNeeded)
        return fmt::format("{}, and handpiece mesh repair refuses it: {}", flawOf(r), prospect.reason);
    if (r.unit.unit != geometry::LengthUnit::millimetre)
        return fmt::format("closed, oriented, not crossing itself, but probably not in millimetres: {}",
                           r.unit.unit == geometry::LengthUnit::unknown
                               ? "give --unit or --scale"
                               : fmt::format("--unit {} makes it {:.4g} mm", geometry::unitName(r.unit.unit),
                                             r.unit.millimetresPerUnit * r.boxMm.size().norm()));
    return "closed, oriented, not crossing itself: a solid";
}

void info(const std::string& file, const MeshUnit& unit, bool json) {
    geometry::ReadNotes notes;
    const geometry::ColouredMesh read = unit.readColoured(file, &notes);
    const geometry::TriangleMesh& mesh = read.mesh;
    const MeshReport report = geometry::inspect(mesh);
    const std::vector<geometry::CrossingFaces> crossings = geometry::selfIntersections(mesh);
    const Prospect prospect = prospectOf(mesh, report, crossings.size(), file);
    if (json) {
        Json out{{"file", file}};
        out.update(studies::toJson(report));
        out["crossing_faces"] = crossings.size();
        out["colours"] = !read.colours.empty();
        out["repair"] = nullptr;
        if (prospect.isNeeded)
            out["repair"] = {{"possible", prospect.isPossible},
                             {"base", prospect.isByBase},
                             {"reason", prospect.isPossible ? Json(nullptr) : Json(prospect.reason)}};
        out["notes"] = notes;
        fmt::print("{}\n", out.dump(2, ' ', false, Json::error_handler_t::replace));
        return;
    }
    fmt::print("{}\n", file);
    printReport(report);
    row("colours", read.colours.empty() ? "none" : "at its vertices");
    row("crossing faces",
        crossings.empty() ? "0"
                          : fmt::format("{}{}", counted(crossings.size(), "pair", "pairs"), at(crossings[0].pointMm)));
    row("verdict", verdict(report, prospect));
}

void repair(const RepairOptions& options) {
    // Before the work, not after it: an output that cannot be would waste the wait.
    const geometry::MeshFormat format = geometry::meshFormatOf(options.out);
    if (format != geometry::MeshFormat::stl && format != geometry::MeshFormat::ply)
        throw core::Error("meshes are written as .stl or .ply", options.out, "name the output so");
    geometry::ReadNotes notes;
    const geometry::ColouredMesh read = options.unit.readColoured(options.in, &notes);
    geometry::TriangleMesh mesh = read.mesh;
    const geometry::RepairReport r = mend(mesh, options.settings(), options.in, format);
    const bool keepsColours = !read.colours.empty() && format == geometry::MeshFormat::ply;
    geometry::writeMesh(
        options.out, mesh,
        keepsColours ? geometry::coloursFrom(read.mesh, read.colours, mesh) : geometry::VertexColours());
    if (options.json) {
        Json out{{"file", options.in}, {"output", options.out}};
        out.update(studies::toJson(r));
        out["colours"] = keepsColours;
        out["notes"] = notes;
        fmt::print("{}\n", out.dump(2, ' ', false, Json::error_handler_t::replace));
        return;
    }
    fmt::print("{} -> {}\n", options.in, options.out);
    row("welded", fmt::format("{} (within {:.3g} mm)", counted(r.weldedVertices, "vertex", "vertices"), r.weldMm));
    row("removed",
        fmt::format("{} degenerate, {} double and {} fin faces ({:.3g} mm2 of fins)", r.removedDegenerateFaces,
                    r.removedDuplicateFaces, r.removedFinFaces, r.removedFinAreaMm2));
    row("cut apart", fmt::format("{}, {} added", counted(r.splitEdges, "edge", "edges"),
                                 counted(r.splitVertices, "vertex", "vertices")));
    row("dropped",
        fmt::format("{} ({}, {:.3g} mm2, {:.3g} mm3)", counted(r.droppedShells, "loose shell", "loose shells"),
                    counted(r.droppedFaces, "face", "faces"), r.droppedAreaMm2, r.droppedVolumeMm3));
    row("turned", counted(r.turnedFaces, "face", "faces"));
    row("closed",
        fmt::format("{} with {}", counted(r.holes.size(), "hole", "holes"), counted(r.addedFaces, "face", "faces")));
    constexpr std::size_t kShown = 10;
    for (std::size_t i = 0; i < std::min(kShown, r.holes.size()); ++i)
        row("", fmt::format("{} edges, {:.4g} mm around, {:.4g} mm2, at ({:.3f}, {:.3f}, {:.3f})", r.holes[i].edges,
                            r.holes[i].perimeterMm, r.holes[i].areaMm2, r.holes[i].centreMm.x(),
                            r.holes[i].centreMm.y(), r.holes[i].centreMm.z()));
    if (r.holes.size() > kShown) row("", fmt::format("and {} smaller ones", r.holes.size() - kShown));
    for (const geometry::MadeBase& b : r.bases)
        row("base",
            fmt::format("under a border of {} edges, {:.4g} mm around; {:.3g} mm below its lowest place; {:.4g} "
                        "mm2 of walls and floor",
                        b.edges, b.perimeterMm, b.depthMm, b.areaMm2));
    if (r.turnedFlatFaces > 0) row("turned", counted(r.turnedFlatFaces, "face without height", "faces without height"));
    if (r.removedCrossingFaces > 0)
        row("replaced", fmt::format("{}, {:.3g} mm2",
                                    counted(r.removedCrossingFaces, "face that crossed others or lay beside one",
                                            "faces that crossed others or lay beside one"),
                                    r.removedCrossingAreaMm2));
    row("lost", fmt::format("{:.3g} mm2 of the outer surface's {:.6g} mm2", r.lostAreaMm2, r.after.areaMm2));
    if (!read.colours.empty())
        row("colours", keepsColours ? "kept; what closes a hole has those of its border"
                                    : "left out: an STL holds none, name the output .ply to keep them");
    fmt::print("the result:\n");
    printReport(r.after);
    row("crossing faces", std::to_string(r.crossingFaces));
    row("verdict", verdict(r.after, {}));
}

}  // namespace

void addMeshCommand(Command& app) {
    Command mesh = app.subcommand("mesh", "Tell what is wrong with a mesh, and mend it");
    mesh.requireSubcommand();
    mesh.footer(
        "Examples:\n"
        "  handpiece mesh info molar.stl\n"
        "  handpiece mesh info molar.stl --json\n"
        "  handpiece mesh repair scan.ply molar.stl");

    struct InfoOptions {
        std::string file;
        MeshUnit unit;
        bool json = false;
    };
    const auto infoOptions = std::make_shared<InfoOptions>();
    Command infoCommand = mesh.subcommand("info", "Count the faces and the flaws of a mesh, measure it");
    infoCommand.option("FILE", infoOptions->file, "STL, PLY or OBJ").required();
    addUnitOptions(infoCommand, infoOptions->unit);
    infoCommand.flag("--json", infoOptions->json, "Print JSON instead of a table");
    infoCommand.footer("Example:\n  handpiece mesh info molar.stl");
    infoCommand.callback([infoOptions] { info(infoOptions->file, infoOptions->unit, infoOptions->json); });

    const auto options = std::make_shared<RepairOptions>();
    Command repairCommand = mesh.subcommand("repair", "Close holes, orient, weld, drop debris; say what was done");
    repairCommand.option("IN", options->in, "STL, PLY or OBJ").required();
    repairCommand.option("OUT", options->out, "Where to write the result, .stl or .ply").required();
    addUnitOptions(repairCommand, options->unit);
    repairCommand
        .option("--weld", options->weldMm, "Vertices nearer than this become one [default: 1e-5 of the box's diagonal]")
        .typeName("MM")
        .check(nonNegative());
    repairCommand.flag("--keep-debris", options->keepDebris,
                       "Keep shells of less than 1 % of the largest shell's area");
    repairCommand.flag("--base", options->base,
                       "Stand the border of an open scan on a flat base; other holes are closed as usual");
    repairCommand
        .option(
            "--base-depth", options->baseDepthMm,
            "From the border's lowest place to the floor, with --base [default: a twentieth of the box's diagonal, 1 "
            "to 5 mm]")
        .typeName("MM")
        .check(range(0.01, 1000.0));
    repairCommand.flag("--json", options->json, "Print JSON instead of a table");
    repairCommand.footer(
        "Examples:\n"
        "  handpiece mesh repair scan.stl molar.stl\n"
        "  handpiece mesh repair arch.stl model.stl --base\n"
        "  handpiece mesh repair inches.obj molar.stl --unit inch\n"
        "  handpiece mesh repair scan.ply molar.stl --weld 0.01 --keep-debris");
    repairCommand.callback([options] { repair(*options); });
}

}  // namespace handpiece::cli
