// SPDX-License-Identifier: Apache-2.0
// The bricks' triangles as one mesh.
#include <cmath>
#include <map>
#include <numeric>
#include <unordered_map>

#include "handpiece/base/core/parallel.h"
#include "handpiece/senses/surface/brick_state.h"
#include "handpiece/senses/surface/closed_surface.h"
#include "handpiece/senses/surface/part_source.h"
#include "handpiece/senses/surface/surface.h"
#include "handpiece/senses/surface/triangle_list.h"
#include "handpiece/senses/surface/untangle.h"

namespace handpiece::surface {
namespace {

core::Vec3 asVec3(const std::array<float, 3>& v) {
    return {v[0], v[1], v[2]};
}

/// Leaves out shells that hold less than `mm3`, islands and bubbles alike.
geometry::TriangleMesh withoutSpecks(const geometry::TriangleMesh& mesh, double mm3) {
    std::vector<std::uint32_t> parent(mesh.vertices.size());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto find = [&](std::uint32_t v) {
        while (parent[v] != v)
            v = parent[v] = parent[parent[v]];
        return v;
    };
    for (const auto& [a, b, c] : mesh.triangles) {
        parent[find(a)] = find(b);
        parent[find(b)] = find(c);
    }
    std::vector<double> volume(mesh.vertices.size(), 0.0);
    for (const auto& [a, b, c] : mesh.triangles) {
        const std::uint32_t shell = find(a);
        const core::Vec3& origin = mesh.vertices[shell];
        volume[shell] +=
            (mesh.vertices[a] - origin).dot((mesh.vertices[b] - origin).cross(mesh.vertices[c] - origin)) / 6.0;
    }
    geometry::TriangleMesh kept;
    constexpr std::uint32_t kNew = 0xffffffffu;
    std::vector<std::uint32_t> number(mesh.vertices.size(), kNew);
    for (const geometry::Triangle& t : mesh.triangles) {
        if (std::abs(volume[find(t[0])]) < mm3) continue;
        geometry::Triangle& made = kept.triangles.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            if (number[t[k]] == kNew) {
                number[t[k]] = static_cast<std::uint32_t>(kept.vertices.size());
                kept.vertices.push_back(mesh.vertices[t[k]]);
            }
            made[k] = number[t[k]];
        }
    }
    return kept;
}

}  // namespace

geometry::TriangleMesh closedSurface(const BrickSource& source, const core::Progress& progress) {
    Surface surface(source);
    surface.buildUpTo(1, core::part(progress, 0.0, 0.4));
    geometry::TriangleMesh mesh = surface.closedMesh();
    untangle(source, surface.bricks_, mesh, core::part(progress, 0.4, 1.0));
    const double voxelMm = source.grid().voxelMm;
    return withoutSpecks(mesh, voxelMm * voxelMm * voxelMm);
}

geometry::TriangleMesh closedPart(const BrickSource& source, const field::TissueMap& tissues, cases::Tissue tissue,
                                  const core::Progress& progress) {
    return closedSurface(PartSource(source, tissues, tissue), progress);
}

geometry::TriangleMesh Surface::closedMesh() const {
    geometry::TriangleMesh mesh;
    std::vector<std::uint32_t> held;  // bricks with surface
    std::vector<std::uint32_t> first(bricks_.size(), 0);
    for (std::uint32_t dense = 0; dense < bricks_.size(); ++dense) {
        if (bricks_[dense] == nullptr) continue;
        held.push_back(dense);
        first[dense] = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const SheetVertex& v : bricks_[dense]->contour.vertices)
            mesh.vertices.push_back(asVec3(v.positionMm));
    }
    struct Piece {
        std::vector<geometry::Triangle> triangles;
        std::vector<TriangleList::Extra> extras;
    };
    // An extra vertex is numbered by its brick until all bricks are there.
    constexpr std::uint32_t kExtraBit = 1u << 31;
    std::vector<Piece> pieces(held.size());
    core::parallelFor(held.size(), 16, [&](std::size_t begin, std::size_t end) {
        TriangleList list;
        for (std::size_t i = begin; i < end; ++i) {
            list.fill(grid(), held[i], lowNeighbours(grid(), bricks_, held[i]), true);
            std::array<std::uint32_t, 8> base{};
            for (int slot = 0; slot < 8; ++slot) {
                const std::int64_t other = grid().neighbour(held[i], -(slot & 1), -(slot >> 1 & 1), -(slot >> 2));
                if (other >= 0) base[static_cast<std::size_t>(slot)] = first[static_cast<std::size_t>(other)];
            }
            for (const auto& t : list.triangles()) {
                geometry::Triangle& made = pieces[i].triangles.emplace_back();
                for (std::size_t k = 0; k < 3; ++k)
                    made[k] = (t[k] & TriangleList::kExtra) != 0 ? kExtraBit | (t[k] & 0xffff)
                                                                 : base[t[k] >> 16] + (t[k] & 0xffff);
            }
            pieces[i].extras = list.extras();
        }
    });
    std::unordered_map<std::uint64_t, std::uint32_t> numberOf;
    for (const Piece& piece : pieces)
        for (geometry::Triangle t : piece.triangles) {
            for (std::uint32_t& corner : t) {
                if ((corner & kExtraBit) == 0) continue;
                const TriangleList::Extra& extra = piece.extras[corner & ~kExtraBit];
                const auto [at, isNew] =
                    numberOf.try_emplace(extra.key, static_cast<std::uint32_t>(mesh.vertices.size()));
                if (isNew) mesh.vertices.push_back(asVec3(extra.vertex.positionMm));
                corner = at->second;
            }
            mesh.triangles.push_back(t);
        }
    return mesh;
}

geometry::TriangleMesh Surface::tissueMesh(cases::Tissue tissue) const {
    geometry::TriangleMesh mesh;
    std::map<std::array<float, 3>, std::uint32_t> numberOf;
    for (const auto& brick : bricks_) {
        if (brick == nullptr || brick->mesh == nullptr) continue;
        const BrickMesh& part = *brick->mesh;
        for (const auto& t : part.triangles) {
            if (part.vertices[t[0]].tissue != tissue) continue;
            geometry::Triangle& made = mesh.triangles.emplace_back();
            for (std::size_t k = 0; k < 3; ++k) {
                const auto& position = part.vertices[t[k]].positionMm;
                const auto [at, isNew] =
                    numberOf.try_emplace(position, static_cast<std::uint32_t>(mesh.vertices.size()));
                if (isNew) mesh.vertices.push_back(asVec3(position));
                made[k] = at->second;
            }
        }
    }
    return mesh;
}

}  // namespace handpiece::surface
