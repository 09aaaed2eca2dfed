// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Depth from the distance field alone, as after a cut. Private to this room.

#include <vector>

#include "handpiece/model/instrument/bur.h"
#include "handpiece/tick/contact/exact_depth.h"
#include "handpiece/tick/contact/method.h"

namespace handpiece::contact {

/// Looks where the field is fine: along the axis, and over the tooth's surface from the places the bur's rings touch.
class FieldDepth {
  public:
    FieldDepth(const tooth::ToothField& field, const instrument::Bur& bur);

    /// Raises `best`; `touching` are constraints of the bur at this pose, nearest first.
    void search(const core::Pose& burInTooth, const ConstraintSet& touching, BallDepth& best) const noexcept;

  private:
    void searchAxis(const core::Pose& burInTooth, BallDepth& best) const noexcept;
    void climbSurface(const core::Pose& burInTooth, const core::Vec3& start, BallDepth& best) const noexcept;
    [[nodiscard]] bool projectToSurface(core::Vec3& q, core::Vec3& normal) const noexcept;
    [[nodiscard]] double radiusAt(double z) const noexcept;

    const tooth::ToothField& field_;
    const instrument::Bur& bur_;
    std::vector<instrument::MedialBall> axis_;  ///< at rising z
};

}  // namespace handpiece::contact
