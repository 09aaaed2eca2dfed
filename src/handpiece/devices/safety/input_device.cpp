// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/safety/input_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/base/rt/second.h"
#include "handpiece/base/rt/staged.h"
#include "handpiece/devices/safety/guard_servo.h"
#include "handpiece/tick/device/passing_device.h"

namespace handpiece::safety {
namespace {

using core::Vec3;
using link::DeviceFault;
using rt::kNsPerS;
constexpr double kPedalUp = 0.05;  // nobody stands on it

/// What the gate is to look at: poses and times as everywhere, with an input's own patience; shaking needs no fading.
GateSettings gateFor(const InputSettings& settings) {
    GateSettings gate;
    gate.fadeInS = 0.0;
    gate.commandTimeoutS = gate.readingTimeoutS = settings.readingTimeoutS;
    validate(gate);
    return gate;
}

class InputBoard final : public HealthBoard {
  public:
    InputBoard(const InputSettings& settings, std::function<std::int64_t()> nowNs)
        : placings(std::make_unique<workspace::WorkspaceMapping>(settings.placing)),
          nowNs_(std::move(nowNs)),
          timeoutS_(settings.readingTimeoutS) {}

    Health read() noexcept override {
        const Frame& frame = frames.read();
        Health health = healthOf(frame);
        // A tick that stands is nothing to an input.
        if (frame.count > 0 &&
            (frame.gate.trouble == DeviceFault::starting || frame.gate.trouble == DeviceFault::tickStalled))
            health.gate.trouble = DeviceFault::none;
        health.clutched = clutched.load(std::memory_order_relaxed);
        if (frame.count > 0 && !(static_cast<double>(nowNs_() - frame.nowNs) / kNsPerS <= timeoutS_)) {
            health.gate.trouble = health.gate.last = DeviceFault::stalled;
            health.servoHz = 0.0;
        }
        return health;
    }
    void place(const workspace::WorkspaceMapping& placing) override {
        workspace::validate(placing);
        placings.stage(std::make_unique<workspace::WorkspaceMapping>(placing));
    }
    void shape(const stability::ShaperSettings& settings) override { stability::validate(settings); }

    FrameBuffer frames;
    rt::Staged<workspace::WorkspaceMapping> placings;
    std::atomic<bool> clutched{false};

  private:
    std::function<std::int64_t()> nowNs_;
    double timeoutS_;
};

class WithPedal final : public device::PassingDevice {
  public:
    WithPedal(std::unique_ptr<device::Device> device, std::shared_ptr<const link::PedalValue> pedal)
        : PassingDevice(std::move(device)), pedal_(std::move(pedal)) {}
    device::Reading read(double periodS) noexcept override {
        device::Reading reading = PassingDevice::read(periodS);
        // A hand whose pose is in doubt cuts with no pedal at all.
        if (reading.status == device::ReadStatus::ok)
            reading.pedal = std::max(reading.pedal, static_cast<double>(pedal_->read(rt::monotonicNs())));
        return reading;
    }

  private:
    std::shared_ptr<const link::PedalValue> pedal_;
};

}  // namespace

struct InputDevice::State {
    State(std::unique_ptr<link::Driver> with, const InputSettings& asked)
        : driver(std::move(with)),
          settings(asked),
          nowNs(asked.nowNs ? asked.nowNs : std::function<std::int64_t()>(&rt::monotonicNs)),
          board(std::make_shared<InputBoard>(asked, nowNs)),
          servo(gateFor(asked), nowNs, frames, board->frames),
          mapping(asked.placing),
          hand(asked.hand, mailbox, mapping.burInTooth({})) {}

    [[nodiscard]] bool doubtful(const Frame& frame) const noexcept;
    [[nodiscard]] double pedalOf(const link::DriverReading& reading) const noexcept;
    void clutch(const link::DriverReading& reading, core::Pose& wanted, double& pedal) noexcept;

    std::unique_ptr<link::Driver> driver;
    InputSettings settings;
    std::function<std::int64_t()> nowNs;
    std::shared_ptr<InputBoard> board;
    FrameBuffer frames;
    GuardServo servo;
    std::shared_ptr<const link::PedalValue> foot;

    // The tick's; the mailbox too is written and read by it alone.
    workspace::WorkspaceTransform mapping;
    std::shared_ptr<device::PointerMailbox> mailbox = std::make_shared<device::PointerMailbox>();
    device::PointerDevice hand;
    device::PointerTarget target;
    core::Pose wanted;
    std::uint32_t buttons = 0;
    bool seen = false, letGoFirst = false, clutched = false;
    double humN = 0.0;
    std::uint64_t number = 0;
};

bool InputDevice::State::doubtful(const Frame& frame) const noexcept {
    if (frame.count == 0 || frame.reading.trouble != DeviceFault::none) return true;
    const DeviceFault found = frame.gate.trouble;
    if (found != DeviceFault::none && found != DeviceFault::starting && found != DeviceFault::tickStalled) return true;
    const double ageS = static_cast<double>(nowNs() - frame.nowNs) / kNsPerS;
    return !(ageS <= settings.readingTimeoutS);
}

double InputDevice::State::pedalOf(const link::DriverReading& reading) const noexcept {
    const double own = reading.pedal >= 0.0f ? std::min(1.0, static_cast<double>(reading.pedal))
                       : settings.upperButtonCuts && (reading.buttons & 3u) == 1u ? 1.0
                                                                                  : 0.0;
    return foot ? std::max(own, static_cast<double>(foot->read(nowNs()))) : own;
}

/// The bur's tip stands still while the clutch is held, and turns with the hand.
void InputDevice::State::clutch(const link::DriverReading& reading, core::Pose& next, double& pedal) noexcept {
    const bool held = settings.clutchButton >= 0 && ((reading.buttons >> settings.clutchButton) & 1u) != 0;
    if (!clutched && held && pedal <= kPedalUp) clutched = true;
    if (!clutched) return;
    next.positionMm = wanted.positionMm;
    pedal = 0.0;
    if (held) return;
    mapping.regrip(reading, wanted.positionMm);
    clutched = false;
    letGoFirst = true;
}

InputDevice::InputDevice(std::unique_ptr<link::Driver> driver, const InputSettings& settings) {
    workspace::validate(settings.placing);
    if (driver == nullptr || driver->info().pushes)
        throw core::Error("a device that pushes is no input", driver ? driver->info().model : "input device",
                          "connect it as an arm")
            .as("input-pushes", {});
    const auto good = [](double value) { return value > 0.0 && value <= 100.0; };
    if (!(settings.readingTimeoutS > 0.0 && settings.readingTimeoutS <= 1.0) || settings.clutchButton > 31 ||
        !good(settings.shakesFullyN) || !good(settings.humsFullyN))
        throw core::Error(
            fmt::format("a time-out of {} s, a clutch at button {}, shaking at {} N and {} N", settings.readingTimeoutS,
                        settings.clutchButton, settings.shakesFullyN, settings.humsFullyN),
            "input device", "up to 1 s; buttons 0 to 31; up to 100 N");
    state_ = std::make_unique<State>(std::move(driver), settings);
    try {
        state_->driver->start(state_->servo);
    } catch (...) {
        state_->driver->stop();
        throw;
    }
}

InputDevice::~InputDevice() {
    state_->driver->stop();
}

const device::Capability& InputDevice::capability() const noexcept {
    return state_->hand.capability();
}

device::Reading InputDevice::read(double periodS) noexcept {
    State& s = *state_;
    if (s.board->placings.swap()) {
        // Another placing: the hand goes there at its own speed, and with the pedal up.
        s.mapping = workspace::WorkspaceTransform(*s.board->placings.current());
        s.letGoFirst = true;
        s.clutched = false;
    }
    const Frame& frame = s.frames.read();
    const bool doubt = s.doubtful(frame);
    double pedal = 0.0;
    s.buttons = 0;
    if (doubt) {
        s.letGoFirst = true;
        s.clutched = false;
    } else {
        s.buttons = frame.reading.buttons;
        pedal = s.pedalOf(frame.reading);
        if (pedal <= kPedalUp) s.letGoFirst = false;
        core::Pose next = s.mapping.burInTooth(frame.reading);
        s.clutch(frame.reading, next, pedal);
        s.wanted = next;
        s.seen = true;
    }
    if (s.seen) {  // before the first reading the hand stands where it began
        for (int i = 0; i < 3; ++i)
            s.target.positionMm[i] = s.wanted.positionMm[i];
        const core::Quat& q = s.wanted.orientation;
        s.target.orientation[0] = q.w();
        s.target.orientation[1] = q.x();
        s.target.orientation[2] = q.y();
        s.target.orientation[3] = q.z();
        s.target.pedal = s.letGoFirst ? 0.0 : pedal;
        s.target.away = doubt;
        s.mailbox->write(s.target);
    }
    s.board->clutched.store(s.clutched, std::memory_order_relaxed);
    device::Reading reading = s.hand.read(periodS);
    reading.buttons = s.buttons;
    return reading;
}

void InputDevice::command(const Vec3& forceN, const Vec3& torqueNmm) noexcept {
    State& s = *state_;
    s.hand.command(forceN, torqueNmm);
    link::DriverCommand command;
    const double strength = std::max(forceN.norm() / s.settings.shakesFullyN, s.humN / s.settings.humsFullyN);
    command.vibration = strength > 0.0 ? static_cast<float>(std::min(strength, 1.0)) : 0.0f;  // no number: none
    command.timeNs = s.nowNs();
    command.number = ++s.number;
    s.servo.commands().write(command);
}

void InputDevice::watch(const Vec3& tipMm, const Vec3& bearingN) noexcept {
    state_->hand.watch(tipMm, bearingN);
}

void InputDevice::vibrate(double amplitudeN) noexcept {
    state_->humN = amplitudeN > 0.0 ? amplitudeN : 0.0;
}

Vec3 InputDevice::truePositionMm() const noexcept {
    return state_->hand.truePositionMm();
}
Vec3 InputDevice::appliedForceN() const noexcept {
    return state_->hand.appliedForceN();
}
const link::DriverInfo& InputDevice::info() const noexcept {
    return state_->driver->info();
}
void InputDevice::usePedal(std::shared_ptr<const link::PedalValue> pedal) noexcept {
    state_->foot = std::move(pedal);
}
std::shared_ptr<HealthBoard> InputDevice::health() const noexcept {
    return state_->board;
}

std::unique_ptr<device::Device> withPedal(std::unique_ptr<device::Device> device,
                                          std::shared_ptr<const link::PedalValue> pedal) {
    if (device == nullptr || pedal == nullptr)
        throw core::Error(device == nullptr ? "a pedal without a device" : "a device without its pedal", "pedal");
    if (auto* const input = dynamic_cast<InputDevice*>(device.get())) {
        input->usePedal(std::move(pedal));
        return device;
    }
    return std::make_unique<WithPedal>(std::move(device), std::move(pedal));
}

}  // namespace handpiece::safety
