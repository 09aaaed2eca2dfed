// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Joins the vertices of cells to triangles, a brick at a time. Private to this room.

#include <array>
#include <cstdint>
#include <vector>

#include "handpiece/senses/surface/brick_state.h"
#include "handpiece/senses/surface/cell_cases.h"

namespace handpiece::surface {

/// A brick and its neighbours at the low side. Bit k of a slot: one brick down along axis k. Slot 0 is the brick.
using LowNeighbours = std::array<const BrickState*, 8>;
[[nodiscard]] LowNeighbours lowNeighbours(const BrickGrid& grid, const std::vector<std::unique_ptr<BrickState>>& bricks,
                                          std::uint32_t dense);

/// The triangles of the edges that one brick owns (those that begin at its nodes 0..7). Kept and filled again.
class TriangleList {
  public:
    /// A vertex: its slot and number there, or kExtra and its number in extras().
    using Ref = std::uint32_t;
    static constexpr Ref kExtra = 8u << 16;

    /// A vertex between cells, where two edges of the dual surface would fall together.
    struct Extra {
        SheetVertex vertex;
        std::uint64_t key;  ///< the same in every brick that has it, and no other's
    };

    /// `fine`: at full detail, whatever the levels.
    void fill(const BrickGrid& grid, std::uint32_t dense, const LowNeighbours& bricks, bool fine);

    [[nodiscard]] const std::vector<std::array<Ref, 3>>& triangles() const { return triangles_; }
    [[nodiscard]] std::vector<Extra>& extras() { return extras_; }
    [[nodiscard]] const SheetVertex& vertex(Ref ref) const {
        if ((ref & kExtra) != 0) return extras_[ref & 0xffff].vertex;
        return vertices_[ref >> 16][ref & 0xffff];
    }
    /// Bit s: a triangle has a vertex of slot s.
    [[nodiscard]] std::uint8_t uses() const { return uses_; }

  private:
    struct Corner {
        const BrickState* brick;
        std::uint32_t slot;
        std::uint16_t cell;
        std::uint8_t edge;  ///< of the cell
        Ref ref;
    };
    [[nodiscard]] bool isPlainCase(unsigned bits) const { return bits < 256 && (*plain_)[bits]; }
    [[nodiscard]] bool addPlainEdge(const std::array<int, 3>& node, int axis, bool rising);
    void addEdge(const std::array<int, 3>& node, int axis, bool rising);
    [[nodiscard]] Corner corner(const std::array<int, 3>& node, int axis, int du, int dw);
    [[nodiscard]] bool fallsTogether(const Corner& from, const Corner& to, unsigned flip) const;
    /// `low`: the pair of crossings turns about the node where the edge begins.
    [[nodiscard]] Ref addExtra(const std::array<int, 3>& node, int axis, int across, int direction, bool low,
                               const Corner& from, const Corner& to);
    void addTriangle(Ref a, Ref b, Ref c);
    void addQuad(const std::array<Ref, 4>& q);

    const std::array<CellCase, kCellCases>* cases_ = &cellCases();
    const std::array<bool, 256>* plain_ = &plainCases();
    const BrickGrid* grid_ = nullptr;
    std::array<std::int32_t, 3> brick_{};
    const LowNeighbours* bricks_ = nullptr;
    bool fine_ = false;
    std::array<const SheetVertex*, 8> vertices_{};
    std::vector<std::array<Ref, 3>> triangles_;
    std::vector<Extra> extras_;
    std::uint8_t uses_ = 0;
};

}  // namespace handpiece::surface
