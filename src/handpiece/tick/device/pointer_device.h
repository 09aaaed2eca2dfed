// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Mouse and keyboard as a haptic device: a simulated hand between where they point and the bur. The hand is steady,
/// gives way to the tooth's force, and presses with a chosen load.

#include <memory>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/rt/triple_buffer.h"
#include "handpiece/tick/device/device.h"

namespace handpiece::device {

inline constexpr double kFallFreely = 1e4;

/// What the pointer wants of the hand: the latest value counts.
struct PointerTarget {
    /// Where the hand wants the bur. While it presses, this place along the bur's axis counts for nothing: the load
    /// decides how far in it comes.
    double positionMm[3]{0, 0, 40};
    double orientation[4]{1, 0, 0, 0};  ///< w x y z, bur in tooth
    double pedal = 0.0;                 ///< 0..1
    double loadN = 0.0;                 ///< pressing along the bur's axis, tip first; 0: no pressing, the place counts
    bool hasStop = false;       ///< depth stop: the tip is pressed no farther along the bur's axis than the stop point
    double stopMm[3]{0, 0, 0};  ///< the plane through it across the axis; where the load ends, so that cutting does
    /// A pressing hand that the tooth does not hold goes no farther along the axis than this from where it last did (or
    /// from where it began to press)...
    double fallMm = kFallFreely;
    /// ...or than the plane through this point across the axis, when that is farther: it is let down to what lies
    /// there.
    bool hasFloor = false;
    double floorMm[3]{0, 0, 0};
    bool frozen = false;  ///< the hand stands where it is (the view is being turned)
    bool away = false;    ///< Escape, lost focus: pedal up, the bur is lifted along its axis
};
using PointerMailbox = rt::TripleBuffer<PointerTarget>;

/// A hand in two parts: where it wants to be, which follows the pointer smoothly and within its speed, and a mass on a
/// spring and damper about that, on which the tooth's force acts. In free air the mass is where the hand wants it.
struct PointerHandSettings {
    double massKg = 0.05;
    double stiffnessNPerMm = 4.0;   ///< across the axis, and along it when it does not press
    double dampingNSPerMm = 0.028;  ///< critical for that
    double mostPullN = 2.0;         ///< of that spring: a hand that is held by the tooth pulls no harder
    double followS = 0.012;         ///< behind a pointer that moves evenly
    double approachMmS = 20.0;      ///< fastest along the axis while it presses, in the air too
    double travelMmS = 400.0;       ///< fastest of a hand that follows the pointer
    double turnRadS = 12.0;
    double liftMm = 5.0;             ///< when away
    double stopStiffnessNPerMm = 5;  ///< how fast the load falls to none before the depth stop
    double subStepS = 50e-6;
};

/// What the tooth may do to a pointer's hand: the simulated arm's forces, and four times its stiffness, since no motor
/// has to render it. With a desktop arm's, 1 N would take the hand 2 mm from the bur that one sees.
[[nodiscard]] const Capability& pointerCapability();

/// The device: reads the mailbox once a tick. What it reports is what the hand does, so sessions record it and a replay
/// repeats it. Its capability is pointerCapability(). A pointer that says nothing holds still; a target that is not
/// finite counts as none.
class PointerDevice final : public Device {
  public:
    /// `mailbox` is shared with the one thread that writes it. Throws core::Error for settings out of range.
    PointerDevice(PointerHandSettings settings, std::shared_ptr<PointerMailbox> mailbox, const core::Pose& start);
    ~PointerDevice() override;

    [[nodiscard]] const Capability& capability() const noexcept override;
    Reading read(double periodS) noexcept HANDPIECE_REALTIME override;
    void command(const core::Vec3& forceN, const core::Vec3& torqueNmm) noexcept HANDPIECE_REALTIME override;
    core::Vec3 truePositionMm() const noexcept override;
    core::Vec3 appliedForceN() const noexcept override;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace handpiece::device
