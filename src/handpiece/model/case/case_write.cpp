// SPDX-License-Identifier: Apache-2.0
// Writing cases, as a folder or as one file.
#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/case/case_files.h"
#include "handpiece/model/case/toml_text.h"

namespace handpiece::cases {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTissueFile = "tissues.toml";

std::vector<std::byte> bytesOf(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

/// Names become file names: nothing but letters, digits and dashes, and no two alike.
std::string fileFor(const Part& part, std::string_view prefix, const PackageFiles& taken) {
    constexpr std::size_t kLongest = 100;
    std::string base(prefix);
    for (const char c : part.name.substr(0, kLongest))
        base += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '-';
    std::string file = base + ".stl";
    for (int i = 2; taken.count(file) > 0; ++i)
        file = fmt::format("{}-{}.stl", base, i);
    return file;
}

void addParts(const std::vector<Part>& parts, const char* key, std::string_view prefix, PackageFiles& files,
              std::string& toml) {
    for (const Part& part : parts) {
        const std::string file = fileFor(part, prefix, files);
        files[file] = geometry::stlBytes(part.mesh, part.name);
        toml += fmt::format("\n[[{}]]\nname = {}\nfile = {}\ntissue = {}\npriority = {}\n", key, tomlText(part.name),
                            tomlText(file), tomlText(properties(part.tissue).name), part.priority);
    }
}

}  // namespace

PackageFiles caseFiles(const Case& toothCase) {
    const bool needsTwo = toothCase.exercise || !toothCase.tissuesToml.empty();
    std::string toml = "# A Handpiece case: docs/case-format.md. Millimetres; +z occlusal, +x mesial.\n";
    toml += fmt::format("format = {}\nname = {}\n", needsTwo ? 2 : 1, tomlText(toothCase.name));
    if (!toothCase.kind.empty()) toml += fmt::format("kind = {}\n", tomlText(toothCase.kind));
    if (toothCase.fdiNumber != 0) toml += fmt::format("fdi = {}\n", toothCase.fdiNumber);
    if (toothCase.buccalSign != 0) toml += fmt::format("buccal = \"{}\"\n", toothCase.buccalSign > 0 ? "+y" : "-y");
    PackageFiles files;
    if (!toothCase.outer.triangles.empty()) {
        files["outer.stl"] = geometry::stlBytes(toothCase.outer, "outer.stl");
        toml += "outer = \"outer.stl\"\n";
    }
    if (!toothCase.tissuesToml.empty()) {
        files[kTissueFile] = bytesOf(toothCase.tissuesToml);
        toml += fmt::format("tissues = \"{}\"\n", kTissueFile);
    }
    addParts(toothCase.parts, "part", "", files, toml);
    addParts(toothCase.scenery, "scenery", "scene-", files, toml);
    if (toothCase.exercise) toml += "\n[exercise]\n" + exerciseToml(*toothCase.exercise);
    files[kCaseFile] = bytesOf(toml);
    return files;
}

void writeCase(const Case& toothCase, const fs::path& path) {
    if (path.empty()) throw core::Error("a case needs a folder", "output folder", "name one");
    if (isPackageName(path))
        writePackage(path, caseFiles(toothCase));
    else
        writeFolder(path, caseFiles(toothCase), kCaseFile);
}

}  // namespace handpiece::cases
