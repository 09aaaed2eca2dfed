// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/loop/haptic_loop.h"

namespace handpiece::loop {

void HapticLoop::tick(const rt::Beat& beat) noexcept {
    const std::int64_t startedNs = rt::monotonicNs();
    const double elapsedS = periodS_ * static_cast<double>(beat.periods);
    tick_ = started_ ? tick_ + static_cast<std::uint64_t>(beat.periods) : 0;
    started_ = true;
    takeStagedCommands();

    // Read the pose.
    const device::Reading reading = device_->read(elapsedS);
    // Find contacts.
    const bool lost = reading.status != device::ReadStatus::ok;
    const force::Touch& touch = force_.feel(*method_.current(), reading.burInTooth, lost, elapsedS);
    // Compute the force.
    const force::ForceCommand& command = force_.compute(touch, elapsedS);
    // Send it to the hand.
    device_->command(command.forceN, command.torqueNmm);

    const std::int64_t workNs = rt::monotonicNs() - startedNs;
    lateTicks_ += static_cast<double>(beat.lateNs + workNs) * 1e-9 > periodS_;
    missedPeriods_ += static_cast<std::uint64_t>(beat.periods - 1);
    ++ticksDone_;
    // Publish.
    publish(reading, touch, command, workNs, beat.lateNs);
}

void HapticLoop::takeStagedCommands() noexcept {
    if (parameters_.swap()) force_.setParameters(*parameters_.current());
    if (method_.swap()) force_.waitUntilClear();
}

void HapticLoop::publish(const device::Reading& reading, const force::Touch& touch, const force::ForceCommand& command,
                         std::int64_t workNs, std::int64_t lateNs) noexcept {
    const auto array = [](const core::Vec3& v) { return std::array<double, 3>{v.x(), v.y(), v.z()}; };
    const auto wxyz = [](const core::Quat& q) { return std::array<double, 4>{q.w(), q.x(), q.y(), q.z()}; };
    messages::HapticSample sample;
    sample.tick = tick_;
    sample.timeS = periodS_ * static_cast<double>(tick_);
    sample.positionMm = array(reading.burInTooth.positionMm);
    sample.orientation = wxyz(reading.burInTooth.orientation);
    sample.velocityMmS = array(force_.velocityMmS());
    sample.forceN = array(command.forceN);
    sample.torqueNmm = array(command.fullTorqueNmm);
    sample.depthMm = touch.depth.depthMm;
    sample.truePositionMm = array(device_->truePositionMm());
    sample.proxyPositionMm = array(touch.proxyInTooth.positionMm);
    sample.proxyOrientation = wxyz(touch.proxyInTooth.orientation);
    sample.appliedForceN = array(device_->appliedForceN());
    sample.contactAreaMm2 = touch.patches.areaMm2;
    sample.tissue = static_cast<std::uint8_t>(touch.tissue);
    sample.contactStatus = static_cast<std::uint8_t>(touch.depth.status);
    sample.patchCount = static_cast<std::uint16_t>(touch.patches.patches.size());
    sample.flags = (command.forceLimited ? messages::kForceLimited : 0u) |
                   (command.slopeLimited ? messages::kSlopeLimited : 0u) |
                   (force_.guard().invalidNow() ? messages::kInvalidPose : 0u) |
                   (force_.guard().faulted() ? messages::kFault : 0u) |
                   (force_.waiting() ? messages::kWaiting : 0u);
    sample.workUs = static_cast<float>(static_cast<double>(workNs) * 1e-3);
    sample.lateUs = static_cast<float>(static_cast<double>(lateNs) * 1e-3);
    samples_.tryPush(sample);
}

}  // namespace handpiece::loop
