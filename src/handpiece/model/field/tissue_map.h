// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Which tissue lies where, all through the tooth, with boundaries smooth to below a voxel.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/model/field/brick_tissues.h"

namespace handpiece::field {

struct LayeredBrick;
struct PartSurface;
class DistanceField;

/// On the grid of a field: a brick is of one tissue, or has a tissue for every node and the signed distances of the
/// parts whose surfaces pass through it (8 bits, a fraction of a voxel), from which the boundary is found between
/// nodes. Immutable once made; any thread.
class TissueMap {
  public:
    TissueMap() = default;
    TissueMap(TissueMap&&) noexcept = default;
    TissueMap& operator=(TissueMap&&) noexcept = default;
    TissueMap(const TissueMap&) = delete;  // large, and its layers point into it
    TissueMap& operator=(const TissueMap&) = delete;
    ~TissueMap() = default;
    /// From the parts of a case. In parallel, same bits at any thread count.
    [[nodiscard]] static TissueMap fromParts(const DistanceField& grid, std::span<const PartSurface> parts,
                                             const core::Progress& progress = {});
    /// All of one tissue.
    [[nodiscard]] static TissueMap uniform(const DistanceField& grid, cases::Tissue tissue);
    /// A part as a function, for closed forms and phantoms: signed distance, negative inside.
    struct PartFunction {
        std::function<double(const core::Vec3&)> signedDistance;
        cases::Tissue tissue;
        int priority;
    };
    /// `rest` is what lies in no part.
    [[nodiscard]] static TissueMap fromFunctions(const DistanceField& grid, std::span<const PartFunction> parts,
                                                 cases::Tissue rest);

    /// At a point, by interpolated distances.
    [[nodiscard]] cases::Tissue at(const core::Vec3& p) const noexcept;
    /// Tissue of the whole brick, or none when it is mixed.
    [[nodiscard]] cases::Tissue ofBrick(std::uint32_t dense) const noexcept {
        return nodes_->isMixed(dense) ? cases::Tissue::none : static_cast<cases::Tissue>(*nodes_->of(dense));
    }
    /// Of every node: what a field of the same bricks is to hold as well.
    [[nodiscard]] const std::shared_ptr<const BrickTissues>& nodes() const noexcept { return nodes_; }

    /// A part's surface in a mixed brick: signed distance = unit x value, negative inside, at the nodes.
    struct Layer {
        cases::Tissue tissue;  ///< inside
        const std::int8_t* values;
    };
    /// The layers of a mixed brick, the one that wins first; where none contains the point it is of `rest`.
    struct Layers {
        std::span<const Layer> layers;
        cases::Tissue rest;
    };
    [[nodiscard]] Layers layers(std::uint32_t dense) const noexcept;
    [[nodiscard]] double unitMm() const noexcept { return unitMm_; }
    /// True when it was made on a grid of the same bricks.
    [[nodiscard]] bool isOn(const DistanceField& grid) const noexcept;
    [[nodiscard]] std::vector<cases::Tissue> tissues() const { return nodes_->tissues(); }

    /// Layers hold distances in this fraction of a voxel.
    static constexpr int kUnitsAVoxel = 32;

  private:
    friend class TissueStorage;
    explicit TissueMap(const DistanceField& grid);
    /// Lays the bricks, by dense index, one after the other.
    void assemble(std::vector<LayeredBrick> bricks);

    core::Vec3 originMm_ = core::Vec3::Zero();
    double voxelMm_ = 0.0, unitMm_ = 0.0;
    std::int32_t bricks_[3] = {0, 0, 0};
    std::shared_ptr<const BrickTissues> nodes_;
    struct LayerRange {
        std::uint32_t first, count;
        cases::Tissue rest;
    };
    std::vector<LayerRange> ranges_;  ///< by mixed brick, as their nodes lie
    std::vector<Layer> layers_;
    std::vector<std::int8_t> values_;
};

}  // namespace handpiece::field
