// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A hand that a test leads. It goes its whole way however late the ticks are, and waits where it is told to: what a
/// test does there is done there, on a busy machine too.

#include <algorithm>
#include <atomic>
#include <limits>
#include <memory>
#include <utility>

#include "handpiece/tick/device/device.h"
#include "handpiece/tick/device/motion.h"

namespace handpiece::simulation {

/// How far along its motion a hand may go and how far it is; the sitting's time then. Between test and tick.
struct Lead {
    std::atomic<double> untilS{0.0}, atS{0.0}, loopS{0.0};
};

/// Stiff: goes along its motion whatever the force.
class LedHand final : public device::Device {
  public:
    /// Without a lead it stops nowhere.
    LedHand(device::Motion motion, std::shared_ptr<Lead> lead) : motion_(std::move(motion)), lead_(std::move(lead)) {
        if (lead_ != nullptr) return;
        lead_ = std::make_shared<Lead>();
        lead_->untilS = std::numeric_limits<double>::infinity();
    }
    [[nodiscard]] const device::Capability& capability() const noexcept override { return capability_; }
    device::Reading read(double periodS) noexcept override {
        if (std::exchange(started_, true)) {
            loopS_ += periodS;
            // A late tick goes no farther than one in time: nothing of the way is left out.
            atS_ = std::max(atS_, std::min(atS_ + std::min(periodS, kMaxStepS), lead_->untilS.load()));
        }
        lead_->loopS = loopS_;
        lead_->atS = atS_;
        const device::TimedPose now = motion_.at(atS_);
        positionMm_ = now.burInTooth.positionMm;
        return {now.burInTooth, now.pedal};
    }
    void command(const core::Vec3& forceN, const core::Vec3& /*torqueNmm*/) noexcept override { forceN_ = forceN; }
    core::Vec3 truePositionMm() const noexcept override { return positionMm_; }
    core::Vec3 appliedForceN() const noexcept override { return forceN_; }

  private:
    static constexpr double kMaxStepS = 0.001;

    device::Capability capability_;
    device::Motion motion_;
    std::shared_ptr<Lead> lead_;
    bool started_ = false;
    double loopS_ = 0.0, atS_ = 0.0;
    core::Vec3 positionMm_ = core::Vec3::Zero(), forceN_ = core::Vec3::Zero();
};

}  // namespace handpiece::simulation
