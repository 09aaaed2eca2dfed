// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How a hand's movements at a device become movements of a bur at a tooth: where the tooth lies, how the stylus is the
/// handpiece's handle, which hand, what scale, and the clutch.

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/devices/link/driver.h"

namespace handpiece::workspace {

/// The stylus is the handle of the handpiece; the bur sits in its head at an angle to it.
struct WorkspaceMapping {
    /// The hand here (device frame) has the bur's tip there (tooth frame).
    core::Vec3 deviceMm = core::Vec3::Zero(), toothMm = core::Vec3::Zero();
    core::Quat toothInDevice = core::Quat::Identity();  ///< rotation that turns tooth axes into device axes
    double scale = 1.0;                                 ///< millimetres of the hand for one of the bur: 1, 2 or 3
    /// The instrument is mirrored left to right in the stylus frame (x to -x): its head's roll and the lever
    /// tipFromStylusMm. The hand's motion never is: what goes to the right goes to the right.
    bool leftHanded = false;
    bool burAlongStylus = false;  ///< the bur goes on along the stylus instead: no angle, no roll
    /// From the handle's direction (head to tail) to where the bur points, as in a contra-angle head [R]: 90 is a right
    /// angle, 180 straight on. docs/formats/device-profile.md
    double headAngleDeg = 100.0;
    /// Of the head on its handle, as a right hand has it: positive turns where the bur points to the stylus' right.
    double headRollDeg = 0.0;
    core::Vec3 tipFromStylusMm =
        core::Vec3::Zero();  ///< bur's tip in the stylus frame. Zero: force acts where it is felt
};
/// Throws core::Error naming the value.
void validate(const WorkspaceMapping& placing);

/// The arithmetic of a Placing, for the tick.
class WorkspaceTransform {
  public:
    explicit WorkspaceTransform(const WorkspaceMapping& placing) noexcept;
    [[nodiscard]] core::Pose burInTooth(const link::DriverReading& reading) const noexcept HANDPIECE_REALTIME;
    /// Tooth frame to device frame. A force is the same whatever the scale: stiffness per millimetre of the hand's
    /// motion is then stiffness at the tooth over the scale.
    [[nodiscard]] core::Vec3 inDevice(const core::Vec3& inTooth) const noexcept HANDPIECE_REALTIME;
    [[nodiscard]] core::Vec3 inTooth(const core::Vec3& inDevice) const noexcept HANDPIECE_REALTIME;
    /// A torque about gripInBurMm(), tooth frame, as one about the stylus' origin, device frame. Times the scale, so
    /// that with the force the work done on the hand is the scale times the work done at the tooth, motion by motion.
    [[nodiscard]] core::Vec3 torqueInDevice(const core::Vec3& inToothNmm) const noexcept HANDPIECE_REALTIME;
    /// The stylus' origin in the bur frame: what force::Parameters::gripMm must be for torqueInDevice() to hold.
    [[nodiscard]] core::Vec3 gripInBurMm() const noexcept;
    [[nodiscard]] const core::Quat& burInStylus() const noexcept { return burInStylus_; }
    /// The clutch: the bur stays where it is while the hand goes elsewhere. Called with the reading at which it is let
    /// go and the pose the bur was left at, so that it goes on from there.
    void regrip(const link::DriverReading& reading, const core::Vec3& burMm) noexcept HANDPIECE_REALTIME;
    [[nodiscard]] const WorkspaceMapping& placing() const noexcept { return placing_; }

  private:
    WorkspaceMapping placing_;
    core::Quat burInStylus_;
    core::Vec3 leverMm_;  // from the stylus' origin to the bur's tip, stylus frame, mirrored where the hand is
};

/// What the device can do as seen at the bur: forces as they are, stiffness and damping times the scale (so that they
/// are the device's own per millimetre of the hand), steps, workspace and torque over it.
[[nodiscard]] device::Capability atTheBur(const device::Capability& atTheHand, const WorkspaceMapping& placing);

}  // namespace handpiece::workspace
