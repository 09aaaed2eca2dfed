// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Points, normals and areas along one piece of an outline. The parameter t runs from 0 at `from` to 1 at `to`.

#include "handpiece/model/instrument/profile.h"

namespace handpiece::instrument {

/// Angle at the arc's `from` seen from its centre [rad].
[[nodiscard]] double arcStartRad(const ProfilePiece& arc);
/// Signed angle walked from `from` to `to`: positive (counter-clockwise) on a convex arc, negative on a concave one
/// [rad].
[[nodiscard]] double arcSweepRad(const ProfilePiece& arc);

[[nodiscard]] double lengthMm(const ProfilePiece& piece);
/// The point at t; the ends are exactly `from` and `to`.
[[nodiscard]] core::Vec2 pointAt(const ProfilePiece& piece, double t);
/// Unit normal at t into the bur.
[[nodiscard]] core::Vec2 inwardNormalAt(const ProfilePiece& piece, double t);
/// Area swept by turning the part t0..t1 about the axis [mm2], closed form.
[[nodiscard]] double turnedAreaMm2(const ProfilePiece& piece, double t0, double t1);

/// How two pieces meet, judged by the angle between their tangents.
enum class Joint { smooth, convex, reflex };
[[nodiscard]] Joint jointBetween(const ProfilePiece& before, const ProfilePiece& after);
/// Turns below this count as smooth: the ball over such a corner sticks out by R angle^2 / 2, under 1e-8 mm.
inline constexpr double kSmoothJointRad = 1e-4;

/// The foot c + R v / |v| of a direction v from an arc's centre lies on the arc.
[[nodiscard]] inline bool isOnArc(const ProfilePiece& arc, const core::Vec2& foot) noexcept {
    const core::Vec2 chord = arc.to - arc.from, w = foot - arc.from;
    const double side = chord.x() * w.y() - chord.y() * w.x();  // a convex arc bulges to the right of its chord
    return arc.convex ? side <= 0.0 : side >= 0.0;
}

}  // namespace handpiece::instrument
