// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A device that passes all on to another one: what derives from it changes what it means to and forgets nothing.

#include <memory>
#include <utility>

#include "handpiece/tick/device/device.h"

namespace handpiece::device {

class PassingDevice : public Device {
  public:
    [[nodiscard]] const Capability& capability() const noexcept override { return inner_->capability(); }
    Reading read(double periodS) noexcept HANDPIECE_REALTIME override { return inner_->read(periodS); }
    void command(const core::Vec3& forceN, const core::Vec3& torqueNmm) noexcept HANDPIECE_REALTIME override {
        inner_->command(forceN, torqueNmm);
    }
    void vibrate(double amplitudeN) noexcept HANDPIECE_REALTIME override { inner_->vibrate(amplitudeN); }
    void watch(const core::Vec3& tipMm, const core::Vec3& bearingN) noexcept HANDPIECE_REALTIME override {
        inner_->watch(tipMm, bearingN);
    }
    core::Vec3 truePositionMm() const noexcept override { return inner_->truePositionMm(); }
    core::Vec3 appliedForceN() const noexcept override { return inner_->appliedForceN(); }

  protected:
    explicit PassingDevice(std::shared_ptr<Device> inner) : inner_(std::move(inner)) {}

  private:
    std::shared_ptr<Device> inner_;
};

}  // namespace handpiece::device
