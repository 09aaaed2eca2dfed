// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A simulated hand that watches its bur, as a person does: it waits where the bur has not cut its way yet.

#include "handpiece/tick/device/device.h"
#include "handpiece/tick/device/motion.h"

namespace handpiece::studies {

/// Leads the bur along a motion. Where the bur rests on the tooth short of its place, the hand presses the farther
/// beyond the more is left to go, and goes on the more slowly; so the motion takes as long as the turbine needs.
/// Deterministic in simulated time.
class WatchingHand final : public device::Device {
  public:
    WatchingHand(device::Capability capability, device::Motion motion)
        : capability_(std::move(capability)), motion_(std::move(motion)) {}

    [[nodiscard]] const device::Capability& capability() const noexcept override { return capability_; }
    device::Reading read(double periodS) noexcept HANDPIECE_REALTIME override;
    void command(const core::Vec3& forceN, const core::Vec3& torqueNmm) noexcept HANDPIECE_REALTIME override;
    void watch(const core::Vec3& tipMm, const core::Vec3& loadN) noexcept HANDPIECE_REALTIME override;
    core::Vec3 truePositionMm() const noexcept override { return positionMm_; }
    core::Vec3 appliedForceN() const noexcept override { return forceN_; }

    /// At the end of its way.
    [[nodiscard]] bool isDone() const noexcept { return timeS_ >= motion_.durationS(); }

  private:
    device::Capability capability_;
    device::Motion motion_;
    double timeS_ = 0.0;  ///< on the way
    bool started_ = false;
    core::Vec3 positionMm_ = core::Vec3::Zero(), forceN_ = core::Vec3::Zero();
    core::Vec3 leftMm_ = core::Vec3::Zero(), pushMm_ = core::Vec3::Zero();
    double loadN_ = 0.0;
};

}  // namespace handpiece::studies
