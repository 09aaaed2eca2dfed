// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Where on a tooth something begins, and which way it goes in. Private to this room.

#include <optional>
#include <vector>

#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/lesion/lesion.h"

namespace handpiece::lesion {

/// Numbers from a seed that do not depend on a library's distributions.
class Dice {
  public:
    explicit Dice(std::uint64_t seed) : state_(seed) {}
    [[nodiscard]] double between(double low, double high);

  private:
    std::uint64_t state_;
};

/// A tooth's surfaces, to be asked for distances.
class Surfaces {
  public:
    /// Throws core::Error for a tooth without outer surface, enamel, dentine or pulp.
    explicit Surfaces(const cases::Tooth& tooth);

    [[nodiscard]] double outer(const core::Vec3& p) const { return outer_->signedDistance(p); }
    [[nodiscard]] double dentine(const core::Vec3& p) const { return dentine_->signedDistance(p); }
    [[nodiscard]] double pulp(const core::Vec3& p) const { return pulp_->signedDistance(p); }
    /// The outer surface where a ray from `from` meets it first.
    [[nodiscard]] std::optional<core::Vec3> meeting(const core::Vec3& from, const core::Vec3& along) const;
    /// Where the crown's enamel ends on the side that `out` (horizontal) points to.
    [[nodiscard]] double cervixMm(const core::Vec3& out) const;
    [[nodiscard]] const core::Box& crown() const { return crown_; }
    /// 1 for a molar's crown, less for narrower ones.
    [[nodiscard]] double scale() const;

  private:
    const cases::Tooth& tooth_;
    const geometry::TriangleMesh* enamel_ = nullptr;
    std::optional<geometry::TriangleTree> outer_, dentine_, pulp_;
    core::Box crown_;
};

/// Lines along which something goes in, from outside the tooth to its pulp: one, or neighbouring ones along a fissure.
using Ways = std::vector<std::vector<core::Vec3>>;

/// Of caries and fillings. A way leads on as tubules do: to the nearest dentine, then on to the pulp.
[[nodiscard]] Ways waysIn(const Surfaces& surfaces, const cases::Tooth& tooth, const Lesion& lesion, Dice& dice);
/// Where those begin on the surface: a point, or a stretch of a fissure up to `lengthMm` long.
[[nodiscard]] std::vector<core::Vec3> entries(const Surfaces& surfaces, const cases::Tooth& tooth, Surface surface,
                                              double lengthMm, Dice& dice);
/// Out of the tooth, horizontal; up for the occlusal surface.
[[nodiscard]] core::Vec3 outwards(const cases::Tooth& tooth, Surface surface);

/// Distance to the nearest of some lines.
[[nodiscard]] double distanceMm(const Ways& ways, const core::Vec3& p);

}  // namespace handpiece::lesion
