// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/mesh_pieces.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "handpiece/base/core/parallel.h"

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

/// As a vertex holds it: what is more is the most.
std::uint16_t micrometres(float mm) {
    return static_cast<std::uint16_t>(std::clamp(1000.0f * mm, 0.0f, 65535.0f));
}

constexpr std::size_t kGingivaTriangles = 5000;  ///< lips and cheeks have some dozens

/// Those that stand in a row with others: here and there an edge of any solid is as sharp.
std::vector<Vec3> inLine(const std::vector<Vec3>& rims) {
    constexpr double kRowMm = 2.0;
    constexpr int kFewest = 10;
    std::vector<Vec3> kept;
    for (const Vec3& p : rims) {
        int near = 0;
        for (const Vec3& q : rims)
            near += (p - q).squaredNorm() < kRowMm * kRowMm ? 1 : 0;
        if (near >= kFewest) kept.push_back(p);
    }
    return kept;
}

/// One in each cube of half a millimetre: the first.
std::vector<Vec3> thinned(const std::vector<Vec3>& points) {
    constexpr double kCubeMm = 0.5;
    std::set<std::array<long, 3>> taken;
    std::vector<Vec3> kept;
    for (const Vec3& p : points)
        if (taken.insert({std::lround(p.x() / kCubeMm), std::lround(p.y() / kCubeMm), std::lround(p.z() / kCubeMm)})
                .second)
            kept.push_back(p);
    return kept;
}

}  // namespace

std::vector<float> underMarginMm(const geometry::TriangleMesh& gingiva) {
    const std::size_t count = gingiva.vertices.size();
    std::vector<float> under(count, 0.0f);
    if (gingiva.triangles.size() < kGingivaTriangles) return under;
    const Fans fans = fansOf(gingiva);
    std::vector<Vec3> normals;
    normals.reserve(gingiva.triangles.size());
    for (const geometry::Triangle& t : gingiva.triangles)
        normals.push_back((gingiva.vertices[t[1]] - gingiva.vertices[t[0]])
                              .cross(gingiva.vertices[t[2]] - gingiva.vertices[t[0]])
                              .normalized());
    // Convex and sharper than any other edge of such a solid.
    const double sharp = std::cos(0.7);
    const auto isRim = [&](std::uint32_t v) {
        for (std::uint32_t i = fans.first[v]; i < fans.first[v + 1]; ++i)
            for (std::uint32_t j = i + 1; j < fans.first[v + 1]; ++j) {
                const std::uint32_t a = fans.triangles[i], b = fans.triangles[j];
                if (!(normals[a].dot(normals[b]) < sharp)) continue;
                const geometry::Triangle &one = gingiva.triangles[a], &two = gingiva.triangles[b];
                int shared = 0;
                Vec3 beyond = gingiva.vertices[v];
                for (const std::uint32_t w : two) {
                    if (std::find(one.begin(), one.end(), w) != one.end())
                        ++shared;
                    else
                        beyond = gingiva.vertices[w];
                }
                if (shared == 2 && normals[a].dot(beyond - gingiva.vertices[v]) < 0.0) return true;
            }
        return false;
    };
    std::vector<Vec3> rims;
    for (std::uint32_t v = 0; v < count; ++v)
        if (isRim(v)) rims.push_back(gingiva.vertices[v]);
    const std::vector<Vec3> margin = thinned(inLine(rims));
    if (margin.empty()) return under;
    core::parallelFor(count, 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            double squared = 1e300;
            for (const Vec3& p : margin)
                squared = std::min(squared, (gingiva.vertices[v] - p).squaredNorm());
            under[v] = std::max(0.02f, static_cast<float>(std::sqrt(squared)));  // what is known is not 0
        }
    });
    return under;
}

MeshPiece pieceOf(const surface::BrickMesh& mesh, const std::vector<float>* removedDepthMm,
                  const std::vector<surface::ScanColour>* scanned) {
    MeshPiece piece;
    piece.triangles = mesh.triangles;
    piece.vertices.reserve(mesh.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const surface::SurfaceVertex& v = mesh.vertices[i];
        const float removed = removedDepthMm != nullptr && i < removedDepthMm->size() ? (*removedDepthMm)[i] : 0.0f;
        piece.vertices.push_back({v.positionMm, packedNormal(v.normal), static_cast<std::uint8_t>(v.tissue), 0,
                                  micrometres(removed),
                                  scanned != nullptr && i < scanned->size() ? (*scanned)[i] : surface::ScanColour{}});
    }
    return piece;
}

std::vector<MeshPiece> piecesOf(const geometry::TriangleMesh& mesh, cases::Tissue tissue, double creaseRad,
                                double cellMm, const geometry::VertexColours& colours) {
    const Fans fans = fansOf(mesh);
    const std::vector<float> under = tissue == cases::Tissue::gum ? underMarginMm(mesh) : std::vector<float>();
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
    const auto scannedAt = [&](std::uint32_t v) {
        return v < colours.size() ? surface::ScanColour{colours[v][0], colours[v][1], colours[v][2], 255}
                                  : surface::ScanColour{};
    };
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
                cell.piece.vertices.push_back({floats(mesh.vertices[v]), packed, static_cast<std::uint8_t>(tissue), 0,
                                               micrometres(under.empty() ? 0.0f : under[v]), scannedAt(v)});
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
