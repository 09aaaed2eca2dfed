// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/surface/triangle_list.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "handpiece/senses/surface/cell_cases.h"
#include "handpiece/senses/surface/float3.h"

namespace handpiece::surface {
namespace {

/// Cosine between two triangles; -1 when one has no area.
float flatness(const Float3& n, const Float3& m) {
    const float lengths = dot(n, n) * dot(m, m);
    return lengths > 0.0f ? dot(n, m) / std::sqrt(lengths) : -1.0f;
}

}  // namespace

LowNeighbours lowNeighbours(const BrickGrid& grid, const std::vector<std::unique_ptr<BrickState>>& bricks,
                            std::uint32_t dense) {
    LowNeighbours low{};
    for (int slot = 0; slot < 8; ++slot) {
        const std::int64_t other = grid.neighbour(dense, -(slot & 1), -(slot >> 1 & 1), -(slot >> 2));
        if (other >= 0) low[static_cast<std::size_t>(slot)] = bricks[static_cast<std::size_t>(other)].get();
    }
    return low;
}

void TriangleList::fill(const BrickGrid& grid, std::uint32_t dense, const LowNeighbours& bricks, bool fine) {
    grid_ = &grid;
    brick_ = grid.at(dense);
    bricks_ = &bricks;
    fine_ = fine;
    triangles_.clear();
    extras_.clear();
    uses_ = 0;
    for (std::size_t slot = 0; slot < 8; ++slot)
        vertices_[slot] = bricks[slot] != nullptr ? bricks[slot]->shown(fine).data() : nullptr;
    const auto& rows = bricks[0]->contour.rows;
    const auto row = [&](int y, int z) -> unsigned { return rows[static_cast<std::size_t>(y + 9 * z)]; };
    for (int z = 0; z < 8; ++z)
        for (int y = 0; y < 8; ++y) {
            const unsigned here = row(y, z);
            const unsigned crossed[3] = {here ^ here >> 1, here ^ row(y + 1, z), here ^ row(y, z + 1)};
            for (int axis = 0; axis < 3; ++axis)
                for (unsigned bits = crossed[axis] & 0xff; bits != 0; bits &= bits - 1) {
                    const int x = std::countr_zero(bits);
                    addEdge({x, y, z}, axis, (here >> x & 1) != 0);
                }
        }
}

TriangleList::Corner TriangleList::corner(const std::array<int, 3>& node, int axis, int du, int dw) {
    std::array<int, 3> cell = node;
    cell[static_cast<std::size_t>((axis + 1) % 3)] -= du;
    cell[static_cast<std::size_t>((axis + 2) % 3)] -= dw;
    std::uint32_t slot = 0;
    for (std::size_t k = 0; k < 3; ++k)
        if (cell[k] < 0) {
            slot |= 1u << k;
            cell[k] = 7;
        }
    Corner c{(*bricks_)[slot], slot, static_cast<std::uint16_t>(cell[0] + 8 * (cell[1] + 8 * cell[2])),
             static_cast<std::uint8_t>(4 * axis + du + 2 * dw), 0};
    if (c.brick == nullptr) return c;
    const std::uint8_t sheet = (*cases_)[c.brick->contour.cases[c.cell]].sheetOf[c.edge];
    // While a neighbour's news is still on its way it does not know of this crossing; the triangles follow with it.
    if (sheet == kNoSheet) {
        c.brick = nullptr;
        return c;
    }
    std::uint32_t index = c.brick->contour.first[c.cell] + std::uint32_t{sheet};
    if (!fine_ && c.brick->level > 0) index = c.brick->coarseOf[index];
    c.ref = slot << 16 | index;
    return c;
}

/// On a face with four crossings the dual surface has two edges between the cells; they fall together when each cell
/// has both pairs of crossings in one sheet.
bool TriangleList::fallsTogether(const Corner& from, const Corner& to, unsigned flip) const {
    if (!fine_ && (from.brick->level > 0 || to.brick->level > 0)) return false;
    const auto joined = [&](const Corner& c) {
        const unsigned bits = c.brick->contour.cases[c.cell];
        if (isPlainCase(bits)) return false;
        const CellCase& cell = (*cases_)[bits];
        const unsigned other = c.edge ^ flip;
        if (cell.sheetOf[other] != cell.sheetOf[c.edge]) return false;
        const auto begins = [&](unsigned e) { return bits >> edgeCorner(static_cast<int>(e)) & 1; };
        return begins(other) != begins(c.edge);
    };
    return joined(from) && joined(to);
}

TriangleList::Ref TriangleList::addExtra(const std::array<int, 3>& node, int axis, int across, int direction, bool low,
                                         const Corner& from, const Corner& to) {
    // Between the face's centre and the corner about which the pair of crossings turns, in quarters of a voxel.
    std::array<std::int64_t, 3> quarter;
    std::array<std::int64_t, 3> first;  // node of the face
    for (std::size_t k = 0; k < 3; ++k) {
        first[k] = 8 * std::int64_t{brick_[k]} + node[k];
        quarter[k] = 4 * first[k];
    }
    const auto a = static_cast<std::size_t>(axis), s = static_cast<std::size_t>(across);
    quarter[a] += low ? 1 : 3;
    quarter[s] += direction;
    if (direction < 0) first[s] -= 1;
    Extra extra;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto i = static_cast<int>(k);
        extra.vertex.positionMm[k] =
            static_cast<float>(grid_->originMm[i] + grid_->voxelMm * (0.25 * static_cast<double>(quarter[k])));
        extra.vertex.normal[k] = vertex(from.ref).normal[k] + vertex(to.ref).normal[k];
    }
    extra.vertex.isSharp = true;
    const SheetVertex &v = vertex(from.ref), &w = vertex(to.ref);
    extra.vertex.tissue = v.positionMm < w.positionMm ? v.tissue : w.tissue;
    const auto side = [&](int k) { return static_cast<std::uint64_t>(8 * grid_->bricks[k] + 1); };
    const auto at = [&](std::size_t k) { return static_cast<std::uint64_t>(first[k]); };
    const std::uint64_t face = at(0) + side(0) * (at(1) + side(1) * at(2));
    // Of the two such corners the one that is low along the lower of the face's axes, or the other.
    const bool isLow = axis < across ? low : direction > 0;
    extra.key = (face * 3 + static_cast<std::uint64_t>(3 - axis - across)) * 2 + (isLow ? 0 : 1);
    extras_.push_back(extra);
    return kExtra | static_cast<Ref>(extras_.size() - 1);
}

/// Most edges: their four cells lie in the brick itself, with one sheet and nothing to tell apart in each.
bool TriangleList::addPlainEdge(const std::array<int, 3>& node, int axis, bool rising) {
    const int u = (axis + 1) % 3, w = (axis + 2) % 3;
    const BrickState& brick = *(*bricks_)[0];
    if (node[static_cast<std::size_t>(u)] == 0 || node[static_cast<std::size_t>(w)] == 0) return false;
    if (!fine_ && brick.level > 0) return false;
    const int last = node[0] + 8 * (node[1] + 8 * node[2]), du = 1 << (3 * u), dw = 1 << (3 * w);
    const int cells[4] = {last - du - dw, last - dw, last, last - du};  // counter-clockwise about the axis
    std::array<Ref, 4> q;
    for (std::size_t i = 0; i < 4; ++i) {
        const auto cell = static_cast<std::size_t>(cells[i]);
        if (!isPlainCase(brick.contour.cases[cell])) return false;
        q[rising ? i : 3 - i] = brick.contour.first[cell];
    }
    uses_ |= 1;
    addQuad(q);
    return true;
}

void TriangleList::addEdge(const std::array<int, 3>& node, int axis, bool rising) {
    if (addPlainEdge(node, axis, rising)) return;
    // The cells round the edge, counter-clockwise about its axis.
    std::array<Corner, 4> c = {corner(node, axis, 1, 1), corner(node, axis, 0, 1), corner(node, axis, 0, 0),
                               corner(node, axis, 1, 0)};
    bool isWhole = true;
    for (const Corner& each : c) {
        uses_ = static_cast<std::uint8_t>(uses_ | 1u << each.slot);
        isWhole = isWhole && each.brick != nullptr;
    }
    if (!isWhole) return;
    const int u = (axis + 1) % 3, w = (axis + 2) % 3;
    // Faces between one cell and the next: the other edge across the face is got by flipping this bit of the edge.
    constexpr unsigned kFlip[4] = {2, 1, 2, 1};
    const int across[4] = {w, u, w, u};
    constexpr int kDirection[4] = {-1, 1, 1, -1};
    const int face[4] = {2 * u + 1, 2 * w + 1, 2 * u, 2 * w};  // of the first cell
    std::array<Ref, 8> polygon;
    std::size_t count = 0, firstExtra = 8;
    for (std::size_t i = 0; i < 4; ++i) {
        polygon[count++] = c[i].ref;
        const Corner& next = c[(i + 1) % 4];
        if (!fallsTogether(c[i], next, kFlip[i])) continue;
        firstExtra = std::min(firstExtra, count);
        const bool isJoined = (c[i].brick->contour.cases[c[i].cell] >> (8 + face[i]) & 1) != 0;
        polygon[count++] = addExtra(node, axis, across[i], kDirection[i], rising != isJoined, c[i], next);
    }
    if (count == 4) {
        addQuad(rising ? std::array{c[0].ref, c[1].ref, c[2].ref, c[3].ref}
                       : std::array{c[3].ref, c[2].ref, c[1].ref, c[0].ref});
        return;
    }
    // A fan from a vertex that no other fan goes out from to these.
    for (std::size_t i = 1; i + 1 < count; ++i) {
        const Ref b = polygon[(firstExtra + i) % count], d = polygon[(firstExtra + i + 1) % count];
        if (rising)
            addTriangle(polygon[firstExtra], b, d);
        else
            addTriangle(polygon[firstExtra], d, b);
    }
}

void TriangleList::addTriangle(Ref a, Ref b, Ref c) {
    if (a != b && b != c && c != a) triangles_.push_back({a, b, c});
}

void TriangleList::addQuad(const std::array<Ref, 4>& q) {
    const SheetVertex *v0 = &vertex(q[0]), *v1 = &vertex(q[1]), *v2 = &vertex(q[2]), *v3 = &vertex(q[3]);
    // An edge of the solid that runs through the quad is its diagonal; else the flatter pair of triangles.
    const bool sharp02 = v0->isSharp && v2->isSharp, sharp13 = v1->isSharp && v3->isSharp;
    bool by02 = sharp02;
    if (sharp02 == sharp13) {
        const Float3 d01 = minus(v1->positionMm, v0->positionMm), d02 = minus(v2->positionMm, v0->positionMm),
                     d03 = minus(v3->positionMm, v0->positionMm), d12 = minus(v2->positionMm, v1->positionMm),
                     d13 = minus(v3->positionMm, v1->positionMm);
        by02 = flatness(cross(d01, d02), cross(d02, d03)) >= flatness(cross(d01, d03), cross(d12, d13));
    }
    if (by02) {
        addTriangle(q[0], q[1], q[2]);
        addTriangle(q[0], q[2], q[3]);
    } else {
        addTriangle(q[0], q[1], q[3]);
        addTriangle(q[1], q[2], q[3]);
    }
}

}  // namespace handpiece::surface
