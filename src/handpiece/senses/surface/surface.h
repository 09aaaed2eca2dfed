// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The surface of a tooth as triangles, brick by brick, kept up while the tooth is cut.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/model/field/tissue_map.h"
#include "handpiece/senses/surface/brick_mesh.h"
#include "handpiece/senses/surface/brick_source.h"

namespace handpiece::surface {

struct BrickState;
struct SheetVertex;

inline constexpr int kMaxLevel = 2;

/// Dual contouring of the zero surface: a vertex for each sheet of surface in each cell, at the point that lies best on
/// the planes of its crossings, so that edges stay sharp.
///
/// Planes are taken on their own side of an edge of the solid. Where several sheets pass through a cell each has its
/// vertex, so the whole is closed and two-manifold at full detail. A vertex stays in its cell, save that one on an edge
/// of the solid may stand half a voxel out, short of the crossings of the cells beside it; the surface can still fold
/// over itself there by a fraction of a voxel (closedSurface() mends that). Bricks of less detail have one vertex for
/// all in a block of cells, and their neighbours use it too: no crack opens, though sheets nearer than the block grow
/// together. Off the tick; one thread at a time; results do not depend on the thread count.
class Surface {
  public:
    /// Keeps references to both. Without tissues all is Tissue::none.
    explicit Surface(const BrickSource& source, const field::TissueMap* tissues = nullptr);
    ~Surface();
    Surface(const Surface&) = delete;
    Surface& operator=(const Surface&) = delete;

    /// Everything, in parallel.
    void build(const core::Progress& progress = {});
    /// Takes up the new values of the bricks `touched`, and levels that were set; says whose meshes are others now,
    /// rising. The same meshes as build() gives.
    std::vector<std::uint32_t> update(std::span<const std::uint32_t> touched);
    /// Detail of a brick, 0..kMaxLevel; shows after the next update(). Throws core::Error for another level.
    void setLevel(std::uint32_t dense, int level);
    [[nodiscard]] int level(std::uint32_t dense) const { return levels_[dense]; }

    /// Null where there are no triangles. What was given stays as it was for as long as it is held, on any thread.
    [[nodiscard]] std::shared_ptr<const BrickMesh> mesh(std::uint32_t dense) const;
    /// All there are, by rising brick.
    [[nodiscard]] std::vector<std::shared_ptr<const BrickMesh>> meshes() const;
    [[nodiscard]] const BrickGrid& grid() const { return source_.grid(); }

    /// The whole at full detail as one mesh with shared vertices: closed, oriented and two-manifold when the surface
    /// does not leave the grid.
    [[nodiscard]] geometry::TriangleMesh closedMesh() const;
    /// The triangles of one tissue as shown now, vertices at the same place joined: open where tissues meet.
    [[nodiscard]] geometry::TriangleMesh tissueMesh(cases::Tissue tissue) const;

  private:
    friend geometry::TriangleMesh closedSurface(const BrickSource& source, const core::Progress& progress);
    void buildUpTo(std::size_t rounds, const core::Progress& progress);
    /// Who sees that the brick's contour is another now (see whoSees()). `dirty`: cells that may have changed.
    std::uint8_t contour(std::uint32_t dense, const std::array<std::uint8_t, 64>* dirty);
    struct Change;
    [[nodiscard]] Change changeOf(std::uint32_t dense);
    void coarsen(BrickState& brick, std::uint32_t dense) const;
    void label(std::uint32_t dense, std::span<SheetVertex> vertices) const;
    [[nodiscard]] std::shared_ptr<const BrickMesh> makeMesh(std::uint32_t dense);

    const BrickSource& source_;
    const field::TissueMap* tissues_;
    std::vector<std::unique_ptr<BrickState>> bricks_;  ///< by dense brick; null: no surface
    std::vector<std::uint8_t> levels_;                 ///< by dense brick, as set
    std::vector<std::uint32_t> levelsSet_;             ///< since the last update
    std::vector<std::uint8_t> marks_;                  ///< by dense brick: scratch of update()
    std::vector<std::uint32_t> changeAt_;              ///< by dense brick: scratch of update()
    /// By dense brick: values as they were when it was touched last; null: as never.
    std::vector<std::unique_ptr<std::array<float, field::kBrickValues>>> seen_;
};

}  // namespace handpiece::surface
