// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The built-in motions placed on a tooth: found by feeling for its surface from above.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/tick/contact/method.h"
#include "handpiece/tick/device/motion.h"

namespace handpiece::studies {

/// Where the bur first touches when moved from `start` along `direction` for at most `rangeMm`; nothing when it does
/// not. Steps by the clearance that the method proves, to within 0.1 um. Not from the tick while it uses the same
/// method.
[[nodiscard]] std::optional<core::Pose> firstTouch(contact::Method& method, const core::Pose& start,
                                                   const core::Vec3& direction, double rangeMm);

/// The lowest point of a straight drop: how far (mm) the bur at `start` can move along `direction` until it touches.
/// Throws core::Error when it meets nothing within `reachMm`.
[[nodiscard]] double distanceToTouch(contact::Method& method, const core::Pose& start, const core::Vec3& direction,
                                     double reachMm);

struct MotionOptions {
    double depthMm = 4.0;  ///< how far beyond the surface the hand intends to go
    double speedMmS = 10.0;
    double dwellS = 0.5;
    double clearanceMm = 1.0;  ///< above the surface at the start
    double lengthMm = 0.0;     ///< of a slide or drag; 0: 60 % of the tooth's width
    double loopRadiusMm = 0.15;
    core::Vec2 offsetMm = core::Vec2::Zero();  ///< of the first touch from the middle of the tooth, (x, y)
};

struct BuiltInMotion {
    std::string_view name;  ///< "drop", "press", "slide", "drag", "loop", "hold"
    std::string_view description;
};
[[nodiscard]] const std::vector<BuiltInMotion>& builtInMotions();

/// The named motion on the tooth in `toothBounds`, the bur's shank up (+z). Slide and drag go along x. Throws
/// core::Error for a name there is not, options out of range, or a place where the bur meets no tooth.
[[nodiscard]] device::Motion motionByName(std::string_view name, contact::Method& method, const core::Box& toothBounds,
                                          const MotionOptions& options = {});

}  // namespace handpiece::studies
