// SPDX-License-Identifier: Apache-2.0
// Who holds the handpiece: the mouse, or a device that was chosen.
#include "desktop/work/simulator.h"
#include "handpiece/app/input/pointer_controller.h"
#include "handpiece/devices/safety/input_device.h"

namespace handpiece::desktop {

namespace {

core::Box boundsOf(const cases::Case& toothCase) {
    core::Box box = toothCase.outer.bounds();
    if (toothCase.outer.vertices.empty())
        for (const cases::Part& part : toothCase.parts)
            for (const core::Vec3& v : part.mesh.vertices)
                box.extend(v);
    return box;
}

}  // namespace

namespace {

/// Its pedal is up from the moment at which the exercise's time is over, and in a pause.
class EndingDevice final : public device::PassingDevice {
  public:
    using Flag = std::shared_ptr<const std::atomic<bool>>;
    EndingDevice(std::unique_ptr<device::Device> inner, Flag isOver, Flag isPaused)
        : PassingDevice(std::move(inner)), isOver_(std::move(isOver)), isPaused_(std::move(isPaused)) {}
    device::Reading read(double periodS) noexcept HANDPIECE_REALTIME override {
        device::Reading reading = PassingDevice::read(periodS);
        if (isOver_->load(std::memory_order_relaxed) || isPaused_->load(std::memory_order_relaxed)) reading.pedal = 0.0;
        return reading;
    }

  private:
    Flag isOver_, isPaused_;
};

}  // namespace

std::unique_ptr<device::Device> Simulator::takeHandpiece() {
    handChanged_ = false;
    usedHand_ = hands_.current() && !handLentAway_ ? hands_.current() : nullptr;
    const input::ToothPlace tooth{boundsOf(*toothCase_), toothCase_->fdiNumber, toothCase_->buccalSign};
    startPose_ = input::startPose(tooth.box, tooth.fdiNumber, tooth.buccalSign);
    if (usedHand_) {
        mailbox_.reset();
        usedHand_->placeFor(tooth);
        return std::make_unique<EndingDevice>(std::make_unique<LentDevice>(usedHand_), isTimeOver_, isPaused_);
    }
    mailbox_ = std::make_shared<device::PointerMailbox>();
    return std::make_unique<EndingDevice>(
        safety::withPedal(std::make_unique<device::PointerDevice>(device::PointerHandSettings{}, mailbox_, startPose_),
                          foot_.value()),
        isTimeOver_, isPaused_);
}

/// The mouse's hand, its pedal dead: a sitting like any other that cuts and records nothing.
void Simulator::beginTouch(std::shared_ptr<Touchable> of) {
    if (mode_ != Mode::empty || !job_ || touch_ || exam_) return;
    auto touch = std::make_unique<Touch>();
    const cases::Case& toothCase = *of->toothCase;
    touch->startPose = input::startPose(boundsOf(toothCase), toothCase.fdiNumber, toothCase.buccalSign);
    touch->mailbox = std::make_shared<device::PointerMailbox>();
    const auto never = std::make_shared<std::atomic<bool>>(true);
    auto hand = std::make_unique<EndingDevice>(
        std::make_unique<device::PointerDevice>(device::PointerHandSettings{}, touch->mailbox, touch->startPose), never,
        never);
    of->station.settings.capability = hand->capability();
    simulation::LiveSessionSettings settings;
    settings.realTime = options_.realTime;
    touch->session =
        std::make_unique<simulation::LiveSession>(of->station, toothCase, std::move(hand), settings, of->liveTooth);
    touch->feed = touch->session->subscribe();
    touch->of = std::move(of);
    touch_ = std::move(touch);
    emit touchBegan();
}

/// The same tooth, as it is, in another hand: what was cut stays, with what can be undone.
void Simulator::passHandpiece() {
    const std::shared_ptr<Hand> now = handLentAway_ ? nullptr : hands_.current();
    settings_.capability = now ? now->device().capability() : device::pointerCapability();
    handChanged_ = mode_ == Mode::liveSession && now != usedHand_;
    // A job that is under way ends first.
    if (handChanged_ && !job_) {
        const auto left = std::make_shared<Left>(leaveLiveSession());
        comeBack(left);
    }
    emit settingsChanged();
}

void Simulator::setEventBasedForce(bool contact, bool vibration) {
    if (mode_ == Mode::replay || mode_ == Mode::review) return;
    settings_.parameters.transients.on = contact;
    settings_.parameters.vibration.on = vibration;
    if (mayWork()) liveSession_->setParameters(settings_.parameters);
    emit settingsChanged();
}

void Simulator::lendHand(bool away) {
    if (away == handLentAway_) return;
    handLentAway_ = away;
    passHandpiece();
}

}  // namespace handpiece::desktop
