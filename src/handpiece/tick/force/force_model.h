// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// From contact to the force on the hand: third stage of the tick.

#include <array>
#include <memory>
#include <vector>

#include "handpiece/base/core/realtime.h"
#include "handpiece/tick/contact/method.h"
#include "handpiece/tick/force/force_law.h"
#include "handpiece/tick/force/parameters.h"
#include "handpiece/tick/force/pose_guard.h"
#include "handpiece/tick/force/proxy.h"
#include "handpiece/tick/force/touch.h"

namespace handpiece::force {

struct ForceCommand {
    core::Vec3 forceN = core::Vec3::Zero();         ///< on the hand, tooth frame
    core::Vec3 torqueNmm = core::Vec3::Zero();      ///< about the grip, within the device's torque axes (zero without)
    core::Vec3 fullTorqueNmm = core::Vec3::Zero();  ///< about the grip, whatever the device can do
    core::Vec3 loadN = core::Vec3::Zero();          ///< with which the bur presses on the tooth: without friction
    /// With which bur, shank, head and handle bear on all that they meet, gingiva too: what a hand feels that way. As
    /// `loadN` where the bur alone touches a tooth that can be cut.
    core::Vec3 bearingN = core::Vec3::Zero();
    bool forceLimited = false, slopeLimited = false;
};

/// What the turning bur adds to the force.
struct Turning {
    core::Vec3 tangentialN = core::Vec3::Zero();  ///< on the bur, from its rotation against the tooth
    double surfaceSpeedMmS = 0.0;                 ///< of the bur's surface: a bur that slips anyway hardly sticks
};

/// The force of one bur in one hand. One thread; keeps the proxy, the filtered velocity and the last force.
///
/// How a contact pushes is the law's; what is the same for every law is here: the pose is believed or not, the force
/// fades in, friction and the bur's sideways force are added, size and slope are the device's, and the torque follows.
/// Friction is a bristle (Dahl 1968): it sticks with the stiffness of the contact up to Coulomb's limit, then slips.
class ForceModel {
  public:
    /// Throws core::Error for parameters out of range. Makes one of every law that there is by now.
    ForceModel(const Limits& limits, const Parameters& parameters);

    /// Finds contact for this tick's reading: depth, proxy and patches.
    const Touch& feel(contact::Method& method, const core::Pose& read, bool lost,
                      double periodS) noexcept HANDPIECE_REALTIME;
    /// The force for it. Call once after each feel().
    const ForceCommand& compute(const Touch& touch, double periodS,
                                const Turning& turning = {}) noexcept HANDPIECE_REALTIME;

    /// Takes validated parameters from the next tick on.
    void setParameters(const Parameters& parameters) noexcept HANDPIECE_REALTIME;
    /// The tooth or the bur is another one, so tissue may lie round the bur: no force until the device's pose is clear
    /// of it, then it fades in.
    void waitUntilClear() noexcept HANDPIECE_REALTIME { waiting_ = true; }
    /// As that, and in this tick gingiva is not felt either: a handpiece that is taken out and brought in meets
    /// nothing.
    void meetNothing() noexcept HANDPIECE_REALTIME { waiting_ = passesGingiva_ = true; }
    [[nodiscard]] bool waiting() const noexcept { return waiting_; }

    [[nodiscard]] const Parameters& parameters() const noexcept { return parameters_; }
    [[nodiscard]] const PoseGuard& guard() const noexcept { return guard_; }
    [[nodiscard]] const core::Vec3& velocityMmS() const noexcept { return velocityMmS_; }  ///< filtered

  private:
    [[nodiscard]] LawInput inputOf(const Touch& touch) const noexcept {
        return {touch, velocityMmS_, parameters_, limits_};
    }
    [[nodiscard]] core::Vec3 softN(const contact::SoftTouch& soft) const noexcept;
    [[nodiscard]] core::Vec3 torqueOf(const Touch& touch) const noexcept;
    void smoothShares(bool isCutNear, double periodS) noexcept;
    void updateVelocity(const core::Vec3& positionMm, bool fresh, double periodS) noexcept;
    [[nodiscard]] core::Vec3 frictionForce(const Touch& touch, const core::Vec3& pressN,
                                           const Turning& turning) noexcept;
    [[nodiscard]] core::Vec3 torqueAboutGrip(const Touch& touch, const core::Vec3& forceN) const noexcept;

    Limits limits_;
    Parameters parameters_;
    std::vector<std::unique_ptr<ForceLaw>> laws_;  // by LawId: changing from one to another makes nothing
    ForceLaw* law_;
    PoseGuard guard_;
    Proxy proxy_;
    Touch touch_;
    ForceCommand command_;
    core::Vec3 softN_ = core::Vec3::Zero();  // of what yields, in this tick
    core::Vec3 velocityMmS_ = core::Vec3::Zero(), lastPositionMm_ = core::Vec3::Zero();
    core::Vec3 heldForceN_ = core::Vec3::Zero();                                    // when the fault began
    core::Vec3 bristleMm_ = core::Vec3::Zero(), lastProxyMm_ = core::Vec3::Zero();  // of friction
    core::Vec3 tangentialN_ = core::Vec3::Zero();                                   // of the turning bur, smoothed
    std::array<double, cases::kTissueCount> lastShares_{};                          // of the tissues in the contact
    bool waiting_ = false, passesGingiva_ = false, wasWaiting_ = false, wasFaulted_ = false, wasTouching_ = false;
};

}  // namespace handpiece::force
