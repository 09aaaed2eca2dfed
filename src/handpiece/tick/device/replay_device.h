// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A device that reads out what a hand did earlier, tick by tick.

#include <cstddef>
#include <vector>

#include "handpiece/tick/device/device.h"

namespace handpiece::device {

/// Gives the recorded readings in their order, one a tick, whatever force is commanded: the same ticks again.
class ReplayDevice final : public Device {
  public:
    /// `capability` is that of the device which was recorded: it limits the force, and so what is cut. Throws
    /// core::Error when there is no reading or the capability is out of range.
    ReplayDevice(Capability capability, std::vector<Reading> readings);

    [[nodiscard]] const Capability& capability() const noexcept override { return capability_; }
    /// The next reading; past the last one it is lost.
    Reading read(double periodS) noexcept HANDPIECE_REALTIME override;
    void command(const core::Vec3& forceN, const core::Vec3& torqueNmm) noexcept HANDPIECE_REALTIME override;
    core::Vec3 truePositionMm() const noexcept override;
    core::Vec3 appliedForceN() const noexcept override { return forceN_; }

    /// Goes on with these when the ones before have been read: a long record comes by stretches. Between two ticks;
    /// what was not read yet is dropped. Throws core::Error when there is none.
    void continueWith(std::vector<Reading> readings);
    /// Readings given so far, of the present stretch.
    [[nodiscard]] std::size_t played() const noexcept { return next_; }

  private:
    Capability capability_;
    std::vector<Reading> readings_;
    std::size_t next_ = 0;
    core::Vec3 forceN_ = core::Vec3::Zero();
};

}  // namespace handpiece::device
