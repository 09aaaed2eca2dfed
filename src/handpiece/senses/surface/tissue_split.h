// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Makes a renderer's mesh of a list of triangles: each of one tissue, cut where tissues meet. Private to this room.

#include <memory>
#include <vector>

#include "handpiece/model/field/tissue_map.h"
#include "handpiece/senses/surface/triangle_list.h"

namespace handpiece::surface {

/// Kept and used again, for its memory. One thread.
class TissueSplitter {
  public:
    /// The mesh of `list`; null when it is empty. An edge is cut at the same point whoever asks.
    std::shared_ptr<const BrickMesh> mesh(const TriangleList& list, const LowNeighbours& bricks,
                                          const field::TissueMap* tissues);

  private:
    using Ref = TriangleList::Ref;
    struct Point {
        std::array<float, 3> positionMm, normal;
    };
    /// How a triangle's corners are lit: each by the surface that the triangle is of.
    struct Lit {
        std::array<std::array<float, 3>, 3> normal;
        std::array<std::uint8_t, 3> side;  ///< of a sharp vertex: which; kPlain: it has but one; kFlat: the triangle's
    };
    [[nodiscard]] static Lit lit(const std::array<const SheetVertex*, 3>& v);
    std::uint16_t corner(const SheetVertex& v, Ref ref, const std::array<float, 3>& normal, std::uint8_t side);
    std::uint16_t add(const Point& point, cases::Tissue tissue);
    [[nodiscard]] Point cut(const SheetVertex& a, const std::array<float, 3>& normalA, const SheetVertex& b,
                            const std::array<float, 3>& normalB, const field::TissueMap& tissues) const;
    void splitInTwo(const TriangleList& list, const std::array<Ref, 3>& t, const field::TissueMap& tissues);
    void splitInThree(const TriangleList& list, const std::array<Ref, 3>& t, const field::TissueMap& tissues);

    /// By vertex of the bricks, twice: its number in the mesh, for either side of a sharp one.
    std::vector<std::uint16_t> placed_;
    std::array<std::size_t, 9> first_{};
    BrickMesh mesh_;
};

}  // namespace handpiece::surface
