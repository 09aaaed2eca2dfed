// SPDX-License-Identifier: Apache-2.0
// Reading cases: a folder with case.toml and one STL per part, the same as one file, or a single mesh.
// docs/case-format.md describes it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <string_view>
#include <system_error>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/leads_out.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/base/geometry/read_notes.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/case/case_files.h"
#include "handpiece/model/case/exercise_table.h"
#include "handpiece/model/case/package_type.h"

namespace handpiece::cases {
namespace {

namespace fs = std::filesystem;
using config::Table;

constexpr std::int64_t kOldestFormat = 1, kNewestFormat = 3;
constexpr int kMaxPriority = 1000;
constexpr std::size_t kMostTeeth = 64;      // of a mouth: 32, and as many of another's
constexpr double kFarthestToothMm = 200.0;  // from the case's own tooth
constexpr const char* kRemedy = "see docs/case-format.md";

/// What formats differ in.
struct Reading {
    const CaseFiles& files;
    const TissueTable& tissues;
    std::int64_t format;
    std::vector<std::string>& meshes;  ///< files named so far: each tooth's outer (empty: none), its parts
    [[nodiscard]] bool isStrict() const { return format >= 2; }
    [[nodiscard]] bool hasOthers() const { return format >= 3; }
};

Part readPart(const Table& entry, const Reading& reading, bool isScenery) {
    const bool mayBeFelt = isScenery && reading.hasOthers();
    if (mayBeFelt)
        entry.allowOnly({"name", "file", "tissue", "priority", "felt"});
    else if (reading.isStrict())
        entry.allowOnly({"name", "file", "tissue", "priority"});
    const std::string file = entry.text("file").value_or(""), tissueName = entry.text("tissue").value_or("");
    if (file.empty() || tissueName.empty()) entry.fail("a part without file or tissue", kRemedy);
    Part part;
    try {
        part.tissue = tissueByName(tissueName);
    } catch (const core::Error& e) {
        entry.fail(e.problem(), e.remedy());
    }
    const TissueProperties& row = reading.tissues.of(part.tissue);
    part.name = entry.text("name").value_or(std::string(row.name));
    const std::int64_t priority = entry.integer("priority").value_or(row.priority);
    if (priority < -kMaxPriority || priority > kMaxPriority)
        entry.fail(fmt::format("a priority of {}", priority), fmt::format("give {} to {}", -kMaxPriority, kMaxPriority),
                   "priority");
    part.priority = static_cast<int>(priority);
    requireInside(entry, file, "file");
    reading.meshes.push_back(file);
    if (mayBeFelt) part.isFelt = entry.flag("felt").value_or(false);
    return part;
}

std::vector<Part> readParts(const Table& root, std::string_view key, const Reading& reading) {
    std::vector<Part> parts;
    for (const Table& entry : root.tables(key))
        parts.push_back(readPart(entry, reading, key == "scenery"));
    return parts;
}

void readTissueTable(const Table& root, const CaseFiles& files, Case& made) {
    const auto name = root.text("tissues");
    if (!name) return;
    requireInside(root, *name, "tissues");
    made.tissuesToml = tomlIn(files, *name);
    made.tissues = parseTissues(made.tissuesToml, files.where(*name));
}

int buccalSignOf(const Table& root) {
    const std::string buccal = root.text("buccal").value_or("");
    if (!buccal.empty() && buccal != "+y" && buccal != "-y")
        root.fail(fmt::format("buccal is \"{}\"", buccal), "write \"+y\" or \"-y\"", "buccal");
    return buccal == "+y" ? 1 : buccal == "-y" ? -1 : 0;
}

int fdiNumberOf(const Table& root) {
    const std::int64_t fdi = root.integer("fdi").value_or(0);
    if (fdi != 0 && (fdi < 11 || fdi > 85 || fdi % 10 < 1 || fdi % 10 > 8))
        root.fail(fmt::format("{} is no tooth number of the FDI", fdi), "11 to 48, or 51 to 85", "fdi");
    return static_cast<int>(fdi);
}

/// What a case's own tooth and the others have alike.
void readTooth(const Table& table, const Reading& reading, Tooth& tooth) {
    tooth.kind = table.text("kind").value_or("");
    tooth.fdiNumber = fdiNumberOf(table);
    tooth.buccalSign = buccalSignOf(table);
    const std::string outer = table.text("outer").value_or("");
    if (!outer.empty()) requireInside(table, outer, "outer");
    reading.meshes.push_back(outer);
    tooth.parts = readParts(table, "part", reading);
    if (reading.hasOthers()) tooth.landmarks = readLandmarks(table);
}

core::Pose readPose(const Table& table, std::string_view what) {
    const std::vector<double> at = table.numbers("position_mm"), turn = table.numbers("orientation");
    if (at.size() != 3)
        table.fail(fmt::format("{} without three numbers that say where", what), kRemedy, "position_mm");
    if (turn.size() != 4)
        table.fail(fmt::format("{} without the four numbers of its turn (w, x, y, z)", what), kRemedy, "orientation");
    const core::Pose pose{{at[0], at[1], at[2]}, {turn[0], turn[1], turn[2], turn[3]}};
    if (!pose.isValid())
        table.fail(fmt::format("the turn of {} is no unit quaternion", what), "write w, x, y, z of length 1",
                   "orientation");
    if (pose.positionMm.norm() > kFarthestToothMm)
        table.fail(fmt::format("{} stands {:.0f} mm off", what, pose.positionMm.norm()),
                   fmt::format("a mouth is {:.0f} mm wide at most", kFarthestToothMm), "position_mm");
    return pose;
}

std::vector<PlacedTooth> readOthers(const Table& root, const Reading& reading) {
    const std::vector<Table> tables = root.tables("tooth");
    if (tables.size() > kMostTeeth)
        root.fail(fmt::format("{} teeth in a case", tables.size()), fmt::format("give {} at most", kMostTeeth),
                  "tooth");
    std::vector<PlacedTooth> others;
    for (const Table& table : tables) {
        table.allowOnly(
            {"name", "kind", "fdi", "buccal", "outer", "position_mm", "orientation", "cuttable", "part", "landmark"});
        PlacedTooth& tooth = others.emplace_back();
        readTooth(table, reading, tooth);
        tooth.name = table.text("name").value_or(tooth.kind);
        tooth.inCase = readPose(table, "a tooth");
        tooth.isCuttable = table.flag("cuttable").value_or(true);
        if (table.text("outer").value_or("").empty() && tooth.parts.size() != 1)
            table.fail("a tooth of several parts or none, without an outer surface",
                       "name its whole surface as \"outer\"");
        const bool isTwice = tooth.fdiNumber != 0 &&
                             std::count_if(others.begin(), others.end(),
                                           [&](const PlacedTooth& o) { return o.fdiNumber == tooth.fdiNumber; }) > 1;
        if (isTwice || (tooth.fdiNumber != 0 && tooth.fdiNumber == root.integer("fdi").value_or(0)))
            table.fail(fmt::format("tooth {} stands in the case twice", tooth.fdiNumber), "give each its own number",
                       "fdi");
    }
    return others;
}

/// All meshes of a case side by side: `names` as Reading::meshes. Of several that cannot be read the first is told.
void readMeshes(const CaseFiles& files, const std::vector<std::string>& names, Case& made) {
    struct Place {
        geometry::TriangleMesh* mesh;
        geometry::VertexColours* colours;
    };
    std::vector<Place> places;
    const auto addParts = [&places](std::vector<Part>& parts) {
        for (Part& part : parts)
            places.push_back({&part.mesh, &part.colours});
    };
    places.push_back({&made.outer, &made.outerColours});
    addParts(made.parts);
    addParts(made.scenery);
    for (PlacedTooth& other : made.others) {
        places.push_back({&other.outer, &other.outerColours});
        addParts(other.parts);
    }
    std::vector<std::exception_ptr> failures(names.size());
    std::vector<geometry::ReadNotes> notes(names.size());
    core::parallelFor(names.size(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            if (names[i].empty()) continue;
            try {
                geometry::ColouredMesh read =
                    geometry::readColouredMesh(files.read(names[i], geometry::kMaxMeshBytes),
                                               geometry::meshFormatOf(names[i]), files.where(names[i]), &notes[i]);
                *places[i].mesh = std::move(read.mesh);
                *places[i].colours = std::move(read.colours);
            } catch (const core::Error&) {
                failures[i] = std::current_exception();
            }
        }
    });
    for (const std::exception_ptr& failure : failures)
        if (failure) std::rethrow_exception(failure);
    for (std::size_t i = 0; i < names.size(); ++i)
        geometry::tellNotes(files.where(names[i]), notes[i]);
}

}  // namespace

CaseFiles filesInFolder(const fs::path& folder) {
    CaseFiles files;
    files.source = folder;
    files.has = [folder](const std::string& name) { return core::isThere(folder / name); };
    files.read = [folder](const std::string& name, std::uint64_t most) {
        if (core::leadsOut(folder, folder / name))
            throw core::Error("this is a link that leads out of the case's folder, and is not followed",
                              (folder / name).string(), "put the file itself into the folder");
        return core::readFile(folder / name, most);
    };
    files.where = [folder](const std::string& name) { return (folder / name).string(); };
    return files;
}

CaseFiles filesInPackage(const fs::path& package, const PackageFiles& content, const std::string& prefix) {
    CaseFiles files;
    files.source = package;
    const auto where = [package](const std::string& name) { return fmt::format("{} in {}", name, package.string()); };
    files.has = [&content, prefix](const std::string& name) { return content.count(prefix + name) > 0; };
    files.where = where;
    files.read = [&content, prefix, where](const std::string& name, std::uint64_t most) {
        // Written as a person may write it: "a/../b.stl" is refused before, "./b.stl" is b.stl.
        const auto found = content.find(prefix + fs::path(name).lexically_normal().generic_string());
        if (found == content.end())
            throw core::Error("there is no such file", where(name), "pack the case again").as("file-not-found");
        if (found->second.size() > most)
            throw core::Error(
                fmt::format("the file has {} bytes, more than the {} that are read", found->second.size(), most),
                where(name))
                .as("too-large");
        return found->second;
    };
    return files;
}

std::string tomlIn(const CaseFiles& files, const std::string& name) {
    const std::vector<std::byte> bytes = files.read(name, Table::kMaxBytes);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void requireInside(const Table& table, const std::string& name, std::string_view key) {
    const fs::path file(name);
    const bool escapes = file.is_absolute() || file.has_root_name() || name.empty() ||
                         name.find('\0') != std::string::npos ||
                         std::any_of(file.begin(), file.end(), [](const fs::path& p) { return p == ".."; });
    if (escapes)
        table.fail(fmt::format("\"{}\" is not a file inside the case's folder", name),
                   "name files relative to the folder", key);
}

Case readCaseFiles(const CaseFiles& files) {
    const std::string text = tomlIn(files, kCaseFile);
    const Table root = Table::parse(text, files.where(kCaseFile));
    const std::int64_t version = root.integer("format").value_or(0);
    if (version < kOldestFormat || version > kNewestFormat)
        root.fail(fmt::format("the case's format is {}, this program reads formats {} to {}", version, kOldestFormat,
                              kNewestFormat),
                  version > kNewestFormat ? "use a newer Handpiece" : "add the line: format = 1", "format");
    if (version >= 3)
        root.allowOnly({"format", "name", "kind", "fdi", "buccal", "outer", "tissues", "part", "scenery", "exercise",
                        "landmark", "tooth", "opening"});
    else if (version == 2)
        root.allowOnly({"format", "name", "kind", "fdi", "buccal", "outer", "tissues", "part", "scenery", "exercise"});
    Case made;
    made.source = files.source;
    const fs::path source = files.source.has_filename() ? files.source : files.source.parent_path();
    const fs::path fallback = isPackageName(source) ? source.stem() : source.filename();
    made.name = root.text("name").value_or(fallback.string());
    readTissueTable(root, files, made);
    std::vector<std::string> meshes;
    const Reading reading{files, made.tissues, version, meshes};
    readTooth(root, reading, made);
    made.scenery = readParts(root, "scenery", reading);
    if (reading.hasOthers()) made.others = readOthers(root, reading);
    if (const auto opening = root.table("opening"); opening && reading.hasOthers()) {
        opening->allowOnly({"position_mm", "orientation"});
        made.opening = readPose(*opening, "the lower jaw");
    }
    if (const auto exercise = root.table("exercise")) made.exercise = readExercise(*exercise);
    if (meshes.front().empty() && made.parts.empty())
        throw core::Error("the case has neither an outer surface nor a part", root.where(), kRemedy)
            .as("case-without-surface");
    readMeshes(files, meshes, made);
    return made;
}

namespace {

/// What to name instead of a folder that is no case.
std::string whereACaseLies(const fs::path& folder) {
    constexpr std::size_t kMostNamed = 3;
    std::vector<fs::path> cases;
    std::error_code ec;
    for (fs::directory_iterator it(folder, ec), end; !ec && it != end; it.increment(ec))
        if (std::error_code none; fs::exists(it->path() / kCaseFile, none)) cases.push_back(it->path());
    if (cases.empty()) return "name a case folder (handpiece make tooth writes one), a .handpiece file or a mesh file";
    std::sort(cases.begin(), cases.end());
    if (cases.size() == 1) return cases.front().string() + " is one: name that";
    std::string names;
    for (std::size_t i = 0; i < std::min(cases.size(), kMostNamed); ++i)
        names += (i == 0 ? "" : ", ") + cases[i].string();
    return fmt::format("name one in it: {}{}", names, cases.size() > kMostNamed ? ", ..." : "");
}

}  // namespace

Case readCase(const fs::path& path) {
    std::error_code ec;
    if (fs::is_directory(path, ec)) {
        const CaseFiles files = filesInFolder(path);
        if (!files.has(kCaseFile))
            throw core::Error(fmt::format("this folder has no {}", kCaseFile), path.string(), whereACaseLies(path))
                .as("not-a-case", {kCaseFile});
        return readCaseFiles(files);
    }
    if (isPackageName(path)) {
        const PackageFiles content = readPackage(path);
        requireOpenable(content, path.string());
        for (const char* prefix : {"", kCaseInAttempt})
            if (const CaseFiles files = filesInPackage(path, content, prefix); files.has(kCaseFile))
                return readCaseFiles(files);
        throw core::Error(fmt::format("there is no {} in it", kCaseFile), path.string(),
                          "an attempt that was packed without its case needs that case")
            .as("not-a-case", {kCaseFile});
    }
    Case made;
    made.source = path;
    made.name = path.stem().string();
    geometry::ColouredMesh read = geometry::readColouredMesh(path);
    made.outer = std::move(read.mesh);
    made.outerColours = std::move(read.colours);
    return made;
}

std::vector<Part> surroundings(const Case& toothCase) {
    std::vector<Part> all;
    for (const PlacedTooth& other : toothCase.others)
        all.push_back({other.name, Tissue::neighbour, properties(Tissue::neighbour).priority,
                       geometry::transformed(other.surface(), other.inCase), true, other.surfaceColours()});
    all.insert(all.end(), toothCase.scenery.begin(), toothCase.scenery.end());
    return all;
}

bool isScannedInColour(const Case& toothCase) {
    return !toothCase.surfaceColours().empty() ||
           std::any_of(toothCase.others.begin(), toothCase.others.end(),
                       [](const PlacedTooth& other) { return !other.surfaceColours().empty(); }) ||
           std::any_of(toothCase.scenery.begin(), toothCase.scenery.end(),
                       [](const Part& part) { return !part.colours.empty(); });
}

std::uint64_t contentKey(const Tooth& tooth) {
    core::Hasher hasher;
    hasher.add(std::string_view("handpiece case"));
    // As an STL holds it, so that it stays the same when the case is written and read again.
    const auto addMesh = [&hasher](const geometry::TriangleMesh& mesh) {
        hasher.add(mesh.triangles.size());
        for (const geometry::Triangle& t : mesh.triangles)
            for (const std::uint32_t v : t)
                for (int k = 0; k < 3; ++k)
                    hasher.add(static_cast<float>(mesh.vertices[v][k]) + 0.0f);  // -0 is 0
    };
    addMesh(tooth.outer);
    for (const Part& part : tooth.parts) {
        hasher.add(part.tissue);
        hasher.add(part.priority);
        addMesh(part.mesh);
    }
    return hasher.value();
}

std::uint64_t caseKey(const Case& toothCase) {
    if (toothCase.others.empty()) return contentKey(toothCase);
    // To a nanometre: a mouth is the same after another of its teeth was worked on, which rounds where they stand.
    const auto rounded = [](double x) { return static_cast<std::int64_t>(std::llround(1e6 * x)); };
    core::Hasher hasher;
    hasher.add(std::string_view("handpiece mouth"));
    hasher.add(contentKey(toothCase));
    for (const PlacedTooth& tooth : toothCase.others) {
        hasher.add(contentKey(tooth));
        hasher.add(tooth.isCuttable);
        for (int k = 0; k < 3; ++k)
            hasher.add(rounded(tooth.inCase.positionMm[k]));
        for (int k = 0; k < 4; ++k)
            hasher.add(rounded(tooth.inCase.orientation.coeffs()[k]));
    }
    return hasher.value();
}

}  // namespace handpiece::cases
