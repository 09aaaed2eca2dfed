// SPDX-License-Identifier: Apache-2.0
// The loop's other threads: what they give it, and what they hear of it.
#include <fmt/format.h>

#include "handpiece/base/core/error.h"
#include "handpiece/tick/device/capability.h"
#include "handpiece/tick/loop/haptic_loop.h"

namespace handpiece::loop {
namespace {

constexpr double kMinRateHz = 100, kMaxRateHz = 10000;

double checkedPeriodS(double rateHz) {
    if (!(rateHz >= kMinRateHz && rateHz <= kMaxRateHz)) {
        throw core::Error(fmt::format("a rate of {} Hz cannot be run", rateHz), "rate",
                          "choose 1000, 2000, 4000 or 8000");
    }
    return 1.0 / rateHz;
}

template <class T>
std::unique_ptr<T> required(std::unique_ptr<T> p, const char* what) {
    if (!p) throw core::Error(fmt::format("there is no {}", what), "haptic loop");
    return p;
}

Work checked(Work work) {
    if (!work.method) throw core::Error("there is no contact method", "haptic loop");
    return work;
}

force::Limits limitsOf(const device::Capability& c) {
    return {c.maxForceN, c.maxStiffnessNPerMm, c.maxDampingNSPerMm, c.maxForceSlopeNPerS, c.maxTorqueNmm};
}

}  // namespace

HapticLoop::HapticLoop(const LoopSettings& settings, std::unique_ptr<device::Device> device,
                       std::unique_ptr<contact::Method> method, const force::Parameters& parameters)
    : HapticLoop(settings, std::move(device), Work{std::move(method), nullptr}, parameters) {}

HapticLoop::HapticLoop(const LoopSettings& settings, std::unique_ptr<device::Device> device, Work work,
                       const force::Parameters& parameters, const instrument::Drive& drive)
    : settings_(settings),
      periodS_(checkedPeriodS(settings.rateHz)),
      device_(required(std::move(device), "device")),
      work_(std::make_unique<Command<Work>>(Command<Work>{checked(std::move(work))})),
      parameters_(std::make_unique<Command<force::Parameters>>(Command<force::Parameters>{parameters})),
      drive_(std::make_unique<Command<instrument::Drive>>(Command<instrument::Drive>{drive})),
      restore_(nullptr),
      force_(limitsOf(device_->capability()), parameters),
      eventForce_(limitsOf(device_->capability()), settings.rateHz),
      rotor_(drive),
      samples_(settings.queueCapacity),
      bricks_(settings.brickCapacity) {
    device::validate(device_->capability());
    instrument::validate(drive);
}

std::uint64_t HapticLoop::setParameters(const force::Parameters& parameters) {
    validate(parameters);
    parameters_.stage(
        std::make_unique<Command<force::Parameters>>(Command<force::Parameters>{parameters, ++commands_}));
    return commands_;
}

std::uint64_t HapticLoop::setDrive(const instrument::Drive& drive) {
    instrument::validate(drive);
    drive_.stage(std::make_unique<Command<instrument::Drive>>(Command<instrument::Drive>{drive, ++commands_}));
    return commands_;
}

std::uint64_t HapticLoop::setWork(Work work) {
    if (restoring())
        throw core::Error("an undo is still being put in place", "haptic loop", "change bur or tooth after it");
    work_.stage(std::make_unique<Command<Work>>(Command<Work>{checked(std::move(work)), ++commands_}));
    return commands_;
}

std::uint64_t HapticLoop::setMethod(std::unique_ptr<contact::Method> method) {
    return setWork(Work{std::move(method), nullptr});
}

std::uint64_t HapticLoop::restore(tooth::StateDelta change) {
    if (restoring())
        throw core::Error("an earlier undo is still being put in place", "haptic loop", "wait until it is done");
    restoring_.store(true, std::memory_order_release);
    restore_.stage(std::make_unique<Command<Restore>>(Command<Restore>{{std::move(change), 0}, ++commands_}));
    return commands_;
}

void HapticLoop::fetch(const Listener& listener, const BrickListener& bricks) {
    messages::HapticSample sample;
    while (samples_.tryPop(sample)) {
        for (; bricks && fetchedBricks_ < sample.handedBricks && bricks_.tryPop(fetched_); ++fetchedBricks_)
            bricks(fetched_);
        if (listener) listener(sample);
    }
}

void HapticLoop::beginRun() noexcept {
    stop_.store(false, std::memory_order_relaxed);
    count_ = {};
}

void HapticLoop::release() noexcept {
    device_->command(core::Vec3::Zero(), core::Vec3::Zero());
}

}  // namespace handpiece::loop
