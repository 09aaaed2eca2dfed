// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A device whose force goes through a stability::Shaper: how the simulated arm gets what a real one gets from its
/// guard.

#include <memory>

#include "handpiece/tick/device/device.h"
#include "handpiece/tick/stability/shaper.h"

namespace handpiece::loop {

/// What a capability record says of the device; friction, delay and mass stay as they are by default.
[[nodiscard]] stability::ShaperSettings shaperSettingsFor(const device::Capability& capability);

class ShapedDevice final : public device::Device {
  public:
    /// Throws core::Error for settings out of range.
    ShapedDevice(std::unique_ptr<device::Device> inner, const stability::ShaperSettings& settings);

    [[nodiscard]] const device::Capability& capability() const noexcept override { return inner_->capability(); }
    device::Reading read(double periodS) noexcept HANDPIECE_REALTIME override;
    /// A torque is scaled as its force is.
    void command(const core::Vec3& forceN, const core::Vec3& torqueNmm) noexcept HANDPIECE_REALTIME override;
    core::Vec3 truePositionMm() const noexcept override { return inner_->truePositionMm(); }
    core::Vec3 appliedForceN() const noexcept override { return inner_->appliedForceN(); }

    [[nodiscard]] const stability::ShaperStatus& status() const noexcept { return shaper_.status(); }
    [[nodiscard]] const core::Vec3& sentN() const noexcept { return sentN_; }
    [[nodiscard]] const stability::Shaper& shaper() const noexcept { return shaper_; }

  private:
    std::unique_ptr<device::Device> inner_;
    stability::Shaper shaper_;
    core::Vec3 positionMm_ = core::Vec3::Zero(), sentN_ = core::Vec3::Zero();
    double periodS_ = 0.0;
    bool fresh_ = true;
};

}  // namespace handpiece::loop
