// SPDX-License-Identifier: Apache-2.0
#include <cstring>

#include "handpiece/base/core/file.h"
#include "handpiece/base/geometry/mesh_io_formats.h"

namespace handpiece::geometry {
namespace {

template <class T>
std::byte* put(std::byte* at, const T& value) {
    std::memcpy(at, &value, sizeof value);
    return at + sizeof value;
}

}  // namespace

void requireValidIndices(const TriangleMesh& mesh, const std::string& where) {
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
        for (const std::uint32_t v : mesh.triangles[f])
            if (v >= mesh.vertices.size())
                throw core::Error(
                    fmt::format("face {} names vertex {} of {}", f + 1, std::uint64_t{v} + 1, mesh.vertices.size()),
                    where);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        if (!mesh.vertices[v].allFinite()) throw core::Error(fmt::format("vertex {} is not finite", v + 1), where);
}

std::vector<std::byte> stlBytes(const TriangleMesh& mesh, const std::string& where) {
    requireValidIndices(mesh, where);
    if (mesh.triangles.size() > formats::kMaxFaces)
        throw core::Error(fmt::format("{} faces are more than an STL may have here", mesh.triangles.size()), where);
    std::vector<std::byte> data(84 + 50 * mesh.triangles.size());
    // Must not start with "solid": some readers would take it for text.
    constexpr char kTitle[] = "binary STL, millimetres, written by handpiece";
    std::memcpy(data.data(), kTitle, sizeof kTitle);
    std::byte* at = put(data.data() + 80, static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const Triangle& t : mesh.triangles) {
        const core::Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
        const core::Vec3 normal = (b - a).cross(c - a);
        const double length = normal.norm();
        for (int k = 0; k < 3; ++k)
            at = put(at, static_cast<float>(length > 0.0 ? normal[k] / length : 0.0));
        for (const std::uint32_t v : t)
            for (int k = 0; k < 3; ++k)
                at = put(at, static_cast<float>(mesh.vertices[v][k]));
        at = put(at, std::uint16_t{0});
    }
    return data;
}

void writeStl(const std::filesystem::path& path, const TriangleMesh& mesh) {
    core::writeFile(path, stlBytes(mesh, path.string()));
}

std::vector<std::byte> plyBytes(const TriangleMesh& mesh, const VertexColours& colours, const std::string& where) {
    requireValidIndices(mesh, where);
    requireOneAVertex(mesh, colours, where);
    const std::string header = fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment millimetres, written by handpiece\nelement vertex {}\n"
        "property double x\nproperty double y\nproperty double z\n{}element face {}\nproperty list uchar uint "
        "vertex_indices\n"
        "end_header\n",
        mesh.vertices.size(), colours.empty() ? "" : "property uchar red\nproperty uchar green\nproperty uchar blue\n",
        mesh.triangles.size());
    const std::size_t vertexBytes = colours.empty() ? 24 : 27;
    std::vector<std::byte> data(header.size() + vertexBytes * mesh.vertices.size() + 13 * mesh.triangles.size());
    std::memcpy(data.data(), header.data(), header.size());
    std::byte* at = data.data() + header.size();
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        for (int k = 0; k < 3; ++k)
            at = put(at, mesh.vertices[v][k]);
        if (!colours.empty()) at = put(at, colours[v]);
    }
    for (const Triangle& t : mesh.triangles) {
        at = put(at, std::uint8_t{3});
        for (const std::uint32_t v : t)
            at = put(at, v);
    }
    return data;
}

void writePly(const std::filesystem::path& path, const TriangleMesh& mesh, const VertexColours& colours) {
    core::writeFile(path, plyBytes(mesh, colours, path.string()));
}

void writeMesh(const std::filesystem::path& path, const TriangleMesh& mesh, const VertexColours& colours) {
    switch (meshFormatOf(path)) {
        case MeshFormat::stl:
            return writeStl(path, mesh);
        case MeshFormat::ply:
            return writePly(path, mesh, colours);
        default:
            throw core::Error("meshes are written as .stl or .ply", path.string(), "name the output so");
    }
}

}  // namespace handpiece::geometry
