// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Which tissue lies where, all through the tooth, with boundaries smooth to below a voxel.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/model/case/tissue.h"
#include "handpiece/model/field/field_view.h"

namespace handpiece::field {

struct BrickTissues;
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
        return mixed_[dense] < 0 ? static_cast<cases::Tissue>(uniform_[dense]) : cases::Tissue::none;
    }
    /// Tissue of each node of a mixed brick (index x + 9 y + 81 z); null for a uniform one.
    [[nodiscard]] const std::uint8_t* nodes(std::uint32_t dense) const noexcept;

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
    /// Tissues that occur anywhere.
    [[nodiscard]] std::vector<cases::Tissue> tissues() const;

    /// Layers hold distances in this fraction of a voxel.
    static constexpr int kUnitsAVoxel = 32;

  private:
    friend class TissueStorage;
    explicit TissueMap(const DistanceField& grid);
    /// Lays the bricks, by dense index, one after the other.
    void assemble(std::vector<BrickTissues> bricks);

    core::Vec3 originMm_ = core::Vec3::Zero();
    double voxelMm_ = 0.0, unitMm_ = 0.0;
    std::int32_t bricks_[3] = {0, 0, 0};
    std::vector<std::uint8_t> uniform_;  ///< by dense brick
    std::vector<std::int32_t> mixed_;    ///< by dense brick: index into the mixed ones, or -1
    std::vector<std::uint8_t> nodes_;    ///< kBrickValues a mixed brick
    struct LayerRange {
        std::uint32_t first, count;
        cases::Tissue rest;
    };
    std::vector<LayerRange> ranges_;  ///< by mixed brick
    std::vector<Layer> layers_;
    std::vector<std::int8_t> values_;
};

}  // namespace handpiece::field
