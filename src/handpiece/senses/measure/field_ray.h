// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A mirror's field, looked up at points and along rays. Private to this room.

#include <optional>

#include "handpiece/base/core/vec.h"
#include "handpiece/model/tooth/tooth_mirror.h"

namespace handpiece::measure {

/// Signed distances of the tooth as it is now. Keeps a reference. Reading is const and may happen on several threads
/// while nobody feeds the mirror.
class FieldRay {
  public:
    explicit FieldRay(const tooth::ToothMirror& mirror);

    /// Nodes of a brick; null where none are held: all of it lies deep inside or far outside.
    [[nodiscard]] const float* nodes(std::uint32_t dense) const;
    /// True for a brick without nodes that lies in the tooth.
    [[nodiscard]] bool isDeep(std::uint32_t dense) const { return view_.coarse[dense] < 0.0f; }
    /// Negative inside; trilinear near the surface, else a bound of the same sign [mm].
    [[nodiscard]] double signedDistanceMm(const core::Vec3& p) const;
    /// Unit, out of the tooth, at a point of the surface; zero where the field is even.
    [[nodiscard]] core::Vec3 normal(const core::Vec3& p) const;
    /// Where the trilinear field first changes its sign along a ray [mm].
    [[nodiscard]] std::optional<double> firstZeroMm(const core::Vec3& originMm, const core::Vec3& direction,
                                                    double farMm) const;
    [[nodiscard]] const field::FieldView& view() const { return view_; }

  private:
    struct Place {
        std::uint32_t dense;
        int cell[3];
        double fraction[3];
    };
    [[nodiscard]] bool isInGrid(const core::Vec3& u) const;
    [[nodiscard]] Place placeOf(const core::Vec3& u) const;
    [[nodiscard]] std::optional<double> valueAt(const core::Vec3& u) const;

    const tooth::ToothMirror& mirror_;
    const field::DistanceField& uncut_;
    field::FieldView view_;
    core::Vec3 originMm_;
    double bandMm_;  ///< how deep under the surface values are distances
};

}  // namespace handpiece::measure
