// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A device whose force goes through a stability::Shaper: how the simulated arm gets what a real one gets from its
/// guard.

#include <memory>

#include "handpiece/tick/device/passing_device.h"
#include "handpiece/tick/stability/shaper.h"

namespace handpiece::studies {

/// What a capability record says of the device; friction, delay and mass stay as they are by default.
[[nodiscard]] stability::ShaperSettings shaperSettingsFor(const device::Capability& capability);

class ShapedDevice final : public device::PassingDevice {
  public:
    /// Throws core::Error for settings out of range.
    ShapedDevice(std::unique_ptr<device::Device> inner, const stability::ShaperSettings& settings);

    device::Reading read(double periodS) noexcept HANDPIECE_REALTIME override;
    /// A torque is scaled as its force is.
    void command(const core::Vec3& forceN, const core::Vec3& torqueNmm) noexcept HANDPIECE_REALTIME override;

    [[nodiscard]] const stability::ShaperStatus& status() const noexcept { return shaper_.status(); }
    [[nodiscard]] const core::Vec3& sentN() const noexcept { return sentN_; }
    [[nodiscard]] const stability::Shaper& shaper() const noexcept { return shaper_; }

  private:
    stability::Shaper shaper_;
    core::Vec3 positionMm_ = core::Vec3::Zero(), sentN_ = core::Vec3::Zero();
    double periodS_ = 0.0;
    bool fresh_ = true;
};

}  // namespace handpiece::studies
