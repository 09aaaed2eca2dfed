// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// From mouse and keyboard to what the simulated hand shall do. Knows no window: pixels, modifiers and milliseconds in,
/// targets out.
///
/// **Like a brush.** The hand is guided by the line of sight through the pointer and by the mouth as it was before any
/// cut: teeth, gingiva, bone. What has been cut moves nothing sideways.
///
/// - The bur is led along that line until it would touch what it meets there first. Half a millimetre before that it
///   hovers. It is held so that head, shank and handle are clear there, as near to the student's own tilt as can be
///   (holding.h).
/// - Pressed, it goes on along the line, with the load, as far as tissue gives way, and no deeper than the depth stop
///   and the depth of a pass: that counts from the tooth as it was when the stroke began. On the screen that does not
///   move it: its tip is under the pointer at every depth.
/// - Where tissue holds it back across the line it pulls towards the pointer with the load. The farther it falls
///   behind, the shallower it goes, so that it comes along: a quick stroke is a shallow one.
/// - The way to another place, over an edge or beyond something, is up, across and down again (way_over.h), with the
///   pedal up.
/// - A stroke stays on the tooth, or the gingiva, on which it began: beyond it the bur is held off.

#include <functional>
#include <memory>
#include <optional>

#include "handpiece/app/input/hand_feel.h"
#include "handpiece/base/messages/haptic_sample.h"
#include "handpiece/senses/measure/tooth_probe.h"
#include "handpiece/senses/view/camera.h"
#include "handpiece/tick/device/pointer_device.h"

namespace handpiece::input {

inline constexpr double kHoverMm = 0.5, kMinLoadN = 0.1, kMaxLoadN = 3.0, kFirstLoadN = 1.0;
inline constexpr double kNudgeMm = 0.1, kFineNudgeMm = 0.02, kSlowFactor = 0.2, kStopStepMm = 0.1;
/// A stroke's depth, and the stop, that a mouse's hand begins with [judgements]: five passes to the stop.
inline constexpr double kFirstPerPassMm = 0.3, kFirstStopMm = 1.5, kMinPerPassMm = 0.1, kMaxPerPassMm = 3.0;
inline constexpr double kRestFactor = 0.5;  ///< of the pointer's way, with a finger rest [a judgement]

/// Where a hand begins: the bur along the tooth's long axis some millimetres above its box, the handle out of the
/// mouth: to mesial and a little to the cheek for a back tooth, to the lips for a front one (`fdiNumber` 0: as a back
/// tooth).
[[nodiscard]] core::Pose startPose(const core::Box& tooth, int fdiNumber, int buccalSign);

/// One thread: the window's. Every call ends in a new target in the mailbox.
class PointerController {
  public:
    /// Meets the tooth along a line of sight, as it is now.
    using Cast = std::function<std::optional<measure::Hit>(const view::Ray&)>;
    PointerController(std::shared_ptr<device::PointerMailbox> mailbox, const core::Pose& start, Cast cast);

    /// With every tooth and bur. Without it there is no tooth.
    void setFeel(std::shared_ptr<HandFeel> feel);

    /// Before every other call when the eye has moved. A stroke ends when that takes the bur from under the pointer by
    /// more than a few pixels (another view; not the wheel, nor while the view is being turned).
    void setEye(const view::Camera& camera, const view::Viewport& viewport);
    /// Where the bur is by now (the proxy): the press begins there, nudges go from there, and whether there is tooth to
    /// press on is looked up there. With every picture: a bur that has slipped off the tooth is held no sooner.
    void follow(const messages::HapticSample& sample);
    /// Hovers kHoverMm off the uncut tooth on the pointer's line of sight, the whole head clear of it; off the tooth in
    /// the view plane through the last place. `slow`: kSlowFactor, from where it was when that began; what a press has
    /// lost that way it keeps until it ends.
    void move(const core::Vec2& pixel, bool slow = false);
    /// Left button: presses with the load; `turning`: pedal down, else the bur stands still and only touches. A bur
    /// that was moved by keys is pressed where it is: the pointer leads it on from there.
    void press(const core::Vec2& pixel, bool turning);
    /// Lifts the bur off the uncut tooth by kHoverMm, along its axis or towards the eye, as is the shorter way; out of
    /// a cavity it comes with the pedal still down, led by the walls, and goes elsewhere only when it is out.
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
    /// The bur's axis towards the eye, or along the tooth's long axis: as one looks at a side, or down on the tooth. It
    /// is no tilt of the student's own.
    void faceEye();
    /// About the bur's axis, so that the handle points to the hand (working_position.h).
    void turnHandle(const core::Vec3& toHand);
    /// A finger rests there: the bur goes kRestFactor of the pointer's way, and the handpiece turns about the rest as
    /// it goes. None: no rest.
    void setRest(std::optional<core::Vec3> pointMm);
    void setLoad(double loadN);  ///< held between kMinLoadN and kMaxLoadN
    /// How far beyond its first touch of the uncut tooth the bur goes: no place of its end lies deeper, along the bur,
    /// or, where it works with its side, along the line of sight. None: off.
    void setStop(std::optional<double> depthMm);
    /// How deep one stroke goes below the tooth as it was when the stroke began. None: as far as the load takes it.
    void setPerPass(std::optional<double> depthMm);
    /// The view is being turned: the bur stands still.
    void freeze(bool frozen);
    /// Escape, lost focus: pedal up, no press, the bur lifts. The next move or press brings it back.
    void escape();

    /// Why a bur that is pressed does not cut.
    enum class Idle {
        no,         ///< it cuts, or is about to, or is not pressed
        offTooth,   ///< no tooth on the pointer's line of sight
        atStop,     ///< as deep as the depth stop allows
        passDone,   ///< as deep as one stroke goes
        offStroke,  ///< on another tooth, or on gingiva, than that on which the stroke began
        noReach,    ///< head, shank or handle would touch teeth or gingiva, however the handpiece is held
        through,    ///< no deeper here: beyond it comes out of the tooth
        onItsWay,   ///< through the air: down to the tooth, over an edge, out of a tooth that was put back round it
        stalled,    ///< the drive stands
        hurries,    ///< it cuts, and so quickly that it cuts next to nothing
        held,       ///< nothing gives way: what it touches cannot be cut with this bur, or the load is too small
    };
    [[nodiscard]] Idle idle() const noexcept;
    [[nodiscard]] bool isIdleForLong() const noexcept;  ///< longer than it takes to come down, or to pass once
    [[nodiscard]] double loadN() const noexcept;
    [[nodiscard]] std::optional<double> stopMm() const noexcept;
    [[nodiscard]] std::optional<double> perPassMm() const noexcept;
    [[nodiscard]] bool isPressed() const noexcept;
    [[nodiscard]] bool pedalLatched() const noexcept;
    [[nodiscard]] std::optional<core::Vec3> rest() const noexcept;
    /// The student's own, near which the handpiece is held.
    [[nodiscard]] core::Quat tilt() const noexcept;
    [[nodiscard]] bool isAway() const noexcept;
    /// Out of a cavity, or over something: follow() leads it on.
    [[nodiscard]] bool isOnItsWay() const noexcept;
    [[nodiscard]] const device::PointerTarget& target() const noexcept;

  private:
    struct State;
    std::shared_ptr<State> state_;
};

}  // namespace handpiece::input
