// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The tooth as a sparse field of signed distances: bricks of 8^3 cells near the surface, one coarse value a brick
/// elsewhere.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/model/field/brick_tissues.h"

namespace handpiece::field {

struct FieldSettings {
    double voxelMm = 0.05;
    double bandOutMm = 0.15;  ///< every point this near outside the surface lies in a brick
    double bandInMm = 0.3;    ///< the same inside
};

/// How far from the surface values are distances.
struct FieldReach {
    double outMm, inMm;
};

/// What a field consists of.
struct FieldStorage {
    FieldSettings settings;
    core::Vec3 originMm = core::Vec3::Zero();
    std::int32_t bricks[3] = {0, 0, 0};
    std::vector<std::int32_t> brickIndex;  ///< this and the rest: as FieldView tells
    std::vector<float> values, coarse;
    std::shared_ptr<const BrickTissues> tissues;
    std::optional<FieldReach> heldTo;  ///< values beyond these only say "at least"; none: all are distances
    std::uint64_t version = 1;         ///< another number after every change

    [[nodiscard]] std::size_t brickCount() const noexcept { return values.size() / kBrickValues; }
};

/// Readers on any thread while its owner leaves it alone; no locks, no allocation.
class DistanceField {
  public:
    explicit DistanceField(FieldStorage storage) : s_(std::move(storage)) {}
    [[nodiscard]] const FieldStorage& storage() const noexcept { return s_; }
    /// For its owner, who made it or cuts it: everybody else has it const.
    [[nodiscard]] FieldStorage& storage() noexcept { return s_; }

    /// Signed distance [mm]: trilinear where a brick is stored; elsewhere the sign is right and the magnitude is a
    /// lower bound of the distance to the surface. Outside the grid: at least the distance to the grid's box.
    [[nodiscard]] double distance(const core::Vec3& p) const noexcept;
    /// True when `p` lies in a stored brick (distance() is then accurate).
    [[nodiscard]] bool isFine(const core::Vec3& p) const noexcept;
    /// Unit gradient of the field (out of the tooth): gradient of the trilinear field, continuous enough for a normal.
    /// Zero where no brick is stored.
    [[nodiscard]] core::Vec3 normal(const core::Vec3& p) const noexcept;
    /// What lies at `p`; in a stored brick that of the nearest node, and outside the surface what one would touch
    /// there. none elsewhere outside.
    [[nodiscard]] cases::Tissue tissueAt(const core::Vec3& p) const noexcept;

    [[nodiscard]] FieldView view() const noexcept;
    [[nodiscard]] const FieldSettings& settings() const noexcept { return s_.settings; }
    [[nodiscard]] FieldReach reach() const noexcept {
        return s_.heldTo.value_or(FieldReach{s_.settings.bandOutMm, s_.settings.bandInMm});
    }
    /// What was looked up at the same one still holds.
    [[nodiscard]] std::uint64_t version() const noexcept { return s_.version; }
    [[nodiscard]] core::Box bounds() const noexcept;
    [[nodiscard]] std::size_t brickCount() const noexcept { return s_.brickCount(); }
    [[nodiscard]] std::size_t memoryBytes() const noexcept;
    /// Volume [mm3] of the inside and area [mm2] of the zero surface, by integrating the cells. For checks.
    [[nodiscard]] double volumeMm3() const;
    [[nodiscard]] double areaMm2() const;
    /// Both in one pass.
    struct Extent {
        double volumeMm3, areaMm2;
    };
    [[nodiscard]] Extent extent() const;
    /// Hash of every stored value; the same at any thread count.
    [[nodiscard]] std::uint64_t stateHash() const;

    /// A field sampled from a function (closed forms in tests, phantoms). `signedDistance` must be 1-Lipschitz.
    [[nodiscard]] static DistanceField fromFunction(const core::Box& box, const FieldSettings& settings,
                                                    const std::function<double(const core::Vec3&)>& signedDistance,
                                                    const std::function<cases::Tissue(const core::Vec3&)>& tissue = {},
                                                    const core::Progress& progress = {});

  private:
    [[nodiscard]] double distanceInGrid(const core::Vec3& gridPoint) const noexcept;  // in voxels from the origin
    FieldStorage s_;
};

}  // namespace handpiece::field
