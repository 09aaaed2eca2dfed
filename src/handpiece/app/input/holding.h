// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How the handpiece is held at a place: of the orientations near the student's own tilt, one at which shank, head and
/// handle are clear of teeth and gingiva and the bur works with its end.

#include <optional>

#include "handpiece/app/input/hand_feel.h"
#include "handpiece/app/input/line_of_sight.h"

namespace handpiece::input {

/// So clear shank, head and handle are held, and so much the bur's side above its end [judgements]; what is held
/// already stays held until it is nearer than the share.
inline constexpr double kBodyClearMm = 0.3, kSideClearMm = 0.3, kKeptShare = 0.4;

/// What is asked of an orientation.
struct HoldingRequest {
    core::Quat own;      ///< the student's tilt
    core::Quat held;     ///< as it is held now: kept while it does
    bool isOwn = false;  ///< the student has tilted it: the bur may work with its side
    double hoverMm = 0.0, farMm = 0.0;
};

/// For the place that a line of sight leads to; none within reach: nothing. Some dozens of exact looks at most, none
/// more than a few where what is held already does.
[[nodiscard]] std::optional<core::Quat> holdAt(HandFeel& feel, const view::Ray& ray, const HoldingRequest& request);

}  // namespace handpiece::input
