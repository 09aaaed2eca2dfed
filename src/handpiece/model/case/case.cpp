// SPDX-License-Identifier: Apache-2.0
// Reading cases: a folder with case.toml and one STL per part, the same as one file, or a single mesh.
// docs/case-format.md describes it.
#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <system_error>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/case/case_files.h"

namespace handpiece::cases {
namespace {

namespace fs = std::filesystem;
using config::Table;

constexpr std::int64_t kOldestFormat = 1, kNewestFormat = 2;
constexpr int kMaxPriority = 1000;
constexpr const char* kRemedy = "see docs/case-format.md";

geometry::TriangleMesh meshOf(const CaseFiles& files, const std::string& name) {
    return geometry::readMesh(files.read(name, geometry::kMaxMeshBytes), geometry::meshFormatOf(name),
                              files.where(name));
}

Part readPart(const Table& entry, const CaseFiles& files, const TissueTable& tissues, bool strict) {
    if (strict) entry.allowOnly({"name", "file", "tissue", "priority"});
    const std::string file = entry.text("file").value_or(""), tissueName = entry.text("tissue").value_or("");
    if (file.empty() || tissueName.empty()) entry.fail("a part without file or tissue", kRemedy);
    Part part;
    try {
        part.tissue = tissueByName(tissueName);
    } catch (const core::Error& e) {
        entry.fail(e.problem(), e.remedy());
    }
    const TissueProperties& row = tissues.of(part.tissue);
    part.name = entry.text("name").value_or(std::string(row.name));
    const std::int64_t priority = entry.integer("priority").value_or(row.priority);
    if (priority < -kMaxPriority || priority > kMaxPriority)
        entry.fail(fmt::format("a priority of {}", priority), fmt::format("give {} to {}", -kMaxPriority, kMaxPriority),
                   "priority");
    part.priority = static_cast<int>(priority);
    requireInside(entry, file, "file");
    part.mesh = meshOf(files, file);
    return part;
}

std::vector<Part> readParts(const Table& root, std::string_view key, const CaseFiles& files, const TissueTable& tissues,
                            bool strict) {
    std::vector<Part> parts;
    for (const Table& entry : root.tables(key))
        parts.push_back(readPart(entry, files, tissues, strict));
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

}  // namespace

CaseFiles filesInFolder(const fs::path& folder) {
    CaseFiles files;
    files.source = folder;
    files.has = [folder](const std::string& name) { return core::isThere(folder / name); };
    files.read = [folder](const std::string& name, std::uint64_t most) { return core::readFile(folder / name, most); };
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
    const bool strict = version >= 2;
    if (strict)
        root.allowOnly({"format", "name", "kind", "fdi", "buccal", "outer", "tissues", "part", "scenery", "exercise"});
    Case made;
    made.source = files.source;
    const fs::path source = files.source.has_filename() ? files.source : files.source.parent_path();
    const fs::path fallback = isPackageName(source) ? source.stem() : source.filename();
    made.name = root.text("name").value_or(fallback.string());
    made.kind = root.text("kind").value_or("");
    made.fdiNumber = fdiNumberOf(root);
    made.buccalSign = buccalSignOf(root);
    readTissueTable(root, files, made);
    if (const std::string outer = root.text("outer").value_or(""); !outer.empty()) {
        requireInside(root, outer, "outer");
        made.outer = meshOf(files, outer);
    }
    made.parts = readParts(root, "part", files, made.tissues, strict);
    made.scenery = readParts(root, "scenery", files, made.tissues, strict);
    if (const auto exercise = root.table("exercise")) made.exercise = readExercise(*exercise);
    if (made.outer.triangles.empty() && made.parts.empty())
        throw core::Error("the case has neither an outer surface nor a part", root.where(), kRemedy)
            .as("case-without-surface");
    return made;
}

Case readCase(const fs::path& path) {
    std::error_code ec;
    if (fs::is_directory(path, ec)) {
        const CaseFiles files = filesInFolder(path);
        if (!files.has(kCaseFile))
            throw core::Error(fmt::format("this folder has no {}", kCaseFile), path.string(),
                              "name a case folder (handpiece make tooth writes one), a .handpiece file or a mesh file")
                .as("not-a-case", {kCaseFile});
        return readCaseFiles(files);
    }
    if (isPackageName(path)) {
        const PackageFiles content = readPackage(path);
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
    made.outer = geometry::readMesh(path);
    return made;
}

std::uint64_t contentKey(const Case& toothCase) {
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
    addMesh(toothCase.outer);
    for (const Part& part : toothCase.parts) {
        hasher.add(part.tissue);
        hasher.add(part.priority);
        addMesh(part.mesh);
    }
    return hasher.value();
}

}  // namespace handpiece::cases
