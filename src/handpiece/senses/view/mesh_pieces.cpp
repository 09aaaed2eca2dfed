// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/mesh_pieces.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>

namespace handpiece::view {
namespace {

using core::Vec3;

std::array<float, 3> floats(const Vec3& v) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// Triangles round each vertex, one list after the other.
struct Fans {
    std::vector<std::uint32_t> first, triangles;
};
Fans fansOf(const geometry::TriangleMesh& mesh) {
    Fans fans;
    fans.first.assign(mesh.vertices.size() + 1, 0);
    for (const geometry::Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t)
            ++fans.first[v + 1];
    for (std::size_t i = 1; i < fans.first.size(); ++i)
        fans.first[i] += fans.first[i - 1];
    fans.triangles.resize(3 * mesh.triangles.size());
    std::vector<std::uint32_t> next(fans.first.begin(), fans.first.end() - 1);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
        for (const std::uint32_t v : mesh.triangles[i])
            fans.triangles[next[v]++] = i;
    return fans;
}

}  // namespace

MeshPiece pieceOf(const surface::BrickMesh& mesh, const std::vector<float>* removedDepthMm) {
    MeshPiece piece;
    piece.triangles = mesh.triangles;
    piece.vertices.reserve(mesh.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const surface::SurfaceVertex& v = mesh.vertices[i];
        const float removed = removedDepthMm != nullptr && i < removedDepthMm->size() ? (*removedDepthMm)[i] : 0.0f;
        piece.vertices.push_back({v.positionMm, packedNormal(v.normal), static_cast<std::uint8_t>(v.tissue), 0,
                                  static_cast<std::uint16_t>(std::clamp(1000.0f * removed, 0.0f, 65535.0f))});
    }
    return piece;
}

std::vector<MeshPiece> piecesOf(const geometry::TriangleMesh& mesh, cases::Tissue tissue, double creaseRad,
                                double cellMm) {
    const Fans fans = fansOf(mesh);
    std::vector<Vec3> faceNormals;  // as long as twice the area: large faces count for more
    faceNormals.reserve(mesh.triangles.size());
    for (const geometry::Triangle& t : mesh.triangles)
        faceNormals.push_back(
            (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]));

    struct Building {
        MeshPiece piece;
        std::unordered_map<std::uint64_t, std::uint16_t> known;  // vertex and normal -> number
    };
    std::map<std::array<int, 3>, Building> cells;
    std::vector<MeshPiece> done;
    const double crease = std::cos(creaseRad);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const geometry::Triangle& t = mesh.triangles[i];
        std::array<int, 3> key{};
        if (cellMm > 0.0) {
            const Vec3 middle = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / (3.0 * cellMm);
            for (int k = 0; k < 3; ++k)
                key[static_cast<std::size_t>(k)] = static_cast<int>(std::floor(middle[k]));
        }
        Building& cell = cells[key];
        const double length = faceNormals[i].norm();
        std::array<std::uint16_t, 3> corners{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t v = t[k];
            Vec3 normal = Vec3::Zero();
            for (std::uint32_t f = fans.first[v]; f < fans.first[v + 1]; ++f) {
                const Vec3& other = faceNormals[fans.triangles[f]];
                if (other.dot(faceNormals[i]) >= crease * other.norm() * length) normal += other;
            }
            const double size = normal.norm();
            const std::uint32_t packed = packedNormal(floats(size > 0.0 ? Vec3(normal / size) : Vec3::UnitZ()));
            const std::uint64_t identity = std::uint64_t{v} << 32 | packed;
            const auto [it, isNew] =
                cell.known.try_emplace(identity, static_cast<std::uint16_t>(cell.piece.vertices.size()));
            if (isNew)
                cell.piece.vertices.push_back(
                    {floats(mesh.vertices[v]), packed, static_cast<std::uint8_t>(tissue), 0, 0});
            corners[k] = it->second;
        }
        cell.piece.triangles.push_back(corners);
        if (cell.piece.vertices.size() > 65000) {
            done.push_back(std::move(cell.piece));
            cell = {};
        }
    }
    for (auto& [key, cell] : cells)
        if (!cell.piece.triangles.empty()) done.push_back(std::move(cell.piece));
    return done;
}

}  // namespace handpiece::view
