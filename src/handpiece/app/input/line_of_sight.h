// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Where a line of sight leads the bur: to what it meets there first, as it was before any cut, and how deep in.

#include <cstdint>
#include <optional>

#include "handpiece/app/input/hand_feel.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/senses/view/camera.h"

namespace handpiece::input {

/// A press goes no deeper, whatever gives way.
inline constexpr double kReachMm = 10.0;
/// A line of sight is followed to within this of what it meets.
inline constexpr double kNearMm = 1e-3;

/// How deep a stroke may go.
struct DepthLimits {
    std::optional<double> stopMm;     ///< below the uncut tooth
    std::optional<double> perPassMm;  ///< below the tooth as it was when the stroke began
};

/// In millimetres along the line of sight.
struct LineOfSight {
    view::Ray ray{core::Vec3::Zero(), -core::Vec3::UnitZ()};
    std::optional<double> hoverAt, touchAt;
    double passAt = 0.0;  ///< where the tooth of now begins; not before `touchAt`
    double endAt = 0.0;   ///< as deep as a press may go
    enum class End { through, atStop, passDone } end = End::through;  ///< what says so
    std::uint16_t what = 0;                                           ///< is touched, and whether it is a tooth
    bool isTooth = true;

    [[nodiscard]] core::Vec3 at(double mm) const { return ray.originMm + mm * ray.direction; }
};

/// The bur in one orientation, led along lines of sight.
class Leading {
  public:
    Leading(HandFeel& feel, const core::Quat& burInTooth) : feel_(feel), orientation_(burInTooth) {}

    [[nodiscard]] core::Pose poseAt(const core::Vec3& tipMm) const { return {tipMm, orientation_}; }
    [[nodiscard]] core::Vec3 axis() const { return orientation_ * core::Vec3::UnitZ(); }
    /// Of the whole bur; negative in tissue. At least.
    [[nodiscard]] double clearMm(const core::Vec3& tipMm) const { return feel_.ofBur(poseAt(tipMm)).mm; }
    /// Hovering and touching places, the former `hoverMm` off, within `farMm` of the eye.
    [[nodiscard]] LineOfSight alongRay(const view::Ray& ray, double hoverMm, double farMm) const;
    /// Says how deep a press may go that begins where `sight` touches.
    void findEnd(LineOfSight& sight, const DepthLimits& limits) const;
    /// How far along a direction the bur must go to be so far clear of the uncut tooth.
    [[nodiscard]] double wayOutMm(const core::Vec3& tipMm, const core::Vec3& direction, double offMm) const;

  private:
    [[nodiscard]] std::optional<double> meet(const LineOfSight& sight, double fromMm, double offMm, double farMm) const;
    [[nodiscard]] double stopEndMm(const LineOfSight& sight, double stopMm) const;
    [[nodiscard]] double deepestMm(const LineOfSight& sight) const;

    HandFeel& feel_;
    core::Quat orientation_;
};

}  // namespace handpiece::input
