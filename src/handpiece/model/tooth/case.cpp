// SPDX-License-Identifier: Apache-2.0
// Cases on disk: a folder with case.toml and one STL per part. docs/case-format.md describes it.
#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>
#include <sstream>
#include <string_view>
#include <system_error>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/tooth/tooth.h"

namespace handpiece::tooth {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kFormatVersion = 1;
constexpr const char* kCaseFile = "case.toml";
constexpr std::uint64_t kMaxCaseFileBytes = 1 << 20;

/// A file named in case.toml: inside the folder, whatever it says.
fs::path insideCase(const fs::path& folder, const std::string& name, const std::string& where) {
    const fs::path file(name);
    const bool escapes = file.is_absolute() || file.has_root_name() || name.empty() ||
                         std::any_of(file.begin(), file.end(), [](const fs::path& p) { return p == ".."; });
    if (escapes)
        throw core::Error(fmt::format("\"{}\" is not a file inside the case's folder", name), where,
                          "name files relative to the folder");
    return folder / file;
}

template <class T>
T valueOr(const toml::table& table, std::string_view key, T fallback, const std::string& where) {
    const toml::node* node = table.get(key);
    if (!node) return fallback;
    if (const auto value = node->value_exact<T>()) return *value;
    throw core::Error(fmt::format("\"{}\" has the wrong type (line {})", key, node->source().begin.line), where,
                      "see docs/case-format.md");
}

Part readPart(const toml::table& entry, const fs::path& folder, const std::string& where) {
    const auto file = valueOr<std::string>(entry, "file", {}, where);
    const auto tissueName = valueOr<std::string>(entry, "tissue", {}, where);
    if (file.empty() || tissueName.empty())
        throw core::Error(fmt::format("a part without file or tissue (line {})", entry.source().begin.line), where,
                          "see docs/case-format.md");
    Part part;
    try {
        part.tissue = tissueByName(tissueName);
    } catch (const core::Error& e) {
        throw core::Error(fmt::format("line {}: {}", entry.source().begin.line, e.problem()), where, e.remedy());
    }
    part.name = valueOr<std::string>(entry, "name", std::string(properties(part.tissue).name), where);
    part.priority = static_cast<int>(valueOr<std::int64_t>(entry, "priority", properties(part.tissue).priority, where));
    part.mesh = geometry::readMesh(insideCase(folder, file, where));
    return part;
}

std::vector<Part> readParts(const toml::table& root, std::string_view key, const fs::path& folder,
                            const std::string& where) {
    std::vector<Part> parts;
    const toml::node* node = root.get(key);
    if (!node) return parts;
    const toml::array* list = node->as_array();
    if (!list) throw core::Error(fmt::format("\"{}\" is not a list of tables", key), where, "see docs/case-format.md");
    for (const toml::node& entry : *list) {
        if (!entry.is_table())
            throw core::Error(fmt::format("\"{}\" is not a list of tables", key), where, "see docs/case-format.md");
        parts.push_back(readPart(*entry.as_table(), folder, where));
    }
    return parts;
}

Case readFolder(const fs::path& folder) {
    const fs::path file = folder / kCaseFile;
    const std::string where = file.string();
    if (!fs::exists(file))
        throw core::Error(fmt::format("this folder has no {}", kCaseFile), folder.string(),
                          "name a case folder (handpiece make tooth writes one) or a mesh file");
    const std::vector<std::byte> bytes = core::readFile(file, kMaxCaseFileBytes);
    toml::table root;
    try {
        root = toml::parse(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()), where);
    } catch (const toml::parse_error& e) {
        throw core::Error(fmt::format("line {}: {}", e.source().begin.line, e.description()), where, "mend the file");
    }
    const auto version = valueOr<std::int64_t>(root, "format", 0, where);
    if (version != kFormatVersion)
        throw core::Error(fmt::format("the case's format is {}, this program reads format {}", version, kFormatVersion),
                          where, version > kFormatVersion ? "use a newer Handpiece" : "add the line: format = 1");
    Case made;
    made.source = folder;
    made.name = valueOr<std::string>(root, "name", folder.filename().string(), where);
    made.kind = valueOr<std::string>(root, "kind", {}, where);
    const auto fdi = valueOr<std::int64_t>(root, "fdi", 0, where);
    if (fdi != 0 && (fdi < 11 || fdi > 85 || fdi % 10 < 1 || fdi % 10 > 8))
        throw core::Error(fmt::format("{} is no tooth number of the FDI", fdi), where, "11 to 48, or 51 to 85");
    made.fdiNumber = static_cast<int>(fdi);
    const auto buccal = valueOr<std::string>(root, "buccal", {}, where);
    if (!buccal.empty() && buccal != "+y" && buccal != "-y")
        throw core::Error(fmt::format("buccal is \"{}\"", buccal), where, "write \"+y\" or \"-y\"");
    made.buccalSign = buccal == "+y" ? 1 : buccal == "-y" ? -1 : 0;
    if (const auto outer = valueOr<std::string>(root, "outer", {}, where); !outer.empty())
        made.outer = geometry::readMesh(insideCase(folder, outer, where));
    made.parts = readParts(root, "part", folder, where);
    made.scenery = readParts(root, "scenery", folder, where);
    if (made.outer.triangles.empty() && made.parts.empty())
        throw core::Error("the case has neither an outer surface nor a part", where, "see docs/case-format.md");
    return made;
}

toml::array tablesOf(const std::vector<Part>& parts, std::string_view prefix, std::vector<std::string>& files) {
    toml::array list;
    for (const Part& part : parts) {
        // Names become file names: nothing but letters, digits and dashes.
        std::string base(prefix);
        for (const char c : part.name)
            base += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '-';
        std::string file = base + ".stl";
        for (int i = 2; std::find(files.begin(), files.end(), file) != files.end(); ++i)
            file = fmt::format("{}-{}.stl", base, i);
        files.push_back(file);
        toml::table entry;
        entry.insert("name", part.name);
        entry.insert("file", file);
        entry.insert("tissue", std::string(properties(part.tissue).name));
        entry.insert("priority", part.priority);
        list.push_back(std::move(entry));
    }
    return list;
}

/// A folder may be replaced when it is a case of ours, or empty.
bool mayReplace(const fs::path& folder) {
    return !fs::exists(folder) ||
           (fs::is_directory(folder) && (fs::is_empty(folder) || fs::exists(folder / kCaseFile)));
}

}  // namespace

Case readCase(const fs::path& path) {
    std::error_code ec;
    if (fs::is_directory(path, ec)) return readFolder(path);
    Case made;
    made.source = path;
    made.name = path.stem().string();
    made.outer = geometry::readMesh(path);
    return made;
}

void writeCase(const Case& toothCase, const fs::path& folder) {
    if (folder.empty()) throw core::Error("a case needs a folder", "output folder", "name one");
    const fs::path target = fs::absolute(folder).lexically_normal();
    const fs::path place = target.has_filename() ? target : target.parent_path();
    if (!mayReplace(place))
        throw core::Error("this folder holds something else and is not replaced", folder.string(),
                          "name a new folder, or an old case");
    core::prepareOutputFolder(place.parent_path());

    std::vector<std::string> files;
    toml::table root;
    root.insert("format", kFormatVersion);
    root.insert("name", toothCase.name);
    if (!toothCase.kind.empty()) root.insert("kind", toothCase.kind);
    if (toothCase.fdiNumber != 0) root.insert("fdi", toothCase.fdiNumber);
    if (toothCase.buccalSign != 0) root.insert("buccal", toothCase.buccalSign > 0 ? "+y" : "-y");
    if (!toothCase.outer.triangles.empty()) {
        root.insert("outer", "outer.stl");
        files.emplace_back("outer.stl");
    }
    const std::size_t firstPart = files.size();
    toml::array parts = tablesOf(toothCase.parts, "", files);
    const std::size_t firstScenery = files.size();
    toml::array scenery = tablesOf(toothCase.scenery, "scene-", files);
    if (!parts.empty()) root.insert("part", std::move(parts));
    if (!scenery.empty()) root.insert("scenery", std::move(scenery));

    // Everything is written into a folder beside the place, which is then renamed into it.
    core::Hasher salt;
    salt.add(place.string());
    salt.add(fs::file_time_type::clock::now().time_since_epoch().count());
    const fs::path beside = place.parent_path() / fmt::format("{}.{:x}.part", place.filename().string(), salt.value());
    const fs::path old = place.parent_path() / fmt::format("{}.{:x}.old", place.filename().string(), salt.value());
    std::error_code ec;
    try {
        core::prepareOutputFolder(beside);
        if (!toothCase.outer.triangles.empty()) geometry::writeStl(beside / "outer.stl", toothCase.outer);
        for (std::size_t i = 0; i < toothCase.parts.size(); ++i)
            geometry::writeStl(beside / files[firstPart + i], toothCase.parts[i].mesh);
        for (std::size_t i = 0; i < toothCase.scenery.size(); ++i)
            geometry::writeStl(beside / files[firstScenery + i], toothCase.scenery[i].mesh);
        std::ostringstream text;
        text << "# A Handpiece case: docs/case-format.md. Millimetres; +z occlusal, +x mesial.\n" << root << "\n";
        core::writeFile(beside / kCaseFile, text.str());
        const bool replaces = fs::exists(place);
        if (replaces) fs::rename(place, old);
        fs::rename(beside, place);
        if (replaces) fs::remove_all(old, ec);
    } catch (const fs::filesystem_error& e) {
        if (fs::exists(old, ec) && !fs::exists(place, ec)) fs::rename(old, place, ec);
        fs::remove_all(beside, ec);
        throw core::Error(fmt::format("cannot be written: {}", e.code().message()), folder.string(),
                          "check the folder, its permissions and the free space");
    } catch (const core::Error&) {
        fs::remove_all(beside, ec);
        throw;
    }
}

}  // namespace handpiece::tooth
