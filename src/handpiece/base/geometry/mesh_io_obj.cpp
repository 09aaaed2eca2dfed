// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>

#include "handpiece/base/geometry/mesh_io_formats.h"
#include "handpiece/base/geometry/mesh_io_obj_texture.h"

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

// Whether a corner names texture and normal: "7", "7/1", "7//3", "7/1/3".
std::uint32_t formOf(std::string_view corner) {
    std::uint32_t form = 0;
    for (std::size_t i = 0; i < corner.size(); ++i)
        if (corner[i] == '/') form = 4 * form + 1 + (i + 1 < corner.size() && corner[i + 1] != '/');
    return form;
}

// Behind a vertex's coordinates, red, green and blue, some with how opaque they are. A single number there is a weight.
void takeColour(std::string_view line, FoundColours& found) {
    constexpr std::size_t kMost = 4;
    std::array<double, kMost> numbers;
    std::size_t count = 0;
    for (std::string_view word = nextWord(line); !word.empty() && word.front() != '#'; word = nextWord(line)) {
        if (count == kMost || !parseNumber(word, numbers[count])) return;
        ++count;
    }
    if (count >= 3) found.add(numbers[0], numbers[1], numbers[2]);
}

core::Vec3 takeVertex(const Source& source, std::string_view& line, std::uint64_t lineNumber) {
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
    return v;
}

// That a face's corner names, of as many as there were so far.
std::uint32_t vertexAt(const Source& source, std::string_view word, std::size_t vertices, std::uint64_t lineNumber) {
    std::int64_t number = 0;
    if (!parseInteger(word.substr(0, word.find('/')), number) || number == 0)
        source.fail(fmt::format("{} in line {} is no corner of a face", quoted(word), lineNumber),
                    "export the mesh again");
    // Counted from 1, or backwards from the latest vertex; a later vertex may be named before it comes.
    const std::int64_t index = number > 0 ? number - 1 : number + static_cast<std::int64_t>(vertices);
    if (index < 0 || index >= std::numeric_limits<std::uint32_t>::max())
        source.fail(fmt::format("the face in line {} names vertex {}, which is not there", lineNumber, number),
                    "export the mesh again");
    return static_cast<std::uint32_t>(index);
}

/// Finds files that were put behind one another. A block is vertices and the faces after them; an OBJ counts its
/// vertices through, so a block is of another file when its faces name vertex 1 again, and none beyond as many as the
/// block has.
class Blocks {
  public:
    struct Glued {
        std::uint64_t files = 1, line = 0;  ///< of the second file's first vertex
        std::size_t bytes = 0;              ///< of the first file
    };

    void vertex(std::size_t vertices, std::size_t at, std::uint64_t line) {
        if (!hasFaces_ && vertices > 0) return;
        close(vertices);
        hasFaces_ = false;
        first_ = vertices, at_ = at, line_ = line;
        least_ = std::numeric_limits<std::uint32_t>::max(), most_ = 0;
    }
    void face(std::span<const std::uint32_t> corners) {
        hasFaces_ = true;
        for (const std::uint32_t corner : corners)
            least_ = std::min(least_, corner), most_ = std::max(most_, corner);
    }
    /// Once, when all is read.
    [[nodiscard]] const Glued& settle(std::size_t vertices) {
        close(vertices);
        return glued_;
    }

  private:
    void close(std::size_t vertices) {
        if (!hasFaces_ || first_ == 0 || least_ != 0 || most_ >= vertices - first_) return;
        if (glued_.files++ == 1) glued_.line = line_, glued_.bytes = at_;
    }

    Glued glued_;
    bool hasFaces_ = false;
    std::size_t first_ = 0, at_ = 0;
    std::uint64_t line_ = 0;
    std::uint32_t least_ = 0, most_ = 0;
};

void tellLeftOut(const Source& source, std::uint64_t lines, std::uint64_t curved) {
    if (lines > 0)
        source.note(fmt::format("{} of points or lines {} left out: they are no surface",
                                lines == 1 ? "an element" : fmt::format("{} elements", lines),
                                lines == 1 ? "is" : "are"));
    if (curved > 0)
        source.note(fmt::format("{} {} left out: export it as triangles", curved,
                                curved == 1 ? "free-form curve or surface is" : "free-form curves or surfaces are"));
}

std::size_t unusedVertices(const TriangleMesh& mesh) {
    std::vector<bool> used(mesh.vertices.size(), false);
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t)
            used[v] = true;
    return static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
}

void tellUnused(const Source& source, std::size_t unused, std::size_t vertices) {
    source.note(
        fmt::format("{} of {} vertices are in no face: a file that was cut short looks like this", unused, vertices));
}

TriangleMesh readFirst(const Source& source, const Blocks::Glued& glued, VertexColours* colours) {
    const Source first{source.data.first(glued.bytes), source.where, source.notes, source.folder};
    TriangleMesh mesh = readObj(first, colours);
    source.note(
        fmt::format("{} files were glued into one: from line {} on the faces count their vertices from 1 again; only "
                    "the first is read, with {} faces; save each as a file of its own",
                    glued.files, glued.line, mesh.triangles.size()));
    return mesh;
}

}  // namespace

TriangleMesh readObj(const Source& source, VertexColours* colours) {
    TriangleMesh mesh;
    FoundColours found;
    ObjTexture texture;
    Blocks blocks;
    BadCoordinates bad;
    const std::string_view text = source.text();
    std::string storage;
    std::vector<std::uint32_t> corners;
    Polygons polygons;
    std::uint64_t lineNumber = 0, highest = 0, highestLine = 0, lines = 0, curved = 0;
    // A file that is cut short ends in the middle of a line, seldom where one cannot tell.
    const bool endsOpen = text.back() != '\n' && text.back() != '\r';
    std::uint32_t form = 0;
    bool isAnotherForm = false, endsWithFace = false;
    const auto failCut = [&] {
        source.fail(fmt::format("the file ends in the middle of line {}", lineNumber), "export or copy the mesh again");
    };
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t lineAt = at;
        std::string_view line = nextLine(text, at, lineNumber, storage);
        const std::string_view key = nextWord(line);
        const bool isCut = endsOpen && at >= text.size();
        endsWithFace = key == "f";
        if (key == "v") {
            if (isCut) failCut();  // what would follow it is missing, if not its digits
            const core::Vec3 v = takeVertex(source, line, lineNumber);
            if (!isCoordinate(v.x()) || !isCoordinate(v.y()) || !isCoordinate(v.z())) bad.add(mesh.vertices.size());
            blocks.vertex(mesh.vertices.size(), lineAt, lineNumber);
            mesh.vertices.push_back(v);
            if (colours != nullptr) takeColour(line, found);
        } else if (key == "f") {
            corners.clear();
            for (std::string_view word = nextWord(line); !word.empty(); word = nextWord(line)) {
                if (word.front() == '#') break;
                const std::uint32_t index = vertexAt(source, word, mesh.vertices.size(), lineNumber);
                if (index >= highest) highest = std::uint64_t{index} + 1, highestLine = lineNumber;
                corners.push_back(index);
                if (colours != nullptr) texture.corner(word, index, mesh.vertices.size());
                isAnotherForm = mesh.triangles.size() > 0 && formOf(word) != form;
                form = formOf(word);
            }
            if (isCut && (corners.size() < 3 || isAnotherForm)) failCut();
            if (corners.size() < 3)
                source.fail(fmt::format("the face in line {} has fewer than three corners", lineNumber),
                            "export the mesh again");
            blocks.face(corners);
            polygons.add(mesh.triangles, corners);
            if (mesh.triangles.size() > kMaxFaces)
                source.fail(fmt::format("more than the {} faces that are read", kMaxFaces));
        } else if (key == "l" || key == "p") {
            ++lines;
        } else if (key == "curv" || key == "curv2" || key == "surf") {
            ++curved;
        } else if (colours != nullptr) {
            texture.take(key, line);
        }
        // Everything else (normals, groups, comments) says nothing about the surface.
    }
    if (const Blocks::Glued& glued = blocks.settle(mesh.vertices.size()); glued.files > 1)
        return readFirst(source, glued, colours);
    if (highest > mesh.vertices.size())
        source.fail(
            fmt::format("the face in line {} names vertex {} of {}", highestLine, highest, mesh.vertices.size()),
            "export the mesh again");
    bad.check(source, "vertices", "vertex");
    if (colours != nullptr) {
        *colours = found.settle(source, mesh.vertices.size(), 1.0);
        if (colours->empty()) *colours = texture.colours(source, mesh.vertices.size());
    }
    settle(polygons, mesh, source);
    tellLeftOut(source, lines, curved);
    const std::size_t unused = unusedVertices(mesh);
    if (endsOpen && endsWithFace && unused > 0 && !mesh.triangles.empty()) failCut();
    if (endsOpen && endsWithFace) source.note("the last line has no end: see that the last face is whole");
    if (unused > 0 && !mesh.triangles.empty()) tellUnused(source, unused, mesh.vertices.size());
    return mesh;
}

}  // namespace handpiece::geometry::formats
