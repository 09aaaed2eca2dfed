// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <atomic>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/field_builder.h"
#include "handpiece/model/field/packet_distance.h"
#include "handpiece/model/field/part_tissues.h"

namespace handpiece::field {
namespace {

using core::Vec3;

/// Node (x, y, z) of a brick, 0..8 each.
struct LocalNode {
    std::int8_t x, y, z;
    [[nodiscard]] std::size_t index() const {
        return static_cast<std::size_t>(x + kBrickNodes * (y + kBrickNodes * z));
    }
};

/// Fills the nodes of all stored bricks. Nodes on the faces between bricks belong to one of them; the others copy.
class NodeFiller {
  public:
    explicit NodeFiller(FieldBuilder& builder) : builder_(builder) {}

    /// Computes the nodes that brick `stored` owns, beginning at `seed`; `nearest`, where wanted, gets their triangles.
    void compute(std::size_t stored, const PacketDistance& distance, std::uint32_t seed, std::uint32_t* nearest) {
        const std::array<std::int32_t, 3> brick = builder_.brickAt(builder_.storedBricks()[stored]);
        float* values = builder_.values(stored);
        forEachTile([&](const LocalNode& low, const LocalNode& high) {
            LocalNode nodes[kPacket];
            int count = 0;
            for (std::int8_t z = low.z; z < high.z; ++z)
                for (std::int8_t y = low.y; y < high.y; ++y)
                    for (std::int8_t x = low.x; x < high.x; ++x)
                        if (ownerOffset(brick, {x, y, z}) == 0) nodes[count++] = {x, y, z};
            if (count > 0) seed = computePacket(brick, nodes, count, distance, seed, values, nearest);
        });
    }

    /// The same where the triangles are known. False where they are not those of these nodes.
    [[nodiscard]] bool compute(std::size_t stored, const geometry::TriangleTree& tree, const std::uint32_t* nearest) {
        const std::array<std::int32_t, 3> brick = builder_.brickAt(builder_.storedBricks()[stored]);
        float* values = builder_.values(stored);
        for (std::int8_t z = 0; z < kBrickNodes; ++z)
            for (std::int8_t y = 0; y < kBrickNodes; ++y)
                for (std::int8_t x = 0; x < kBrickNodes; ++x) {
                    const LocalNode node{x, y, z};
                    const std::uint32_t triangle = nearest[node.index()];
                    const bool isOwn = ownerOffset(brick, node) == 0;
                    if (isOwn ? triangle >= tree.triangles().size() : triangle != geometry::kNoTriangle) return false;
                    if (isOwn) values[node.index()] = distanceTo(tree, triangle, placeOf(brick, node));
                }
        return true;
    }

    /// Copies the nodes that other bricks own; all of them must have been computed.
    void copy(std::size_t stored) {
        const std::array<std::int32_t, 3> brick = builder_.brickAt(builder_.storedBricks()[stored]);
        float* values = builder_.values(stored);
        for (std::int8_t z = 0; z < kBrickNodes; ++z)
            for (std::int8_t y = 0; y < kBrickNodes; ++y)
                for (std::int8_t x = 0; x < kBrickNodes; ++x) {
                    if (x > 0 && x < kBrickCells && y > 0 && y < kBrickCells && z > 0 && z < kBrickCells) continue;
                    const LocalNode node{x, y, z};
                    const int owner = ownerOffset(brick, node);
                    if (owner == 0) continue;
                    LocalNode there = node;
                    const std::array<std::int32_t, 3> other = shifted(brick, node, owner, &there);
                    values[node.index()] =
                        builder_.values(static_cast<std::size_t>(builder_.storedAt(other)))[there.index()];
                }
    }

  private:
    template <class F>
    static void forEachTile(F&& visit) {
        // Inside: 4 x 2 x 2 nodes. Then the far faces in tiles of at most 16.
        for (std::int8_t z = 0; z < 8; z += 2)
            for (std::int8_t y = 0; y < 8; y += 2)
                for (std::int8_t x = 0; x < 8; x += 4)
                    visit(LocalNode{x, y, z}, LocalNode{int8(x + 4), int8(y + 2), int8(z + 2)});
        for (std::int8_t z = 0; z < 9; z += 3)
            for (std::int8_t y = 0; y < 9; y += 3)
                visit(LocalNode{8, y, z}, LocalNode{9, int8(y + 3), int8(z + 3)});
        for (std::int8_t z = 0; z < 9; z += 3)
            for (std::int8_t x = 0; x < 8; x += 4)
                visit(LocalNode{x, 8, z}, LocalNode{int8(x + 4), 9, int8(z + 3)});
        for (std::int8_t y = 0; y < 8; y += 4)
            for (std::int8_t x = 0; x < 8; x += 4)
                visit(LocalNode{x, y, 8}, LocalNode{int8(x + 4), int8(y + 4), 9});
    }
    static std::int8_t int8(int v) { return static_cast<std::int8_t>(v); }

    /// The other way a node can be looked at: offset bit k moves one brick along axis k, up where the node lies on the
    /// far face, down where it lies on the near one.
    static std::array<std::int32_t, 3> shifted(std::array<std::int32_t, 3> brick, const LocalNode& node, int offset,
                                               LocalNode* there) {
        std::int8_t* to[3] = {&there->x, &there->y, &there->z};
        const std::int8_t at[3] = {node.x, node.y, node.z};
        for (std::size_t k = 0; k < 3; ++k) {
            if ((offset >> k & 1) == 0) continue;
            const bool far = at[k] == kBrickCells;
            brick[k] += far ? 1 : -1;
            *to[k] = far ? std::int8_t{0} : std::int8_t{kBrickCells};
        }
        return brick;
    }

    /// 0 when the brick owns the node itself, else the offset of the owner: the stored brick in which the node lies
    /// nearest to the near corner (lowest z face first), the same whichever brick asks.
    [[nodiscard]] int ownerOffset(const std::array<std::int32_t, 3>& brick, const LocalNode& node) const {
        const std::int8_t at[3] = {node.x, node.y, node.z};
        int shared = 0, far = 0;
        for (int k = 0; k < 3; ++k) {
            if (at[k] == 0 || at[k] == kBrickCells) shared |= 1 << k;
            if (at[k] == kBrickCells) far |= 1 << k;
        }
        if (shared == 0) return 0;
        // `corner` bit k: on the far face of the candidate along axis k. Ascending: candidates with the node near come
        // first.
        for (int corner = 0; corner < 8; ++corner) {
            if ((corner & ~shared) != 0) continue;
            const int offset = (corner ^ far) & shared;
            if (offset == 0) return 0;
            LocalNode there = node;
            if (builder_.storedAt(shifted(brick, node, offset, &there)) >= 0) return offset;
        }
        return 0;
    }

    [[nodiscard]] Vec3 placeOf(const std::array<std::int32_t, 3>& brick, const LocalNode& node) const {
        return builder_.nodeMm(kBrickCells * std::int64_t{brick[0]} + node.x,
                               kBrickCells * std::int64_t{brick[1]} + node.y,
                               kBrickCells * std::int64_t{brick[2]} + node.z);
    }

    std::uint32_t computePacket(const std::array<std::int32_t, 3>& brick, const LocalNode* nodes, int count,
                                const PacketDistance& search, std::uint32_t seed, float* values,
                                std::uint32_t* nearest) {
        std::array<Vec3, kPacket> point;
        point.fill(Vec3::Zero());  // GCC does not see that `count` is at least 1
        float distance[kPacket];
        std::uint32_t triangle[kPacket];
        for (int i = 0; i < count; ++i)
            point[static_cast<std::size_t>(i)] = placeOf(brick, nodes[i]);
        const std::uint32_t next = search.distances(point.data(), count, seed, distance, triangle);
        for (int i = 0; i < count; ++i)
            values[nodes[i].index()] = distance[i];
        for (int i = 0; nearest != nullptr && i < count; ++i)
            nearest[nodes[i].index()] = triangle[i];
        return next;
    }

    FieldBuilder& builder_;
};

/// A hollow or inside-out tooth shows in its volume, a torn one in extra area. Less area is what a grid makes of sharp
/// edges.
void requireLikeness(const DistanceField& field, const geometry::TriangleMesh& mesh) {
    const auto [volume, area] = field.extent();
    const double wanted = geometry::enclosedVolumeMm3(mesh);
    if (!(std::abs(volume - wanted) <= 0.01 * std::abs(wanted)))
        throw core::Error(
            fmt::format("the distance field holds {:.4g} mm3 where the surface encloses {:.4g} mm3", volume, wanted),
            "distance field",
            "the surface is open, crosses itself or is thinner than a voxel: run 'handpiece mesh repair', or take "
            "smaller voxels");
    const double surface = geometry::surfaceAreaMm2(mesh);
    if (!(area <= 1.05 * surface))
        throw core::Error(
            fmt::format("the distance field's surface has {:.4g} mm2 where the mesh has {:.4g} mm2", area, surface),
            "distance field", "the surface crosses itself: run 'handpiece mesh repair'");
}

}  // namespace

DistanceField FieldBuilder::fromSurface(const geometry::TriangleMesh& mesh, const geometry::TriangleTree& tree,
                                        std::span<const PartSurface> parts, const FieldSettings& settings,
                                        const core::Progress& progress, std::vector<std::uint32_t>* nearest) {
    FieldBuilder builder = around(tree.bounds(), settings);
    core::report(progress, 0.0);
    // Row by row, each search starting from the last one's triangle: rows, not pieces of work, so that ties fall alike.
    std::vector<std::uint32_t> centreTriangle(builder.denseBricks());
    std::vector<double> centreDistance(builder.denseBricks());
    const std::size_t row = static_cast<std::size_t>(builder.bricksAlongX());
    core::parallelFor(builder.denseBricks() / row, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin * row; i < end * row; ++i) {
            geometry::NearestPoint n;
            const std::uint32_t seed = i % row == 0 ? geometry::kNoTriangle : centreTriangle[i - 1];
            centreDistance[i] = tree.signedDistance(builder.centreMm(i), &n, seed);
            centreTriangle[i] = n.triangle;
        }
    });
    builder.classify([&](std::size_t dense) { return centreDistance[dense]; });
    core::report(progress, 0.05);
    builder.store();

    const PartTissues tissues(parts);
    core::parallelFor(builder.denseBricks(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            if (builder.coarse(i) < 0.0f) builder.setCoarseTissue(i, tissues.at(builder.centreMm(i)));
    });

    NodeFiller filler(builder);
    const PacketDistance distance(tree);
    const std::size_t count = builder.storedBricks().size();
    if (nearest != nullptr) nearest->assign(count * kBrickValues, geometry::kNoTriangle);
    std::atomic<std::size_t> done{0};
    core::parallelFor(count, 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            filler.compute(i, distance, centreTriangle[builder.storedBricks()[i]],
                           nearest != nullptr ? &(*nearest)[i * kBrickValues] : nullptr);
            const auto [bx, by, bz] = builder.brickAt(builder.storedBricks()[i]);
            const std::int64_t x0 = kBrickCells * std::int64_t{bx}, y0 = kBrickCells * std::int64_t{by},
                               z0 = kBrickCells * std::int64_t{bz};
            tissues.fill([&](int x, int y, int z) { return builder.nodeMm(x0 + x, y0 + y, z0 + z); },
                         builder.tissues(i));
        }
        core::report(progress, 0.05 + 0.9 * static_cast<double>(done += end - begin) / static_cast<double>(count));
    });
    core::parallelFor(count, 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            filler.copy(i);
    });
    DistanceField field = std::move(builder).finish();
    requireLikeness(field, mesh);
    core::report(progress, 1.0);
    return field;
}

std::optional<FieldStorage> FieldBuilder::fromNearest(const geometry::TriangleTree& tree, const FieldSettings& settings,
                                                      std::vector<float> coarse,
                                                      std::span<const std::uint32_t> nearest) {
    FieldBuilder builder = around(tree.bounds(), settings);
    if (coarse.size() != builder.denseBricks()) return std::nullopt;
    builder.classify([&](std::size_t dense) { return static_cast<double>(coarse[dense]); });
    builder.store();
    const std::size_t count = builder.storedBricks().size();
    if (nearest.size() != count * kBrickValues) return std::nullopt;
    NodeFiller filler(builder);
    std::atomic<bool> fits{true};
    core::parallelFor(count, 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            if (!filler.compute(i, tree, &nearest[i * kBrickValues])) fits = false;
    });
    if (!fits) return std::nullopt;
    core::parallelFor(count, 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            filler.copy(i);
    });
    return std::move(builder.field_);
}

}  // namespace handpiece::field
