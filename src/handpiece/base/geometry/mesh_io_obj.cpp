// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "handpiece/base/geometry/mesh_io_formats.h"

namespace handpiece::geometry::formats {
namespace {

constexpr std::string_view kBlank = " \t\v\f";

// One line, its continuations ("\" at the end) joined. `storage` is used only for those.
std::string_view nextLine(std::string_view text, std::size_t& at, std::uint64_t& lineNumber, std::string& storage) {
    storage.clear();
    for (;;) {
        std::size_t end = text.find_first_of("\r\n", at);
        if (end == std::string_view::npos) end = text.size();
        std::string_view line = text.substr(at, end - at);
        at = std::min(text.size(), end + 1);
        if (end + 1 < text.size() && text[end] == '\r' && text[end + 1] == '\n') ++at;
        ++lineNumber;
        if (!line.ends_with('\\') || at >= text.size()) {
            if (storage.empty()) return line;
            storage += line;
            return storage;
        }
        line.remove_suffix(1);
        storage += line;
        storage += ' ';
    }
}

std::string_view nextWord(std::string_view& line) {
    const std::size_t begin = line.find_first_not_of(kBlank);
    if (begin == std::string_view::npos) return line = {};
    std::size_t end = line.find_first_of(kBlank, begin);
    if (end == std::string_view::npos) end = line.size();
    const std::string_view word = line.substr(begin, end - begin);
    line.remove_prefix(end);
    return word;
}

}  // namespace

TriangleMesh readObj(const Source& source) {
    TriangleMesh mesh;
    BadCoordinates bad;
    const std::string_view text = source.text();
    std::string storage;
    std::vector<std::uint32_t> corners;
    std::uint64_t lineNumber = 0, highest = 0, highestLine = 0;
    for (std::size_t at = 0; at < text.size();) {
        std::string_view line = nextLine(text, at, lineNumber, storage);
        const std::string_view key = nextWord(line);
        if (key == "v") {
            core::Vec3 v;
            for (double& x : v) {
                const std::string_view word = nextWord(line);
                if (word.empty())
                    source.fail(fmt::format("the vertex in line {} has fewer than three numbers", lineNumber),
                                "export the mesh again");
                if (!parseNumber(word, x))
                    source.fail(fmt::format("{} in line {} is not a number", quoted(word), lineNumber),
                                "export the mesh again");
            }
            if (!isCoordinate(v.x()) || !isCoordinate(v.y()) || !isCoordinate(v.z())) bad.add(mesh.vertices.size());
            mesh.vertices.push_back(v);
        } else if (key == "f") {
            corners.clear();
            for (std::string_view word = nextWord(line); !word.empty(); word = nextWord(line)) {
                if (word.front() == '#') break;
                std::int64_t number = 0;
                if (!parseInteger(word.substr(0, word.find('/')), number) || number == 0)
                    source.fail(fmt::format("{} in line {} is no corner of a face", quoted(word), lineNumber),
                                "export the mesh again");
                // Counted from 1, or backwards from the latest vertex; a later vertex may be named before it comes.
                const std::int64_t index =
                    number > 0 ? number - 1 : number + static_cast<std::int64_t>(mesh.vertices.size());
                if (index < 0 || index >= std::numeric_limits<std::uint32_t>::max())
                    source.fail(
                        fmt::format("the face in line {} names vertex {}, which is not there", lineNumber, number),
                        "export the mesh again");
                if (static_cast<std::uint64_t>(index) >= highest) {
                    highest = static_cast<std::uint64_t>(index) + 1;
                    highestLine = lineNumber;
                }
                corners.push_back(static_cast<std::uint32_t>(index));
            }
            addFan(mesh.triangles, corners);
            if (mesh.triangles.size() > kMaxFaces)
                source.fail(fmt::format("more than the {} faces that are read", kMaxFaces));
        }
        // Everything else (normals, texture, groups, materials, comments) says nothing about the surface.
    }
    if (highest > mesh.vertices.size())
        source.fail(
            fmt::format("the face in line {} names vertex {} of {}", highestLine, highest, mesh.vertices.size()),
            "export the mesh again");
    bad.check(source, "vertices", "vertex");
    return mesh;
}

}  // namespace handpiece::geometry::formats
