// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// From mouse and keyboard to what the simulated hand shall do. Knows no window: pixels, modifiers and milliseconds in,
/// targets out.

#include <functional>
#include <memory>
#include <optional>

#include "handpiece/base/messages/haptic_sample.h"
#include "handpiece/senses/measure/tooth_probe.h"
#include "handpiece/senses/view/camera.h"
#include "handpiece/tick/device/pointer_device.h"

namespace handpiece::station {

inline constexpr double kHoverMm = 0.5, kLeastLoadN = 0.1, kMostLoadN = 3.0, kFirstLoadN = 1.0;
inline constexpr double kNudgeMm = 0.1, kFineNudgeMm = 0.02, kSlowFactor = 0.2, kStopStepMm = 0.1;

/// Where a hand begins: the bur along the tooth's long axis some millimetres above its box, the handle out of the
/// mouth: to mesial and a little to the cheek for a back tooth, to the lips for a front one (`fdiNumber` 0: as a back
/// tooth).
[[nodiscard]] core::Pose startPose(const core::Box& tooth, int fdiNumber, int buccalSign);

/// One thread: the window's. Every call ends in a new target in the mailbox.
class PointerHand {
  public:
    /// Meets the tooth along a line of sight, as it is now.
    using Cast = std::function<std::optional<measure::Hit>(const view::Ray&)>;
    /// `settings` are the device's: they say how far a target must lie in a wall to press on it with a load.
    PointerHand(std::shared_ptr<device::PointerMailbox> mailbox, const core::Pose& start, Cast cast,
                const device::PointerHandSettings& settings = {});

    /// How much of the tooth is gone over a point of the surface, along an axis (unit, away from the tooth) [mm]: depth
    /// stops count from the surface before any cut. Without it they count from the surface as it is.
    using GoneOver = std::function<double(const core::Vec3& pointMm, const core::Vec3& axis)>;
    void setGoneOver(GoneOver goneOver);

    /// Before every other call when the eye has moved.
    void setEye(const view::Camera& camera, const view::Viewport& viewport);
    /// Where the bur is by now (the proxy): the press begins there, nudges go from there, and whether there is tooth to
    /// press on is looked up there. With every picture: a bur that has slipped off the tooth is held no sooner.
    void follow(const messages::HapticSample& sample);
    /// The head's size, for the hover and for which side of the bur meets the tooth.
    void setBur(double headLengthMm, double headRadiusMm);

    /// Hovers kHoverMm off the surface under the pointer, the whole head clear of it; off the tooth in the view plane
    /// through the last place. While pressed: in the plane across the bur's axis that was frozen at the press, or the
    /// view plane when that is seen edge on. `slow`: kSlowFactor, from where it was when that began; what a press has
    /// lost that way it keeps until it ends.
    void move(const core::Vec2& pixel, bool slow = false);
    /// Left button: presses with the load; `turning`: pedal down, else the bur stands still and only touches. Where
    /// there is tooth under the bur's end the load acts along its axis. On a wall beside the bur it acts into the wall.
    /// Off the tooth there is none, nor where the bur is dragged off it: the bur keeps the height at which the tooth
    /// held it, and dragging brings its side to the tooth.
    void press(const core::Vec2& pixel, bool turning);
    /// Lifts the bur along its axis to kHoverMm over where the surface was before any cut; out of a cavity it comes
    /// with the pedal still down, and is not moved sideways before it is out. Then the next move lets it hover again.
    void release();
    void latchPedal(bool down);
    /// View steps of the keyboard [mm]: right and up on the screen, and along the bur's axis (tip first positive).
    void nudge(double rightMm, double upMm, double advanceMm);
    /// About the tip: pixels to the right and up by which the handle's end of the bur goes.
    void pivot(const core::Vec2& pixels);
    void roll(double radians);
    /// The bur's axis along the surface normal under the tip; along the tooth's long axis.
    void alignToNormal();
    void alignToTooth();
    void setLoad(double loadN);  ///< held between kLeastLoadN and kMostLoadN
    /// Below the uncut surface where the press began, along the axis; none: off.
    void setStop(std::optional<double> depthMm);
    /// The view is being turned: the bur stands still.
    void freeze(bool frozen);
    /// Escape, lost focus: pedal up, no press, the bur lifts. The next move or press brings it back.
    void escape();

    [[nodiscard]] double loadN() const noexcept;
    [[nodiscard]] std::optional<double> stopMm() const noexcept;
    [[nodiscard]] bool isPressed() const noexcept;
    [[nodiscard]] bool pedalLatched() const noexcept;
    [[nodiscard]] bool isAway() const noexcept;
    [[nodiscard]] const device::PointerTarget& target() const noexcept;

  private:
    struct State;
    std::shared_ptr<State> state_;
};

}  // namespace handpiece::station
