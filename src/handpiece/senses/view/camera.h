// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Where one looks from, and how the hand moves it. Tooth frame, millimetres; pixels count from the top left.

#include <optional>
#include <string_view>
#include <vector>

#include "handpiece/base/core/vec.h"

namespace handpiece::view {

/// A perspective eye. Immutable arithmetic; the functions below give new ones.
struct Camera {
    core::Vec3 eyeMm{0, -60, 40}, targetMm = core::Vec3::Zero();
    core::Vec3 up = core::Vec3::UnitZ();  ///< unit; made perpendicular to the line of sight where it is used
    double fieldOfViewRad = 0.42;         ///< of the picture's height
    bool mirrored = false;                ///< what is seen is a mirror's picture: left and right have changed places

    [[nodiscard]] core::Vec3 forward() const { return (targetMm - eyeMm).normalized(); }
    /// In the picture.
    [[nodiscard]] core::Vec3 right() const {
        const core::Vec3 plain = forward().cross(up).normalized();
        return mirrored ? core::Vec3(-plain) : plain;
    }
    [[nodiscard]] core::Vec3 upward() const { return (forward().cross(up).normalized()).cross(forward()); }
    [[nodiscard]] double distanceMm() const { return (targetMm - eyeMm).norm(); }
};
struct Viewport {
    int width = 1, height = 1;  ///< pixels
};
struct Ray {
    core::Vec3 originMm, direction;  ///< unit
};

/// The line of sight through a pixel. (0, 0) is the picture's corner, (0.5, 0.5) the middle of its first pixel.
[[nodiscard]] Ray rayThrough(const Camera& camera, const Viewport& viewport, const core::Vec2& pixel);
/// The pixel a point appears at; nothing for points beside or behind the eye.
[[nodiscard]] std::optional<core::Vec2> pixelOf(const Camera& camera, const Viewport& viewport,
                                                const core::Vec3& pointMm);
/// Millimetres that one pixel covers at a point.
[[nodiscard]] double mmPerPixel(const Camera& camera, const Viewport& viewport, const core::Vec3& pointMm);

/// As if the hand turned the tooth about the target: what lies in front moves to the right and upwards on the screen
/// for positive angles [rad], along the straight line between; any turn, over the pole too, without a flip. The horizon
/// is not held: it tilts as a ball under the hand would.
[[nodiscard]] Camera orbited(const Camera& camera, double rightRad, double upRad);
/// So that what lies at the target's depth follows the pointer by this many pixels.
[[nodiscard]] Camera panned(const Camera& camera, const Viewport& viewport, const core::Vec2& pixels);
/// Nearer (factor > 1) to what lies under the pixel: that point keeps its place on the screen. `pointMm`: the surface
/// there, where there is one. Held between 4 and 400 mm from the target; an eye already beyond goes no further.
[[nodiscard]] Camera zoomed(const Camera& camera, const Viewport& viewport, const core::Vec2& pixel, double factor,
                            const std::optional<core::Vec3>& pointMm = {});

/// How a tooth stands in the mouth, as far as a picture of it must know.
struct Standing {
    int buccalSign = 0;    ///< as in cases::Case; 0 counts as +1
    bool isUpper = false;  ///< its crown hangs down: +z, occlusal, is down in the picture

    Standing(int sign = 0, bool upper = false) : buccalSign(sign), isUpper(upper) {}  // NOLINT: a lower one by its sign
    /// Up in a picture from a side.
    [[nodiscard]] core::Vec3 up() const { return {0.0, 0.0, isUpper ? -1.0 : 1.0}; }
};
/// As its FDI number says; without one as a lower tooth stands, crown up.
[[nodiscard]] Standing standingOf(int fdiNumber, int buccalSign);

/// The standard dental views, from that side, as who sits before the patient sees them: a lower crown points up, an
/// upper one down. The occlusal one looks along -z, with lingual at the top of the picture for a lower tooth and buccal
/// for an upper one (occlusal.h says why). From buccal mesial is on the right for teeth of the patient's right side.
/// Oblique: from buccal, mesial and occlusal.
enum class StandardView { occlusal, buccal, lingual, mesial, distal, oblique };
/// In the order of the keys 1 to 6, with their names as typed ("occlusal").
[[nodiscard]] const std::vector<std::pair<StandardView, std::string_view>>& standardViews();
/// By name; throws core::Error naming those there are.
[[nodiscard]] StandardView viewByName(std::string_view name);
/// Such that `bounds` fills the picture.
[[nodiscard]] Camera standardView(StandardView view, const core::Box& bounds, const Standing& standing,
                                  const Viewport& viewport);
/// The same direction, moved so that all of `bounds` is seen and fills the picture but for a small margin. The target
/// comes to lie at the depth of the box's middle.
[[nodiscard]] Camera fitted(const Camera& camera, const core::Box& bounds, const Viewport& viewport);

}  // namespace handpiece::view
