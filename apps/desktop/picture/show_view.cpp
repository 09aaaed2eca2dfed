// SPDX-License-Identifier: Apache-2.0
#include "desktop/picture/show_view.h"

namespace handpiece::desktop {
namespace {

/// So near, a millimetre is some forty pixels of a school's screen.
constexpr double kEyeMm = 20.0;
/// Shares of the directions that are mixed: from where one worked, along the path of draw, and against the side on
/// which the place lies.
constexpr double kDraw = 0.6, kAside = 0.5;
/// Nearer to the eye's own line than this, the old upward direction says nothing.
constexpr double kLeastUp = 0.05;

}  // namespace

view::Camera lookingAtPlace(const core::Vec3& placeMm, const core::Vec3& draw, const core::Vec3& middleMm,
                            const view::Camera& worked) {
    core::Vec3 aside = placeMm - middleMm;
    aside -= aside.dot(draw) * draw;
    if (aside.norm() > 1e-6) aside.normalize();
    const core::Vec3 towards = (kDraw * draw - worked.forward() - kAside * aside).normalized();
    view::Camera eye = worked;
    eye.targetMm = placeMm;
    eye.eyeMm = placeMm + kEyeMm * towards;
    // What was up stays up: the old picture's upward direction, laid square to the new line of sight.
    const core::Vec3 was = worked.up - worked.up.dot(worked.forward()) * worked.forward();
    const core::Vec3 up = was - was.dot(towards) * towards;
    eye.up = up.norm() > kLeastUp ? up.normalized() : draw.unitOrthogonal();
    return eye;
}

}  // namespace handpiece::desktop
