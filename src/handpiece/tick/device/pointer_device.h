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

/// What the pointer wants of the hand: the latest value counts.
struct PointerTarget {
    /// Where the hand wants the bur. Of a hand that presses: where the way in begins, on the uncut tooth.
    double positionMm[3]{0, 0, 40};
    double orientation[4]{1, 0, 0, 0};  ///< w x y z, bur in tooth
    double pedal = 0.0;                 ///< 0..1
    /// The way in, unit: along the line of sight, where one does not see the bur move. Zero: none, the place alone
    /// counts.
    double way[3]{0, 0, 0};
    double farMm = 0.0;  ///< along it from the place: where the tip is to be, or to stop
    /// Along it: where the surface lay when the stroke began. A tip that is left behind by the pointer comes up to
    /// there, so that a quick stroke is a shallow one. From `farMm` on: it stays as deep as it is.
    double passMm = 1e4;
    double loadN = 0.0;  ///< with which the bur presses on the tooth, along the way as far as that goes; 0: not at all
    double mostN = 0.0;  ///< of a hand without a load, on whatever it meets; 0: PointerHandSettings::mostPullN
    bool isLed = false;  ///< across the way it gives way to the tooth: out of a cavity, not through its wall
    bool regrips = false;  ///< on its way it meets nothing: Reading::buttons says kRegripsButton
    bool frozen = false;   ///< the hand stands where it is (the view is being turned)
    bool away = false;     ///< Escape, lost focus: pedal up, the bur is lifted along its axis
};
using PointerMailbox = rt::TripleBuffer<PointerTarget>;

/// A stroke goes as deep as this times its load, by its speed, or it would be the deeper the longer it lasts: what 1 N
/// cuts of enamel while it passes [judgement].
inline constexpr double kPaintMm2SPerN = 0.5;

/// A hand in one of two ways.
///
/// Without a load it is in two parts: where it wants to be, which follows the pointer smoothly and within its speed,
/// and a mass on a spring and damper about that, on which the tooth's force acts. In free air the mass is where the
/// hand wants it. With a way it comes out along that before it goes across: what is in front of the way is air.
///
/// With a load it watches its tip, as a person does: across the way it moves until the tip, not the hand, is where the
/// pointer is, and along the way it presses. Of all its force there is never more than the load, whether bur, shank,
/// head or handle bears it, on tooth or gingiva: what it needs to keep the tip in its place on a slope, or pulls
/// sideways at a wall, it does not press with. Nor is it ever farther than `farthestMm` from where the bur rests.
struct PointerHandSettings {
    double massKg = 0.05;
    double stiffnessNPerMm = 4.0;   ///< of the spring; a quarter of how fast the load falls to none where the way ends
    double dampingNSPerMm = 0.028;  ///< critical for that
    double mostPullN = 2.0;         ///< of that spring: a hand that does not press pulls no harder
    double followS = 0.012;         ///< behind a pointer that moves evenly
    double approachMmS = 20.0;      ///< fastest along the way while it presses, in the air too
    double travelMmS = 400.0;       ///< fastest of a hand that follows the pointer
    double farthestMm = 5.0;        ///< of a hand that presses, from where the bur rests
    double turnRadS = 12.0;
    double liftMm = 5.0;  ///< when away
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
    void watch(const core::Vec3& tipMm, const core::Vec3& loadN) noexcept HANDPIECE_REALTIME override;
    core::Vec3 truePositionMm() const noexcept override;
    core::Vec3 appliedForceN() const noexcept override;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace handpiece::device
