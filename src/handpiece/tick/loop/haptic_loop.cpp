// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/loop/haptic_loop.h"

#include <algorithm>
#include <cmath>

namespace handpiece::loop {
namespace {

/// Bricks handed over in a tick, and put in place by an undo.
constexpr std::size_t kBricksPerTick = 16, kRestoredPerMs = 32, kMinRestored = 4;
/// The cut takes its turn no more often than that (less rounding): above 2 kHz the force has the ticks between.
constexpr double kCutEveryS = 0.5e-3 * (1.0 - 1e-6);
/// The bur's surface moves at this radius, as a share of the largest, in the mean over its head.
constexpr double kMeanRadius = 2.0 / 3.0;

double rounded(double x, double step) noexcept {
    const double steps = x / step;
    return std::abs(steps) < 2147483647.0 ? std::nearbyint(steps) * step : x;
}

void tellContact(const force::Touch& touch, messages::HapticSample& sample) noexcept {
    if (!touch.touching) return;
    core::Vec3 point = touch.depth.toothPointMm, normal = touch.depth.normal;  // without patches, as in penalty mode
    double most = 0.0;
    for (const contact::Patch& patch : touch.patches.patches) {
        if (!(patch.pressureShare > most)) continue;
        most = patch.pressureShare;
        point = patch.centreMm;
        normal = patch.normal;
    }
    sample.contactPointMm = core::toArray(point);
    sample.contactNormal = core::toArray(normal);
}

std::uint32_t behindFlag(const force::Touch& touch) noexcept {
    switch (touch.behind) {
        case contact::Piece::bur:
            return 0;
        case contact::Piece::shank:
            return messages::kShankTouches;
        case contact::Piece::head:
            return messages::kHeadTouches;
        case contact::Piece::handle:
            return messages::kHandleTouches;
    }
    return 0;
}

/// So deep the turning bur has torn the gingiva, not only pushed it aside [a judgement].
constexpr double kTornMm = 0.1;

std::uint32_t gingivaFlags(const force::Touch& touch, double speedRpm) noexcept {
    std::uint32_t flags = 0;
    for (const contact::SoftTouch& soft : touch.soft) {
        flags |= messages::kPressesGingiva;
        if (soft.piece == contact::Piece::bur && soft.depthMm > kTornMm && speedRpm > 0.0)
            flags |= messages::kCutsGingiva;
    }
    return flags;
}

}  // namespace

void HapticLoop::tick(const rt::Beat& beat) noexcept {
    const std::int64_t startedNs = rt::monotonicNs();
    const double elapsedS = periodS_ * static_cast<double>(beat.periods);
    tick_ = started_ ? tick_ + static_cast<std::uint64_t>(beat.periods) : 0;
    started_ = true;
    takeStagedCommands();

    // Read the pose.
    const device::Reading reading = readDevice(elapsedS);
    // Find contacts.
    const bool lost = reading.status != device::ReadStatus::ok;
    const force::Touch& touch = force_.feel(*work_.current()->value.method, reading.burInTooth, lost, elapsedS);
    // Compute the force.
    const force::ForceCommand& command = force_.compute(touch, elapsedS, turning_);
    device_->watch(touch.proxyInTooth.positionMm, command.bearingN);
    // Send it to the hand, with the knock and the hum that make it crisp and that cut nothing.
    device_->command(eventForce_.add(force_, touch, command, {rotor_.speedRpm(), cut_.feedMmS}, elapsedS),
                     command.torqueNmm);
    device_->vibrate(eventForce_.vibrationN());
    const std::int64_t sentNs = rt::monotonicNs();
    // Then cut: that never delays the hand.
    cut(reading, touch, command, elapsedS);

    const std::int64_t workNs = sentNs - startedNs, cutNs = rt::monotonicNs() - sentNs;
    count_.lateTicks += static_cast<double>(beat.lateNs + workNs) * 1e-9 > periodS_;
    count_.missedPeriods += static_cast<std::uint64_t>(beat.periods - 1);
    ++count_.ticks;
    // Publish.
    publish(reading, touch, command, beat, workNs, cutNs);
}

device::Reading HapticLoop::readDevice(double elapsedS) noexcept {
    device::Reading reading = device_->read(elapsedS);
    for (int k = 0; k < 3; ++k)
        reading.burInTooth.positionMm[k] = rounded(reading.burInTooth.positionMm[k], messages::kPositionStepMm);
    for (int k = 0; k < 4; ++k)
        reading.burInTooth.orientation.coeffs()[k] =
            rounded(reading.burInTooth.orientation.coeffs()[k], messages::kOrientationStep);
    reading.pedal =
        std::isfinite(reading.pedal) ? rounded(std::clamp(reading.pedal, 0.0, 1.0), messages::kPedalStep) : 0.0;
    if ((reading.buttons & device::kRegripsButton) != 0) force_.meetNothing();
    return reading;
}

void HapticLoop::took(std::uint64_t number) noexcept {
    lastCommand_ = std::max(lastCommand_, number);
}

void HapticLoop::takeStagedCommands() noexcept {
    if (parameters_.swap()) {
        force_.setParameters(parameters_.current()->value);
        took(parameters_.current()->number);
    }
    if (drive_.swap()) {
        rotor_.setDrive(drive_.current()->value);
        took(drive_.current()->number);
    }
    if (work_.swap()) {
        force_.waitUntilClear();
        cut_ = cutting::CutResult{};
        uncutS_ = 0.0;
        turning_ = force::Turning{};
        took(work_.current()->number);
    }
    if (restore_.swap()) {
        isRestoring_ = true;
        took(restore_.current()->number);
    }
}

void HapticLoop::cut(const device::Reading& reading, const force::Touch& touch, const force::ForceCommand& command,
                     double elapsedS) noexcept {
    // A hand whose pose is in doubt does not hold the pedal either.
    const double pedal = force_.guard().faulted() ? 0.0 : reading.pedal;
    rotor_.step(pedal, cut_.loadTorqueNmm, elapsedS);
    cutFlags_ = rotor_.stalled() && pedal > 0.0 ? messages::kStalled : 0u;
    const Work& work = work_.current()->value;
    if (!work.cutter) {
        isRestoring_ = false;  // nothing there that could change
        restoring_.store(false, std::memory_order_release);
        return;
    }
    const bool cuts = pedal > 0.0 && !force_.waiting() && !isRestoring_;
    uncutS_ = cuts ? uncutS_ + elapsedS : 0.0;
    const bool isTurn = uncutS_ >= kCutEveryS;
    if (!cuts)
        cut_ = work.cutter->rest();
    else if (isTurn)
        cut_ = work.cutter->cut(*work.method,
                                {touch.proxyInTooth, touch.deviceInTooth, command.loadN, rotor_.speedRadS(), uncutS_});
    if (isTurn) uncutS_ = 0.0;
    if (isRestoring_) restoreSome();
    // Until the next cut this one holds.
    if (std::any_of(cut_.removedMm3.begin(), cut_.removedMm3.end(), [](double v) { return v > 0.0; }))
        cutFlags_ |= messages::kCutting;
    turning_.tangentialN = cut_.tangentialN;
    turning_.surfaceSpeedMmS = rotor_.speedRadS() * kMeanRadius * work.cutter->largestRadiusMm();
    handOver();
}

void HapticLoop::handOver() noexcept {
    cutting::Cutter& cutter = *work_.current()->value.cutter;
    for (std::size_t i = 0; i < cutter.toothCount(); ++i) {
        tooth::ToothState& field = cutter.field(i);
        if (field.outOfBricks()) cutFlags_ |= messages::kOutOfBricks;
        handedBricks_ += field.handOver(
            kBricksPerTick, [this](const tooth::BrickSnapshot& brick) noexcept { return bricks_.tryPush(brick); });
    }
}

void HapticLoop::restoreSome() noexcept {
    Restore& restore = restore_.current()->value;
    cutting::Cutter& cutter = *work_.current()->value.cutter;
    cutFlags_ |= messages::kRestoring;
    force_.waitUntilClear();  // until the last brick is in place
    // The same share of a period at every rate.
    auto left = std::max(static_cast<std::size_t>(1e3 * periodS_ * static_cast<double>(kRestoredPerMs)), kMinRestored);
    const std::vector<tooth::StateDelta::Brick>& bricks = restore.change.bricks;
    do {
        // Without bricks it still has volumes, of the tooth worked on.
        tooth::ToothState* const field = cutter.fieldOf(bricks.empty() ? 0 : tooth::toothOf(bricks[restore.next].id));
        const std::size_t next = field != nullptr ? field->restore(restore.change, restore.next, left) : bricks.size();
        left -= std::min(left, next - restore.next);
        restore.next = next;
    } while (restore.next < bricks.size() && left > 0);
    isRestoring_ = restore.next < bricks.size();
    if (!isRestoring_) restoring_.store(false, std::memory_order_release);
}

void HapticLoop::publish(const device::Reading& reading, const force::Touch& touch, const force::ForceCommand& command,
                         const rt::Beat& beat, std::int64_t workNs, std::int64_t cutNs) noexcept {
    const auto wxyz = [](const core::Quat& q) { return std::array<double, 4>{q.w(), q.x(), q.y(), q.z()}; };
    messages::HapticSample sample;
    sample.tick = tick_;
    sample.timeS = periodS_ * static_cast<double>(tick_);
    sample.positionMm = core::toArray(reading.burInTooth.positionMm);
    sample.orientation = wxyz(reading.burInTooth.orientation);
    sample.velocityMmS = core::toArray(force_.velocityMmS());
    sample.forceN = core::toArray(eventForce_.forceN());
    sample.torqueNmm = core::toArray(command.fullTorqueNmm);
    sample.depthMm = touch.depth.depthMm;
    sample.truePositionMm = core::toArray(device_->truePositionMm());
    sample.proxyPositionMm = core::toArray(touch.proxyInTooth.positionMm);
    sample.proxyOrientation = wxyz(touch.proxyInTooth.orientation);
    sample.appliedForceN = core::toArray(device_->appliedForceN());
    sample.contactAreaMm2 = touch.patches.areaMm2;
    tellContact(touch, sample);
    sample.tissue = static_cast<std::uint8_t>(touch.tissue);
    sample.tooth = touch.tooth;
    sample.touchedNeighbour = touch.neighbour;
    sample.contactStatus = static_cast<std::uint8_t>(touch.depth.status);
    sample.patchCount = static_cast<std::uint16_t>(touch.patches.patches.size());
    sample.flags = cutFlags_ | (command.forceLimited || eventForce_.forceLimited() ? messages::kForceLimited : 0u) |
                   (command.slopeLimited || eventForce_.slopeLimited() ? messages::kSlopeLimited : 0u) |
                   (force_.guard().invalidNow() ? messages::kInvalidPose : 0u) |
                   (force_.guard().faulted() ? messages::kFault : 0u) | (force_.waiting() ? messages::kWaiting : 0u) |
                   behindFlag(touch) | gingivaFlags(touch, rotor_.speedRpm());
    sample.workUs = static_cast<float>(static_cast<double>(workNs) * 1e-3);
    sample.lateUs = static_cast<float>(static_cast<double>(beat.lateNs) * 1e-3);
    sample.cutUs = static_cast<float>(static_cast<double>(cutNs) * 1e-3);
    sample.feedMmS = static_cast<float>(cut_.feedMmS);
    sample.elapsedPeriods = static_cast<std::int32_t>(beat.periods);
    sample.buttons = reading.buttons;
    sample.handedBricks = handedBricks_;
    sample.lastCommand = lastCommand_;
    sample.pedal = reading.pedal;
    sample.speedRpm = rotor_.speedRpm();
    sample.loadTorqueNmm = cut_.loadTorqueNmm;
    double most = 0.0;
    if (const cutting::Cutter* const cutter = work_.current()->value.cutter.get(); cutter != nullptr)
        for (std::size_t i = 0; i < cutter->toothCount(); ++i) {
            const tooth::ToothState& field = cutter->field(i);
            const double removed = tooth::sumOf(field.removedMm3());
            if (field.toothNumber() == 0)
                sample.removedMm3 = field.removedMm3();
            else
                sample.removedOthersMm3 += removed;
            if (field.toothNumber() > 0 && removed > most) {
                most = removed;
                sample.cutNeighbour = field.toothNumber();
            }
            sample.waitingBricks += static_cast<std::uint32_t>(cutter->field(i).waitingBricks());
        }
    samples_.tryPush(sample);
}

}  // namespace handpiece::loop
