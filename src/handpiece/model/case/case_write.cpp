// SPDX-License-Identifier: Apache-2.0
// Writing cases, as a folder or as one file.
#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/case/as_written.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/case/case_files.h"
#include "handpiece/model/case/package_type.h"
#include "handpiece/model/case/toml_text.h"

namespace handpiece::cases {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTissueFile = "tissues.toml";

std::vector<std::byte> bytesOf(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

/// An STL holds no colours. Programs before them read a PLY as well, without its colours.
const char* endingOf(const geometry::VertexColours& colours) {
    return colours.empty() ? ".stl" : ".ply";
}

/// Names become file names: nothing but letters, digits and dashes, and no two alike.
std::string fileFor(const Part& part, std::string_view prefix, const PackageFiles& taken) {
    constexpr std::size_t kLongest = 100;
    std::string base(prefix);
    for (const char c : part.name.substr(0, kLongest))
        base += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '-';
    std::string file = base + endingOf(part.colours);
    for (int i = 2; taken.count(file) > 0; ++i)
        file = fmt::format("{}-{}{}", base, i, endingOf(part.colours));
    return file;
}

std::vector<std::byte> bytesOf(const geometry::TriangleMesh& mesh, const geometry::VertexColours& colours,
                               const std::string& where) {
    return colours.empty() ? geometry::stlBytes(mesh, where) : geometry::plyBytes(mesh, colours, where);
}

void addParts(const std::vector<Part>& parts, const std::string& key, std::string_view prefix, PackageFiles& files,
              std::string& toml) {
    for (const Part& part : parts) {
        const std::string file = fileFor(part, prefix, files);
        files[file] = bytesOf(part.mesh, part.colours, part.name);
        toml += fmt::format("\n[[{}]]\nname = {}\nfile = {}\ntissue = {}\npriority = {}\n", key, tomlText(part.name),
                            tomlText(file), tomlText(properties(part.tissue).name), part.priority);
        if (part.isFelt) toml += "felt = true\n";
    }
}

/// Name, kind, number and surface: the keys of a tooth before its tables.
std::string toothKeys(const Tooth& tooth, std::string_view prefix, PackageFiles& files) {
    std::string toml = fmt::format("name = {}\n", tomlText(tooth.name));
    if (!tooth.kind.empty()) toml += fmt::format("kind = {}\n", tomlText(tooth.kind));
    if (tooth.fdiNumber != 0) toml += fmt::format("fdi = {}\n", tooth.fdiNumber);
    if (tooth.buccalSign != 0) toml += fmt::format("buccal = \"{}\"\n", tooth.buccalSign > 0 ? "+y" : "-y");
    if (tooth.outer.triangles.empty()) return toml;
    const std::string outerFile = fmt::format("{}outer{}", prefix, endingOf(tooth.outerColours));
    files[outerFile] = bytesOf(tooth.outer, tooth.outerColours, outerFile);
    return toml + fmt::format("outer = \"{}\"\n", outerFile);
}

std::string poseToml(const core::Pose& pose) {
    const core::Vec3& at = pose.positionMm;
    const core::Quat& turn = pose.orientation;
    return fmt::format("position_mm = [{}, {}, {}]\norientation = [{}, {}, {}, {}]\n", tomlNumber(at.x()),
                       tomlNumber(at.y()), tomlNumber(at.z()), tomlNumber(turn.w()), tomlNumber(turn.x()),
                       tomlNumber(turn.y()), tomlNumber(turn.z()));
}

bool isClosed(const Case& c) {
    return c.opening.positionMm.isZero(1e-9) && c.opening.orientation.vec().isZero(1e-9);
}

void addOther(const PlacedTooth& tooth, std::size_t index, PackageFiles& files, std::string& toml) {
    const std::string prefix =
        tooth.fdiNumber != 0 ? fmt::format("{}-", tooth.fdiNumber) : fmt::format("tooth{}-", index + 1);
    toml += "\n[[tooth]]\n" + toothKeys(tooth, prefix, files);
    toml += poseToml(tooth.inCase) + fmt::format("cuttable = {}\n", tooth.isCuttable);
    addParts(tooth.parts, "tooth.part", prefix, files, toml);
    toml += landmarksToml(tooth.landmarks, "tooth.landmark");
}

/// The oldest format that can hold it.
int formatOf(const Case& c) {
    const auto isFelt = [](const Part& part) { return part.isFelt; };
    if (!c.others.empty() || !c.landmarks.empty() || !isClosed(c) ||
        std::any_of(c.scenery.begin(), c.scenery.end(), isFelt))
        return 3;
    return c.exercise || !c.tissuesToml.empty() ? 2 : 1;
}

}  // namespace

PackageFiles caseFiles(const Case& toothCase) {
    std::string toml = "# A Handpiece case: docs/case-format.md. Millimetres; +z occlusal, +x mesial.\n";
    PackageFiles files;
    toml += fmt::format("format = {}\n", formatOf(toothCase)) + toothKeys(toothCase, "", files);
    if (!toothCase.tissuesToml.empty()) {
        files[kTissueFile] = bytesOf(toothCase.tissuesToml);
        toml += fmt::format("tissues = \"{}\"\n", kTissueFile);
    }
    addParts(toothCase.parts, "part", "", files, toml);
    toml += landmarksToml(toothCase.landmarks, "landmark");
    addParts(toothCase.scenery, "scenery", "scene-", files, toml);
    for (std::size_t i = 0; i < toothCase.others.size(); ++i)
        addOther(toothCase.others[i], i, files, toml);
    if (!isClosed(toothCase)) toml += "\n[opening]\n" + poseToml(toothCase.opening);
    if (toothCase.exercise) toml += "\n[exercise]\n" + exerciseToml(*toothCase.exercise);
    files[kCaseFile] = bytesOf(toml);
    return files;
}

void writeCase(const Case& toothCase, const fs::path& path) {
    if (path.empty()) throw core::Error("a case needs a folder", "output folder", "name one");
    if (isPackageName(path)) {
        PackageFiles files = caseFiles(toothCase);
        setPackageType(files, PackageType::toothCase);
        writePackage(path, files);
    } else
        writeFolder(path, caseFiles(toothCase), kCaseFile);
}

Case asWritten(const Case& toothCase, const fs::path& path) {
    const PackageFiles files = caseFiles(toothCase);
    return readCaseFiles(filesInPackage(path, files));
}

}  // namespace handpiece::cases
