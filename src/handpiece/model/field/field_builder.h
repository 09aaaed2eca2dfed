// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Fills a DistanceField: lays out the grid, stores the bricks the band passes through, and computes their nodes.

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/field/distance_field.h"

namespace handpiece::field {

/// A closed surface inside the tooth and the tissue it bounds, as the builder sees it.
struct PartSurface {
    const geometry::TriangleTree* tree = nullptr;
    cases::Tissue tissue = cases::Tissue::enamel;
    int priority = 0;  ///< where parts overlap the higher wins; of equals, the later one
};

/// Steps of making a field, in order: layOut, one coarse value a brick, store, node values. Off the tick.
class FieldBuilder {
  public:
    /// The field of a closed, outward-facing surface: node values exact to float from its triangles, tissues from
    /// `parts` (none: all enamel). Runs on all threads; the same bits at any number of them and at every SIMD level.
    /// Throws core::Error when the finished field disagrees with the surface's volume or area by more than 1 %.
    /// `nearest`, where wanted: for fromNearest().
    [[nodiscard]] static DistanceField fromSurface(const geometry::TriangleMesh& mesh,
                                                   const geometry::TriangleTree& tree,
                                                   std::span<const PartSurface> parts, const FieldSettings& settings,
                                                   const core::Progress& progress = {},
                                                   std::vector<std::uint32_t>* nearest = nullptr);
    /// The same from what fromSurface() wrote into `nearest`, without a search: of every node of a stored brick the
    /// triangle that its distance is of, geometry::kNoTriangle where the node is another brick's. `coarse` are the
    /// distances at the bricks' centres; tissues are none. Nothing where it does not fit the grid or the surface.
    [[nodiscard]] static std::optional<FieldStorage> fromNearest(const geometry::TriangleTree& tree,
                                                                 const FieldSettings& settings,
                                                                 std::vector<float> coarse,
                                                                 std::span<const std::uint32_t> nearest);

    /// The empty grid that fromSurface() fills, for a surface of these bounds. Throws as the constructor.
    [[nodiscard]] static FieldBuilder around(const core::Box& surface, const FieldSettings& settings);

    /// An empty grid of bricks over `box`. Throws core::Error for settings that make no grid, or one too large.
    FieldBuilder(const core::Box& box, const FieldSettings& settings);

    [[nodiscard]] std::size_t denseBricks() const { return field_.coarse.size(); }
    [[nodiscard]] std::int32_t bricksAlongX() const { return field_.bricks[0]; }
    [[nodiscard]] double brickMm() const { return kBrickCells * field_.settings.voxelMm; }
    [[nodiscard]] double halfDiagonalMm() const { return 0.5 * std::sqrt(3.0) * brickMm(); }
    /// Where node (x, y, z) of the whole grid lies [mm]: the same bits whichever brick asks.
    [[nodiscard]] core::Vec3 nodeMm(std::int64_t x, std::int64_t y, std::int64_t z) const;
    [[nodiscard]] std::array<std::int32_t, 3> brickAt(std::size_t dense) const;
    [[nodiscard]] core::Vec3 centreMm(std::size_t dense) const;
    /// Storage index of the brick at these coordinates; -1 where none is stored or the grid has ended.
    [[nodiscard]] std::int32_t storedAt(const std::array<std::int32_t, 3>& brick) const;

    /// True when the band may pass through a brick whose centre lies this far from the surface.
    [[nodiscard]] bool isStored(float centreDistanceMm) const;
    /// Calls centreDistance for every brick and notes which of them the band may pass through.
    void classify(const std::function<double(std::size_t dense)>& centreDistance);
    /// Numbers the noted bricks and makes room for their nodes. Throws core::Error when they are too many.
    void store();
    /// Dense index of every stored brick, in storage order.
    [[nodiscard]] const std::vector<std::uint32_t>& storedBricks() const { return stored_; }

    [[nodiscard]] float* values(std::size_t storedBrick) { return &field_.values[storedBrick * kBrickValues]; }
    [[nodiscard]] std::uint8_t* tissues(std::size_t storedBrick) { return &tissues_[storedBrick * kBrickValues]; }
    [[nodiscard]] float coarse(std::size_t dense) const { return field_.coarse[dense]; }
    void setCoarseTissue(std::size_t dense, cases::Tissue tissue) {
        coarseTissues_[dense] = static_cast<std::uint8_t>(tissue);
    }
    [[nodiscard]] const FieldSettings& settings() const { return field_.settings; }
    [[nodiscard]] DistanceField finish() &&;

  private:
    FieldStorage field_;
    std::vector<std::uint32_t> stored_;
    std::vector<std::uint8_t> tissues_, coarseTissues_;  ///< by stored and by dense brick
};

}  // namespace handpiece::field
