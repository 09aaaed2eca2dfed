// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>

#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/brick_index.h"
#include "handpiece/model/field/distance_field.h"
#include "handpiece/model/field/field_builder.h"
#include "handpiece/model/field/packet_distance.h"
#include "handpiece/model/field/tissue_layers.h"
#include "handpiece/model/field/tissue_map.h"

namespace handpiece::field {

using core::Vec3;

namespace {

/// Where the bricks and nodes of a grid lie: the same bits whichever brick asks.
struct Grid {
    explicit Grid(const DistanceField& field) : view(field.view()) {}
    [[nodiscard]] std::size_t rowLength() const { return static_cast<std::size_t>(view.bricks[0]); }
    [[nodiscard]] std::size_t rows() const {
        return static_cast<std::size_t>(view.bricks[1]) * static_cast<std::size_t>(view.bricks[2]);
    }
    /// Half a brick's diagonal and a hair, for the rounding of distances.
    [[nodiscard]] double halfDiagonalMm() const { return 0.5 * std::sqrt(3.0) * kBrickCells * view.voxelMm + 1e-9; }
    /// Tissues are asked for where there is something, or values that tell how far away it is.
    [[nodiscard]] bool matters(std::size_t dense) const {
        return view.brickIndex[dense] >= 0 || view.coarse[dense] < 0.0f;
    }
    [[nodiscard]] Vec3 nodeMm(const std::array<std::int32_t, 3>& brick, int x, int y, int z) const {
        const int local[3] = {x, y, z};
        Vec3 p;
        for (std::size_t k = 0; k < 3; ++k)
            p[static_cast<int>(k)] = view.originMm[k] + view.voxelMm * (kBrickCells * brick[k] + local[k]);
        return p;
    }
    [[nodiscard]] Vec3 centreMm(const std::array<std::int32_t, 3>& brick) const {
        constexpr int kHalf = kBrickCells / 2;
        return nodeMm(brick, kHalf, kHalf, kHalf);
    }

    FieldView view;
};

/// Falling priority; of equals the later comes first.
template <class Part>
std::vector<Part> byPriority(std::span<const Part> parts) {
    std::vector<Part> sorted(parts.rbegin(), parts.rend());
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const Part& a, const Part& b) { return a.priority > b.priority; });
    return sorted;
}

/// Distances of a brick's nodes to a surface, in tiles that fit a packet.
void nodeDistances(const Grid& grid, const std::array<std::int32_t, 3>& brick, const PacketDistance& surface,
                   std::uint32_t seed, float* out) {
    const auto tile = [&](int x0, int x1, int y0, int y1, int z0, int z1) {
        Vec3 points[kPacket];
        int index[kPacket];
        float distance[kPacket];
        int count = 0;
        for (int z = z0; z < z1; ++z)
            for (int y = y0; y < y1; ++y)
                for (int x = x0; x < x1; ++x) {
                    points[count] = grid.nodeMm(brick, x, y, z);
                    index[count++] = x + kBrickNodes * (y + kBrickNodes * z);
                }
        seed = surface.distances(points, count, seed, distance);
        for (int i = 0; i < count; ++i)
            out[index[i]] = distance[i];
    };
    for (int z = 0; z < 8; z += 2)
        for (int y = 0; y < 8; y += 2)
            for (int x = 0; x < 8; x += 4)
                tile(x, x + 4, y, y + 2, z, z + 2);
    for (int z = 0; z < 9; z += 3)
        for (int y = 0; y < 9; y += 3)
            tile(8, 9, y, y + 3, z, z + 3);
    for (int z = 0; z < 9; z += 3)
        for (int x = 0; x < 8; x += 4)
            tile(x, x + 4, 8, 9, z, z + 3);
    for (int y = 0; y < 8; y += 4)
        for (int x = 0; x < 8; x += 4)
            tile(x, x + 4, y, y + 4, 8, 9);
}

}  // namespace

void TissueMap::assemble(std::vector<LayeredBrick> bricks) {
    std::size_t mixed = 0, layers = 0;
    for (const LayeredBrick& brick : bricks) {
        mixed += brick.layers != nullptr;
        layers += brick.layers ? brick.layers->tissues.size() : 0;
    }
    auto nodes = std::make_shared<BrickTissues>(bricks.size());
    nodes->nodes.reserve(BrickTissues::kShared + mixed * kBrickValues);
    ranges_.reserve(mixed);
    layers_.reserve(layers);
    values_.reserve(layers * kBrickValues);  // and so layers may point into it at once
    for (std::size_t i = 0; i < bricks.size(); ++i) {
        nodes->setUniform(i, static_cast<std::uint8_t>(bricks[i].uniform));
        if (!bricks[i].layers) continue;
        const BrickLayers& brick = *bricks[i].layers;
        ranges_.push_back(
            {static_cast<std::uint32_t>(layers_.size()), static_cast<std::uint32_t>(brick.tissues.size()), brick.rest});
        nodes->addMixed(i, brick.nodes.data());
        for (std::size_t k = 0; k < brick.tissues.size(); ++k)
            layers_.push_back({brick.tissues[k], values_.data() + values_.size() + k * kBrickValues});
        values_.insert(values_.end(), brick.values.begin(), brick.values.end());
        bricks[i].layers.reset();
    }
    nodes_ = std::move(nodes);
}

TissueMap TissueMap::fromFunctions(const DistanceField& field, std::span<const PartFunction> given,
                                   cases::Tissue rest) {
    TissueMap map(field);
    const Grid grid(field);
    const std::vector<PartFunction> parts = byPriority(given);
    std::vector<LayeredBrick> bricks(field.storage().coarse.size());
    core::parallelFor(bricks.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (!grid.matters(i)) continue;
            const std::array<std::int32_t, 3> brick = brickAt(grid.view.bricks, static_cast<std::uint32_t>(i));
            const Vec3 centre = grid.centreMm(brick);
            const double slack = grid.halfDiagonalMm();
            std::vector<NearPart> near;
            cases::Tissue under = rest;
            for (const PartFunction& part : parts) {
                const double d = part.signedDistance(centre);
                if (d < -slack) {
                    under = part.tissue;
                    break;
                }
                if (d > slack) continue;
                NearPart& fresh = near.emplace_back(NearPart{part.tissue, {}});
                float* out = fresh.distanceMm.data();
                for (int z = 0; z < kBrickNodes; ++z)
                    for (int y = 0; y < kBrickNodes; ++y)
                        for (int x = 0; x < kBrickNodes; ++x)
                            *out++ = static_cast<float>(part.signedDistance(grid.nodeMm(brick, x, y, z)));
            }
            bricks[i] = layeredBrick(near, under, false, map.unitMm_);
        }
    });
    map.assemble(std::move(bricks));
    return map;
}

TissueMap TissueMap::fromParts(const DistanceField& field, std::span<const PartSurface> given,
                               const core::Progress& progress) {
    // Alone, a part is all there is: what lies in none is of the nearest.
    if (given.size() <= 1) return uniform(field, given.empty() ? cases::Tissue::enamel : given[0].tissue);
    TissueMap map(field);
    const Grid grid(field);
    const std::vector<PartSurface> parts = byPriority(given);
    std::vector<PacketDistance> surfaces;
    surfaces.reserve(parts.size());
    for (const PartSurface& part : parts)
        surfaces.emplace_back(*part.tree);
    core::report(progress, 0.05);

    std::vector<LayeredBrick> bricks(field.storage().coarse.size());
    std::atomic<std::size_t> done{0};
    // Row by row, each search starting from the last one's triangle: rows, not pieces of work, so that ties fall alike.
    core::parallelFor(grid.rows(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            std::vector<std::uint32_t> seed(parts.size(), geometry::kNoTriangle);
            std::vector<double> distance(parts.size());
            for (std::size_t i = row * grid.rowLength(); i < (row + 1) * grid.rowLength(); ++i) {
                if (!grid.matters(i)) continue;
                const std::array<std::int32_t, 3> brick = brickAt(grid.view.bricks, static_cast<std::uint32_t>(i));
                const Vec3 centre = grid.centreMm(brick);
                const double slack = grid.halfDiagonalMm();
                double nearest = std::numeric_limits<double>::infinity();
                std::size_t asked = 0;
                bool covered = false;
                for (; asked < parts.size() && !covered; ++asked) {
                    geometry::NearestPoint n;
                    distance[asked] = parts[asked].tree->signedDistance(centre, &n, seed[asked]);
                    seed[asked] = n.triangle;
                    nearest = std::min(nearest, distance[asked]);
                    covered = distance[asked] < -slack;
                }
                std::vector<std::size_t> candidates;
                for (std::size_t k = 0; k < asked - (covered ? 1 : 0); ++k)
                    if (distance[k] <= slack || (!covered && distance[k] - slack <= nearest + slack))
                        candidates.push_back(k);
                if (candidates.empty() || (!covered && candidates.size() == 1)) {
                    bricks[i].uniform = parts[candidates.empty() ? asked - 1 : candidates[0]].tissue;
                    continue;
                }
                std::vector<NearPart> near(candidates.size());
                for (std::size_t k = 0; k < candidates.size(); ++k) {
                    near[k].tissue = parts[candidates[k]].tissue;
                    nodeDistances(grid, brick, surfaces[candidates[k]], seed[candidates[k]], near[k].distanceMm.data());
                }
                bricks[i] =
                    layeredBrick(near, parts[covered ? asked - 1 : candidates.back()].tissue, !covered, map.unitMm_);
            }
        }
        core::report(progress,
                     0.05 + 0.95 * static_cast<double>(done += end - begin) / static_cast<double>(grid.rows()));
    });
    map.assemble(std::move(bricks));
    return map;
}

}  // namespace handpiece::field
