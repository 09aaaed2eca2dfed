// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a dentist measures on a tooth that is being cut: where a line of sight meets it, how deep a floor lies, how
/// much dentine is left over the pulp, what a section shows. Off the tick; reads a mirror.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/model/tooth/tooth_mirror.h"

namespace handpiece::measure {

/// A point of the surface as it is now.
struct Hit {
    core::Vec3 pointMm = core::Vec3::Zero();
    core::Vec3 normal = core::Vec3::UnitZ();  ///< unit, out of the tooth
    cases::Tissue tissue = cases::Tissue::none;
    double distanceMm = 0.0;  ///< along the ray
    bool cut = false;         ///< farther than a voxel inside the uncut surface
};

/// Section of a tooth by a plane: tissue by pixel.
struct Section {
    core::Vec3 originMm, uAxis, vAxis;  ///< middle of pixel (0, 0); unit axes; uAxis x vAxis is the plane's normal
    double mmPerPixel = 0.05;
    int width = 0, height = 0;
    std::vector<std::uint8_t> tissue;  ///< cases::Tissue by pixel, row by row along u; none where there is no tooth
    /// By pixel, in 32nds of one, up to where a byte ends: how far it lies from what is of another tissue, and from the
    /// tooth's surface. They tell where between two pixels a boundary runs.
    std::vector<std::array<std::uint8_t, 2>> away;
};

/// The tooth as `mirror` has it. One thread, the one that feeds the mirror.
class ToothProbe {
  public:
    explicit ToothProbe(const tooth::ToothMirror& mirror);
    ~ToothProbe();
    ToothProbe(const ToothProbe&) = delete;
    ToothProbe& operator=(const ToothProbe&) = delete;

    /// Signed distance to the surface as it is now [mm], negative inside; beyond the field's band a bound of the same
    /// sign. Trilinear in the nodes.
    [[nodiscard]] double signedDistanceMm(const core::Vec3& pointMm) const;
    /// Of the tooth at a point, none outside it or where it was cut away.
    [[nodiscard]] cases::Tissue tissueAt(const core::Vec3& pointMm) const;
    /// First meeting of a ray with the surface as it is now, from either side, to within a hundredth of a voxel of the
    /// field. `direction` unit.
    [[nodiscard]] std::optional<Hit> cast(const core::Vec3& originMm, const core::Vec3& direction,
                                          double farMm = 400.0) const;
    /// The same with the surface before any cut, exact on its triangles.
    [[nodiscard]] std::optional<Hit> castUncut(const core::Vec3& originMm, const core::Vec3& direction,
                                               double farMm = 400.0) const;
    /// How far a point lies under the uncut surface [mm], nearest; exact; negative outside.
    [[nodiscard]] double depthBelowUncutMm(const core::Vec3& pointMm) const;
    /// The same along an axis: from the point along `towards` (unit) to the uncut surface; what a depth gauge reads. 0
    /// for a point that is not under it.
    [[nodiscard]] std::optional<double> depthAlongMm(const core::Vec3& pointMm, const core::Vec3& towards) const;
    /// The least way from a point to the pulp [mm], through whatever lies between, 0 inside it; none when the tooth has
    /// no pulp. To within half a voxel.
    [[nodiscard]] std::optional<double> leftOverPulpMm(const core::Vec3& pointMm) const;
    /// The thinnest place over the pulp among points of the surface that were cut: where and how much.
    struct Thinnest {
        core::Vec3 pointMm;
        double leftMm;
    };
    [[nodiscard]] std::optional<Thinnest> thinnestOverPulp() const;

    /// Tooth in the plane normal . p = offset, `mmPerPixel` fine, as large as the tooth's box needs. Rows run upwards
    /// (occlusal; y in a horizontal plane). In parallel. Throws core::Error for what is no plane or no size.
    [[nodiscard]] Section section(const core::Vec3& normal, double offsetMm, double mmPerPixel = 0.05) const;
    /// Depth under the uncut surface for each vertex of a mesh [mm], 0 above it and within a quarter of a voxel of it:
    /// Look::removedDepthColours.
    [[nodiscard]] std::vector<float> removedDepths(const std::vector<std::array<float, 3>>& verticesMm) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace handpiece::measure
