// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/inputs.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/utf8.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/case/case_check.h"
#include "handpiece/model/case/work_on.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/scan/landmarks/find_landmarks.h"
#include "studies/progress_bar.h"

namespace handpiece::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using cases::Case;
using cases::Part;

void print(const Json& json) {
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
}

Json toJson(const core::Vec3& v) {
    return {v.x(), v.y(), v.z()};
}

Json toJson(const Part& part) {
    return {{"name", part.name},
            {"tissue", cases::properties(part.tissue).name},
            {"priority", part.priority},
            {"faces", part.mesh.triangles.size()},
            {"volume_mm3", geometry::enclosedVolumeMm3(part.mesh)},
            {"colours", !part.colours.empty()}};
}

Json toJson(const cases::Exercise& e) {
    Json json{{"title", e.title},
              {"instructions", e.instructions},
              {"bur", e.bur},
              {"allowed_burs", e.allowedBurs},
              {"locked_helps", e.lockedHelps},
              {"view", nullptr}};
    if (e.view)
        json["view"] = {
            {"eye_mm", toJson(e.view->eyeMm)}, {"target_mm", toJson(e.view->targetMm)}, {"up", toJson(e.view->up)}};
    return json;
}

Json toJson(const Case& c, const std::string& place) {
    Json json{{"case", place},
              {"name", c.name},
              {"kind", c.kind},
              {"fdi", c.fdiNumber == 0 ? Json(nullptr) : Json(c.fdiNumber)},
              {"buccal", c.buccalSign == 0 ? Json(nullptr) : Json(c.buccalSign > 0 ? "+y" : "-y")},
              {"content_key", fmt::format("{:016x}", contentKey(c))},
              {"outer", nullptr},
              {"parts", Json::array()},
              {"scenery", Json::array()},
              {"teeth", Json::array()},
              {"changes_tissues", !c.tissuesToml.empty()},
              {"tissues", Json::object()},
              {"exercise", c.exercise ? toJson(*c.exercise) : Json(nullptr)}};
    if (!c.outer.triangles.empty()) {
        const core::Box box = c.outer.bounds();
        json["outer"] = {{"faces", c.outer.triangles.size()},
                         {"volume_mm3", geometry::enclosedVolumeMm3(c.outer)},
                         {"box_min_mm", toJson(box.min)},
                         {"box_max_mm", toJson(box.max)},
                         {"colours", !c.outerColours.empty()}};
    }
    for (const Part& part : c.parts) {
        json["parts"].push_back(toJson(part));
        const cases::TissueProperties& t = c.tissues.of(part.tissue);
        json["tissues"][std::string(t.name)] = {
            {"stiffness_fraction", t.stiffnessFraction},
            {"damping_n_s_per_mm", t.dampingNSPerMm},
            {"friction", t.friction},
            {"cutting_mm2_per_n", t.cuttingMm2PerN},
            {"colour", fmt::format("#{:02x}{:02x}{:02x}", t.colour[0], t.colour[1], t.colour[2])},
            {"priority", t.priority}};
    }
    for (const Part& part : c.scenery)
        json["scenery"].push_back(toJson(part));
    json["landmarks"] = c.landmarks.size();
    for (const cases::PlacedTooth& other : c.others)
        json["teeth"].push_back({{"fdi", other.fdiNumber == 0 ? Json(nullptr) : Json(other.fdiNumber)},
                                 {"name", other.name},
                                 {"cuttable", other.isCuttable},
                                 {"faces", other.surface().triangles.size()},
                                 {"colours", !other.surfaceColours().empty()},
                                 {"position_mm", toJson(other.inCase.positionMm)},
                                 {"landmarks", other.landmarks.size()}});
    return json;
}

void row(std::string_view label, const std::string& value) {
    fmt::print("  {:<14} {}\n", label, core::printable(value));
}

const char* coloursNote(const geometry::VertexColours& colours) {
    return colours.empty() ? "" : ", with the scan's colours";
}

void printPart(const Part& part, std::string_view label) {
    row(label, fmt::format("{} ({}, priority {}): {} faces, {:.4g} mm3{}", part.name,
                           cases::properties(part.tissue).name, part.priority, part.mesh.triangles.size(),
                           geometry::enclosedVolumeMm3(part.mesh), coloursNote(part.colours)));
}

void info(const std::string& place, bool json) {
    const Case c = cases::readCase(place);
    if (json) return print(toJson(c, place));
    fmt::print("{}\n", place);
    row("name", c.name);
    if (!c.kind.empty()) row("kind", c.kind);
    if (c.fdiNumber != 0) row("FDI number", std::to_string(c.fdiNumber));
    if (c.buccalSign != 0) row("buccal", c.buccalSign > 0 ? "+y" : "-y");
    if (!c.outer.triangles.empty()) {
        const core::Vec3 size = c.outer.bounds().size();
        row("outer", fmt::format("{} faces, {:.4g} mm3, {:.4g} x {:.4g} x {:.4g} mm{}", c.outer.triangles.size(),
                                 geometry::enclosedVolumeMm3(c.outer), size.x(), size.y(), size.z(),
                                 coloursNote(c.outerColours)));
    }
    for (const Part& part : c.parts)
        printPart(part, "part");
    for (const Part& part : c.scenery)
        printPart(part, "scenery");
    for (const cases::PlacedTooth& other : c.others)
        row("tooth", fmt::format("{}{}: {} faces{}{}", other.fdiNumber == 0 ? "" : fmt::format("{} ", other.fdiNumber),
                                 other.name, other.surface().triangles.size(), coloursNote(other.surfaceColours()),
                                 other.isCuttable ? "" : ", not to be cut"));
    if (!c.landmarks.empty()) row("landmarks", std::to_string(c.landmarks.size()));
    if (!c.tissuesToml.empty()) row("tissues", "a table of its own");
    if (c.exercise) {
        const cases::Exercise& e = *c.exercise;
        row("exercise", e.title.empty() ? "untitled" : std::string(cases::inLanguage(e.title, "en")));
        if (!e.bur.empty()) row("starts with", e.bur);
        if (!e.allowedBurs.empty()) row("allowed burs", fmt::format("{}", fmt::join(e.allowedBurs, ", ")));
        if (!e.lockedHelps.empty()) row("locked", fmt::format("{}", fmt::join(e.lockedHelps, ", ")));
    }
    row("content key", fmt::format("{:016x}", contentKey(c)));
}

/// Of the tooth, and of what its exercise names.
std::vector<cases::CaseFinding> findingsOf(const Case& c) {
    studies::ProgressBar bar("checking the case");
    std::vector<cases::CaseFinding> findings = cases::checkCase(c, bar.listener());
    bar.finish();
    if (!c.exercise) return findings;
    std::vector<std::string> burs = c.exercise->allowedBurs;
    if (burs.empty() && !c.exercise->bur.empty()) burs.push_back(c.exercise->bur);
    for (const std::string& bur : burs) {
        try {
            (void)instrument::makeBur(bur);
        } catch (const core::Error& e) {
            findings.insert(findings.begin(),
                            {true, "exercise", fmt::format("{}: {}", e.problem(), e.where()), 0.0, ""});
        }
    }
    return findings;
}

[[noreturn]] void refuse(const std::vector<cases::CaseFinding>& findings, const std::string& place) {
    const auto errors = std::count_if(findings.begin(), findings.end(), [](const auto& f) { return f.isError; });
    const cases::CaseFinding& first = findings.front();
    throw core::Error(fmt::format("the case cannot be used: {}{}{}",
                                  first.part.empty() ? "" : fmt::format("part \"{}\": ", first.part), first.what,
                                  errors > 1 ? fmt::format("; and {} more", errors - 1) : ""),
                      place, first.remedy);
}

bool isWrong(const std::vector<cases::CaseFinding>& findings) {
    return std::any_of(findings.begin(), findings.end(), [](const auto& f) { return f.isError; });
}

void check(const std::string& place, bool json) {
    const std::vector<cases::CaseFinding> findings = findingsOf(cases::readCase(place));
    const bool wrong = isWrong(findings);
    if (json) {
        Json list = Json::array();
        for (const cases::CaseFinding& f : findings)
            list.push_back({{"error", f.isError},
                            {"part", f.part.empty() ? Json(nullptr) : Json(f.part)},
                            {"what", f.what},
                            {"by_mm", f.byMm},
                            {"remedy", f.remedy}});
        print({{"case", place}, {"usable", !wrong}, {"findings", std::move(list)}});
    } else {
        for (const cases::CaseFinding& f : findings)
            fmt::print("  {:<7} {}{}{}\n", f.isError ? "error" : "note",
                       f.part.empty() ? "" : core::printable(f.part) + ": ", core::printable(f.what),
                       f.remedy.empty() ? "" : fmt::format(" ({})", f.remedy));
        if (!wrong) fmt::print("{}: can be felt and cut\n", place);
    }
    if (wrong) refuse(findings, place);
}

struct NewOptions {
    std::string out, outer, name, kind, buccal, tissues;
    std::vector<std::string> parts, scenery;
    MeshUnit unit;
    int fdi = 0;
};

/// TISSUE[:PRIORITY]=FILE
Part partOf(const std::string& text, const cases::TissueTable& tissues, const MeshUnit& unit, const char* option) {
    const std::size_t equals = text.find('=');
    const std::string head = text.substr(0, equals), file = equals == std::string::npos ? "" : text.substr(equals + 1);
    const std::size_t colon = head.find(':');
    if (head.empty() || file.empty())
        throw core::Error(fmt::format("\"{}\" is no part", text), option, "give TISSUE=FILE or TISSUE:PRIORITY=FILE");
    Part part;
    try {
        part.tissue = cases::tissueByName(head.substr(0, colon));
    } catch (const core::Error& e) {
        throw core::Error(e.problem(), option, e.remedy());
    }
    part.name = head.substr(0, colon);
    part.priority = tissues.of(part.tissue).priority;
    if (colon != std::string::npos) {
        const char* end = head.data() + head.size();
        const auto [stop, error] = std::from_chars(head.data() + colon + 1, end, part.priority);
        if (error != std::errc{} || stop != end || part.priority < -1000 || part.priority > 1000)
            throw core::Error(fmt::format("\"{}\" is no priority", head.substr(colon + 1)), option,
                              "give a whole number, -1000 to 1000");
    }
    geometry::ColouredMesh read = unit.readColoured(file);
    part.mesh = std::move(read.mesh);
    part.colours = std::move(read.colours);
    return part;
}

void makeNew(const NewOptions& o) {
    if (o.fdi != 0 && (o.fdi % 10 < 1 || o.fdi % 10 > 8))
        throw core::Error(fmt::format("{} is no tooth number of the FDI", o.fdi), "--fdi", "11 to 48, or 51 to 85");
    Case c;
    fs::path out(o.out);
    if (!out.has_filename()) out = out.parent_path();
    c.name = o.name.empty() ? out.stem().string() : o.name;
    c.kind = o.kind;
    c.fdiNumber = o.fdi;
    c.buccalSign = o.buccal == "+y" ? 1 : o.buccal == "-y" ? -1 : 0;
    if (!o.tissues.empty()) {
        const std::vector<std::byte> text = core::readFile(o.tissues, 1 << 20);
        c.tissuesToml.assign(reinterpret_cast<const char*>(text.data()), text.size());
        c.tissues = cases::parseTissues(c.tissuesToml, o.tissues);
    }
    if (!o.outer.empty()) {
        geometry::ColouredMesh read = o.unit.readColoured(o.outer);
        c.outer = std::move(read.mesh);
        c.outerColours = std::move(read.colours);
    }
    for (const std::string& part : o.parts)
        c.parts.push_back(partOf(part, c.tissues, o.unit, "--part"));
    for (const std::string& part : o.scenery)
        c.scenery.push_back(partOf(part, c.tissues, o.unit, "--scenery"));
    // The only part is the tooth.
    if (c.outer.triangles.empty() && c.parts.size() == 1) {
        c.outer = c.parts.front().mesh;
        c.outerColours = c.parts.front().colours;
    }
    // They are of the outside: what lies within is not seen.
    for (Part& part : c.parts)
        part.colours.clear();
    const std::vector<cases::CaseFinding> findings = findingsOf(c);
    if (isWrong(findings)) refuse(findings, o.out);
    cases::writeCase(c, out);
    fmt::print("{}: {} parts, {} faces outside{}\n", o.out, c.parts.size(), c.outer.triangles.size(),
               coloursNote(c.outerColours));
    for (const cases::CaseFinding& f : findings)
        fmt::print("  note: {}{}\n", f.part.empty() ? "" : f.part + ": ", f.what);
}

struct WorkOnOptions {
    std::string in, out;
    int fdi = 0;
};

void workOnAnother(const WorkOnOptions& o) {
    const Case made = cases::workOn(cases::readCase(o.in), o.fdi);
    cases::writeCase(made, o.out);
    const auto cuttable = std::count_if(made.others.begin(), made.others.end(),
                                        [](const cases::PlacedTooth& other) { return other.isCuttable; });
    fmt::print("{}: {}\n  {} others, {} of them to be cut too\n", o.out, made.name, made.others.size(), cuttable);
}

struct LandmarkOptions {
    std::string place, out;
    bool json = false, find = false;
};

void listLandmarks(const LandmarkOptions& o) {
    if (o.find == o.out.empty())
        throw core::Error("what is found is written beside what was read", o.find ? "--find" : "--out",
                          "give --find and --out, or neither");
    Case c = cases::readCase(o.place);
    std::vector<cases::Landmark> lacked;
    if (o.find) {
        studies::ProgressBar bar("finding landmarks");
        c.landmarks = landmarks::withFound(c.landmarks, landmarks::findLandmarks(c, bar.listener()));
        bar.finish();
        cases::writeCase(c, o.out);
        lacked = landmarks::lackedLandmarks(landmarks::expectedLandmarks(c.fdiNumber), c.landmarks);
    }
    if (o.json) {
        Json list = Json::array();
        for (const cases::Landmark& mark : c.landmarks) {
            Json points = Json::array();
            for (const core::Vec3& p : mark.pointsMm)
                points.push_back(toJson(p));
            list.push_back({{"kind", cases::kLandmarkKinds[static_cast<std::size_t>(mark.kind)]},
                            {"name", mark.name},
                            {"source", cases::kLandmarkSources[static_cast<std::size_t>(mark.source)]},
                            {"points_mm", std::move(points)}});
        }
        Json made = {{"case", o.find ? o.out : o.place}, {"landmarks", std::move(list)}};
        if (o.find) {
            made["not_found"] = Json::array();
            for (const cases::Landmark& mark : lacked)
                made["not_found"].push_back(
                    {{"kind", cases::kLandmarkKinds[static_cast<std::size_t>(mark.kind)]}, {"name", mark.name}});
        }
        return print(made);
    }
    for (const cases::Landmark& mark : c.landmarks) {
        const core::Vec3& p = mark.pointsMm.front();
        const std::string place = mark.pointsMm.size() == 1
                                      ? fmt::format("{:7.2f} {:7.2f} {:7.2f} mm", p.x(), p.y(), p.z())
                                      : fmt::format("{} points", mark.pointsMm.size());
        fmt::print("  {:<24} {:<24} {:<10} {}\n", cases::kLandmarkKinds[static_cast<std::size_t>(mark.kind)],
                   core::printable(mark.name), cases::kLandmarkSources[static_cast<std::size_t>(mark.source)], place);
    }
    fmt::print("{}: {} landmarks\n", o.find ? o.out : o.place, c.landmarks.size());
    for (const cases::Landmark& mark : lacked)
        fmt::print("  not found: {} {}\n", cases::kLandmarkKinds[static_cast<std::size_t>(mark.kind)], mark.name);
}

struct PackOptions {
    std::string in, out, student;
    bool handIn = false;
};

/// The recordings of an attempt: those it came with; of one to be handed in those in its folder or beside that, too.
cases::PackageFiles recordingsOf(const cases::Attempt& attempt, const fs::path& place) {
    cases::PackageFiles found;
    for (const cases::Attempt::Recording& recording : attempt.recordings) {
        if (recording.packed) {
            found[recording.name] = cases::readRecording(place, recording.name);
            continue;
        }
        if (!attempt.handedIn) continue;
        const fs::path whole = fs::absolute(place).lexically_normal();
        const fs::path folder = whole.has_filename() ? whole : whole.parent_path();
        for (const fs::path& in : {folder, folder.parent_path()})
            if (std::error_code error; fs::is_regular_file(in / recording.name, error)) {
                found[recording.name] = core::readFile(in / recording.name, cases::kMaxRecordingBytes);
                break;
            }
    }
    return found;
}

void pack(const PackOptions& o) {
    const std::string &in = o.in, &out = o.out;
    const bool isAttempt = cases::isAttempt(in);
    if (!isAttempt && (o.handIn || !o.student.empty()))
        throw core::Error("a case is nobody's work", in, "give an attempt to --hand-in and --student");
    if (isAttempt) {
        cases::OpenAttempt open = cases::openAttempt(in);
        cases::Attempt& attempt = open.attempt;
        if (!o.student.empty()) attempt.student = o.student;
        if (attempt.recordings.empty() && !attempt.session.empty()) attempt.recordings.push_back({attempt.session});
        attempt.handedIn = attempt.handedIn || o.handIn;
        const bool asFile = fs::path(out).extension() == ".handpiece";
        cases::PackageFiles recordings = recordingsOf(attempt, in);
        if (attempt.handedIn) {
            std::size_t bytes = 0;
            for (const auto& [name, data] : recordings)
                bytes += data.size();
            fmt::print("recordings: {} of {}, {:.1f} MB\n", recordings.size(), attempt.recordings.size(),
                       static_cast<double>(bytes) / (1 << 20));
        }
        cases::writeAttempt(attempt, out, asFile ? &open.toothCase : nullptr, std::move(recordings));
    } else {
        cases::writeCase(cases::readCase(in), out);
    }
    fmt::print("{} -> {}\n", in, out);
}

}  // namespace

void addCaseCommand(Command& app) {
    Command command = app.subcommand("case", "Look into a case, check it, make one, pack it into one file");
    command.requireSubcommand();
    command.footer(
        "Examples:\n  handpiece case info molar\n  handpiece case check molar --json\n"
        "  handpiece case new --out mine --outer whole.stl --part enamel=e.stl --part dentine=d.stl\n"
        "  handpiece case pack mine mine.handpiece");

    struct Looked {
        std::string place;
        bool json = false;
    };
    const auto looked = std::make_shared<Looked>();
    const auto looking = [&](const char* name, const char* what, const char* json, auto&& work) {
        Command sub = command.subcommand(name, what);
        sub.option("CASE", looked->place, "case folder, .handpiece file or mesh file").required();
        sub.flag("--json", looked->json, json);
        sub.footer(fmt::format("Example:\n  handpiece case {} molar", name));
        sub.callback([looked, work] { work(looked->place, looked->json); });
    };
    looking("info", "Name the parts of a case, its tissues and its exercise", "print JSON instead of a table", info);
    looking("check", "Tell what is missing, crossing or sticking out; exit code 1 when it cannot be cut",
            "print JSON instead of lines", check);

    const auto marks = std::make_shared<LandmarkOptions>();
    Command listing = command.subcommand("landmarks", "List the landmarks of the tooth, or find them by its shape");
    listing.option("CASE", marks->place, "case folder or .handpiece file").required();
    listing.flag("--json", marks->json, "print JSON with all points instead of a table");
    listing.flag("--find", marks->find, "find them on the surfaces; those generated or set by hand stay");
    listing.option("--out", marks->out, "with --find: folder or .handpiece file to write");
    listing.footer("Example:\n  handpiece case landmarks scanned --find --out marked");
    listing.callback([marks] { listLandmarks(*marks); });

    const auto options = std::make_shared<NewOptions>();
    NewOptions& o = *options;
    Command make = command.subcommand("new", "Make a case of meshes, one closed surface per part");
    make.option("--out", o.out, "folder or .handpiece file to write").required();
    addUnitOptions(make, o.unit);
    make.option("--outer", o.outer, "mesh of the whole tooth [default: the only part]");
    make.option("--part", o.parts, "TISSUE=FILE or TISSUE:PRIORITY=FILE, in mm; as often as there are parts").takeAll();
    make.option("--scenery", o.scenery, "TISSUE=FILE around the tooth: adjacent teeth (neighbour), gingiva (gum), bone")
        .takeAll();
    make.option("--name", o.name, "name of the case [default: of the folder]");
    make.option("--kind", o.kind, "kind of tooth, as lower-first-molar");
    make.option("--fdi", o.fdi, "FDI number of the tooth, 11 to 48 or 51 to 85")
        .check(range(11, 85))
        .typeName("NUMBER");
    make.option("--buccal", o.buccal, "side that is buccal: +y or -y").check(oneOf({"+y", "-y"}));
    make.option("--tissues", o.tissues, "table of tissues of one's own (TOML)");
    make.footer(
        "Example:\n  handpiece case new --out mine --outer whole.stl --part enamel=e.stl --part caries:70=c.stl");
    make.callback([options] { makeNew(*options); });

    const auto other = std::make_shared<WorkOnOptions>();
    Command working = command.subcommand("work-on", "Make the case of another tooth of the same mouth");
    working.option("CASE", other->in, "case folder or .handpiece file of several teeth").required();
    working.option("--fdi", other->fdi, "FDI number of the tooth that is worked on from now on")
        .check(range(11, 85))
        .typeName("NUMBER")
        .required();
    working.option("--out", other->out, "folder or .handpiece file to write").required();
    working.footer(
        "Adjacent teeth and antagonists of that tooth can be cut too, the others are felt. An exercise is of its tooth "
        "and goes.\nExample:\n  handpiece case work-on mouth --fdi 16 --out upper");
    working.callback([other] { workOnAnother(*other); });

    const auto packed = std::make_shared<PackOptions>();
    Command packing =
        command.subcommand("pack", "Pack a case, or an attempt with its case, into one file; or unpack a case");
    packing.option("IN", packed->in, "case or attempt: folder or .handpiece file").required();
    packing.option("OUT", packed->out, ".handpiece file, or folder to unpack into").required();
    packing.flag("--hand-in", packed->handIn, "of an attempt: for a teacher, with its recordings");
    packing.option("--student", packed->student, "of an attempt: whose it is, a name or code as you type it");
    packing.footer(
        "Examples:\n  handpiece case pack molar molar.handpiece\n"
        "  handpiece case pack out/attempt S-07.handpiece --hand-in --student S-07");
    packing.callback([packed] { pack(*packed); });
}

}  // namespace handpiece::cli
