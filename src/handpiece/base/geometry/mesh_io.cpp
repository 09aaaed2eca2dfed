// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/mesh_io.h"

#include <algorithm>
#include <cctype>
#include <cstring>

#include "handpiece/base/core/file.h"
#include "handpiece/base/geometry/mesh_edges.h"
#include "handpiece/base/geometry/mesh_io_formats.h"
#include "handpiece/base/geometry/read_notes.h"

namespace handpiece::geometry {
namespace formats {

std::string quoted(std::string_view word) {
    std::string result = "\"";
    for (const char c : word.substr(0, 24))
        result += c >= ' ' && c <= '~' ? c : '?';
    return result + (word.size() > 24 ? "...\"" : "\"");
}

}  // namespace formats

namespace {

using formats::Source;

std::string lowerExtension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

std::string_view formatName(MeshFormat format) {
    switch (format) {
        case MeshFormat::stl:
            return "STL";
        case MeshFormat::ply:
            return "PLY";
        case MeshFormat::obj:
            return "OBJ";
        case MeshFormat::unknown:
            break;
    }
    return "mesh";
}

bool isText(std::string_view text) {
    return text.substr(0, 4096).find('\0') == std::string_view::npos;
}

// An OBJ says nothing of itself, but its first vertex or face line does.
bool looksLikeObj(std::string_view text) {
    text = text.substr(0, 1 << 16);
    if (!isText(text)) return false;
    for (std::size_t line = 0; line < text.size();) {
        std::size_t end = text.find_first_of("\r\n", line);
        if (end == std::string_view::npos) end = text.size();
        formats::Words words(text.substr(line, end - line));
        const std::string_view key = words.next();
        if (double x; (key == "v" || key == "vn" || key == "vt") && formats::parseNumber(words.next(), x)) return true;
        line = end + 1;
    }
    return false;
}

MeshFormat detect(std::span<const std::byte> data, std::string_view text, MeshFormat hint, bool& binary) {
    binary = false;
    if (text.starts_with("ply") && text.size() > 3 && formats::Words::isSpace(text[3])) return MeshFormat::ply;
    if (formats::isExactBinaryStl(data)) {
        binary = true;
        return MeshFormat::stl;
    }
    // Some binary files start with "solid" too; what follows in them is not text.
    if (isText(text)) {
        std::string start(formats::Words(text).next());
        for (char& c : start)
            c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        if (start == "solid" || start == "facet") return MeshFormat::stl;
    }
    if (looksLikeObj(text) && (hint != MeshFormat::stl || data.size() < 84)) return MeshFormat::obj;
    if (hint == MeshFormat::obj || hint == MeshFormat::ply) return hint;
    binary = true;
    if (hint == MeshFormat::stl) return MeshFormat::stl;
    return data.size() > 84 && !isText(text) ? MeshFormat::stl : MeshFormat::unknown;
}

TriangleMesh readTold(const Source& source, MeshFormat hint, VertexColours* colours) {
    if (source.data.empty()) source.fail("the file is empty", "export or download the mesh again");
    if (!formats::isExactBinaryStl(source.data)) formats::refuseForeign(source);
    bool binary = false;
    const MeshFormat format = detect(source.data, source.text(), hint, binary);
    if (hint != MeshFormat::unknown && format != MeshFormat::unknown && hint != format)
        source.note(fmt::format("named like {}, but its content is {}", formatName(hint), formatName(format)));
    TriangleMesh mesh;
    switch (format) {
        case MeshFormat::stl:
            // A count of facets, and the numbers after it, have bytes of zero.
            if (binary && isText(source.text()) && source.data.size() >= 84)
                source.fail(fmt::format("this is text that begins with {}, and no STL",
                                        formats::quoted(formats::Words(source.text()).next())),
                            "export or download the mesh again");
            mesh = binary ? formats::readBinaryStl(source) : formats::readAsciiStl(source);
            break;
        case MeshFormat::ply:
            mesh = formats::readPly(source, colours);
            break;
        case MeshFormat::obj:
            mesh = formats::readObj(source, colours);
            break;
        case MeshFormat::unknown:
            source.fail("this is no STL, PLY or OBJ file", "give a mesh in one of these formats");
    }
    if (mesh.triangles.empty()) source.fail("the file has no faces", "export a surface of triangles or polygons");
    const auto flat =
        std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [](const Triangle& t) { return repeatsCorner(t); });
    if (flat > 0)
        source.note(fmt::format("{} of {} faces {} two corners in one place and count{} for nothing", flat,
                                mesh.triangles.size(), flat == 1 ? "has" : "have", flat == 1 ? "s" : ""));
    return mesh;
}

TriangleMesh readNoting(std::span<const std::byte> data, MeshFormat hint, const std::string& where, ReadNotes* notes,
                        VertexColours* colours, const std::filesystem::path& folder = {}) {
    // Some editors put a byte order mark before text; it would hide the first word.
    if (data.size() >= 3 && data[0] == std::byte{0xef} && data[1] == std::byte{0xbb} && data[2] == std::byte{0xbf} &&
        !formats::isExactBinaryStl(data))
        data = data.subspan(3);
    ReadNotes found;
    const Source source{data, where, &found, folder};
    TriangleMesh mesh = readTold(source, hint, colours);
    if (notes)
        notes->insert(notes->end(), found.begin(), found.end());
    else
        tellNotes(where, found);
    return mesh;
}

}  // namespace

MeshFormat meshFormatOf(const std::filesystem::path& path) {
    const std::string extension = lowerExtension(path);
    if (extension == ".stl") return MeshFormat::stl;
    if (extension == ".ply") return MeshFormat::ply;
    if (extension == ".obj") return MeshFormat::obj;
    return MeshFormat::unknown;
}

TriangleMesh readMesh(const std::filesystem::path& path, ReadNotes* notes) {
    return readMesh(core::readFile(path, kMaxMeshBytes), meshFormatOf(path), path.string(), notes);
}

TriangleMesh readMesh(std::span<const std::byte> data, MeshFormat hint, const std::string& where, ReadNotes* notes) {
    return readNoting(data, hint, where, notes, nullptr);
}

ColouredMesh readColouredMesh(const std::filesystem::path& path, ReadNotes* notes) {
    const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
    ColouredMesh read;
    read.mesh = readNoting(core::readFile(path, kMaxMeshBytes), meshFormatOf(path), path.string(), notes, &read.colours,
                           folder);
    return read;
}

ColouredMesh readColouredMesh(std::span<const std::byte> data, MeshFormat hint, const std::string& where,
                              ReadNotes* notes) {
    ColouredMesh read;
    read.mesh = readNoting(data, hint, where, notes, &read.colours);
    return read;
}

}  // namespace handpiece::geometry
