// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/safety/guarded_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/base/rt/realtime_thread.h"
#include "handpiece/base/rt/second.h"
#include "handpiece/base/rt/staged.h"
#include "handpiece/devices/safety/guard_servo.h"

namespace handpiece::safety {
namespace {

using core::Vec3;
using link::DeviceFault;
using rt::kNsPerS;
constexpr double kFreeS = 0.05;              // without a force wanted: the bur is free, the clutch is honoured
constexpr std::int64_t kLookNs = 1'000'000;  // of the watchdog
constexpr int kWatchdogPriority = 85;        // above the servo and the tick, which it watches

/// What the tick tells.
struct TickHealth {
    stability::ShaperStatus shaping;
    bool clutched = false;
};

/// Stricter than or as strict as the device's record, whatever was asked for.
GateSettings heldTo(const device::Capability& record, const GateSettings& asked) {
    validate(asked);
    const GateSettings own = gateSettingsFor(record);
    GateSettings s = asked;
    s.maxForceN = std::min(asked.maxForceN, own.maxForceN);
    s.maxTorqueNmm = std::min(asked.maxTorqueNmm, own.maxTorqueNmm);
    s.maxSlopeNPerS = std::min(asked.maxSlopeNPerS, own.maxSlopeNPerS);
    s.maxTorqueSlopeNmmPerS = std::min(asked.maxTorqueSlopeNmmPerS, own.maxTorqueSlopeNmmPerS);
    // The one that is longer for a slow servo: a shorter one would find it standing between any two frames.
    s.readingTimeoutS = std::max(asked.readingTimeoutS, own.readingTimeoutS);
    return s;
}

class Board final : public HealthBoard {
  public:
    Board(const workspace::WorkspaceMapping& placing, const stability::ShaperSettings& shaping)
        : placings(std::make_unique<workspace::WorkspaceMapping>(placing)),
          shapings(std::make_unique<stability::ShaperSettings>(shaping)),
          leastScale_(placing.scale) {}

    Health read() noexcept override {
        Health health = healthOf(frames.read());
        const TickHealth& tick = ticks.read();
        health.shaping = tick.shaping;
        health.clutched = tick.clutched;
        health.relaxed = relaxed.load(std::memory_order_relaxed);
        if (standing.load(std::memory_order_relaxed)) {
            health.gate.trouble = health.gate.last = DeviceFault::stalled;
            health.gate.gain = health.servoHz = 0.0;
            health.sentN = {};
        }
        return health;
    }
    void place(const workspace::WorkspaceMapping& placing) override {
        workspace::validate(placing);
        if (placing.scale < leastScale_) {
            throw core::Error(fmt::format("a scale of {} is finer than the one the device was opened with, {}",
                                          placing.scale, leastScale_),
                              "scale", "connect the device again with that scale")
                .as("scale-at-start", {fmt::format("{}", placing.scale), fmt::format("{}", leastScale_)});
        }
        placings.stage(std::make_unique<workspace::WorkspaceMapping>(placing));
    }
    void shape(const stability::ShaperSettings& settings) override {
        stability::validate(settings);
        shapings.stage(std::make_unique<stability::ShaperSettings>(settings));
    }

    FrameBuffer frames;
    rt::TripleBuffer<TickHealth> ticks;
    rt::Staged<workspace::WorkspaceMapping> placings;
    rt::Staged<stability::ShaperSettings> shapings;
    std::atomic<std::uint64_t> relaxed{0};
    std::atomic<bool> standing{false};

  private:
    double leastScale_;
};

}  // namespace

link::DriverCommand GuardServo::exchange(const link::DriverReading& reading) noexcept {
    const std::int64_t now = nowNs_();
    lastNs_.store(now, std::memory_order_release);
    if (!held_) latest_ = commands_.read();
    const link::DriverCommand out = gate_.pass(reading, latest_, now);
    if (frame_.count == 0) windowNs_ = now;
    ++frame_.count;
    const double windowS = static_cast<double>(now - windowNs_) / kNsPerS;
    if (windowS >= 1.0) {
        frame_.servoHz = static_cast<double>(frame_.count - 1 - windowCount_) / windowS;
        windowCount_ = frame_.count - 1;
        windowNs_ = now;
    }
    frame_.reading = reading;
    frame_.gate = gate_.status();
    frame_.sentN = out.forceN;
    frame_.nowNs = now;
    forTick_.write(frame_);
    forBoard_.write(frame_);
    return out;
}

struct GuardedDevice::State {
    State(std::unique_ptr<link::Driver> with, const GuardSettings& asked)
        : driver(std::move(with)),
          settings(asked),
          nowNs(asked.nowNs ? asked.nowNs : std::function<std::int64_t()>(&rt::monotonicNs)),
          gate(heldTo(settings.atTheHand ? *settings.atTheHand : driver->info().capability,
                      heldTo(driver->info().capability, asked.gate))),
          capability(
              workspace::atTheBur(settings.atTheHand ? *settings.atTheHand : driver->info().capability, asked.placing)),
          board(std::make_shared<Board>(asked.placing, asked.shaping)),
          servo(gate, nowNs, frames, board->frames),
          mapping(asked.placing),
          shaper(asked.shaping) {}

    void takeStaged() noexcept;
    void clutch(const link::DriverReading& reading, core::Pose& pose, double& pedal) noexcept;
    void watch() noexcept;

    std::unique_ptr<link::Driver> driver;
    GuardSettings settings;
    std::function<std::int64_t()> nowNs;
    GateSettings gate;
    device::Capability capability;
    std::shared_ptr<Board> board;
    FrameBuffer frames;
    GuardServo servo;

    // The tick's.
    workspace::WorkspaceTransform mapping;
    stability::Shaper shaper;
    Frame frame;
    core::Pose pose;
    Vec3 handMm = Vec3::Zero();
    double periodS = 0.001, freeS = 0.0, clutchFade = 1.0;
    bool fresh = true, lost = true, moved = false, clutched = false, clutchHeld = false;
    std::uint64_t number = 0;

    std::atomic<bool> ends{false};
    std::unique_ptr<rt::RealtimeThread> watchdog;
};

GuardedDevice::GuardedDevice(std::unique_ptr<link::Driver> driver, const GuardSettings& settings) {
    workspace::validate(settings.placing);
    stability::validate(settings.shaping);
    if (!(settings.readingTimeoutS > 0.0 && settings.readingTimeoutS <= 1.0) || settings.clutchButton > 31) {
        throw core::Error(
            fmt::format("a time-out of {} s, a clutch at button {}", settings.readingTimeoutS, settings.clutchButton),
            "guarded device", "up to 1 s; buttons 0 to 31");
    }
    state_ = std::make_unique<State>(std::move(driver), settings);
    State* state = state_.get();
    try {
        state->driver->start(state->servo);
        if (settings.advance) return;
        state->watchdog = std::make_unique<rt::RealtimeThread>(
            [state] {
                rt::PeriodicClock clock(kLookNs);
                clock.start();
                while (!state->ends.load(std::memory_order_acquire)) {
                    (void)clock.wait();
                    state->watch();
                }
            },
            kWatchdogPriority);
    } catch (...) {
        state->driver->stop();  // while what its thread talks to is still there
        throw;
    }
}

GuardedDevice::~GuardedDevice() {
    state_->ends.store(true, std::memory_order_release);
    state_->watchdog.reset();
    state_->driver->stop();
}

void GuardedDevice::State::watch() noexcept {
    const std::int64_t last = servo.lastNs();
    if (last == 0) return;  // it has not begun
    const bool stands = static_cast<double>(nowNs() - last) > gate.readingTimeoutS * kNsPerS;
    if (stands && !board->standing.load(std::memory_order_relaxed)) {
        driver->relax();
        board->relaxed.fetch_add(1, std::memory_order_relaxed);
    }
    board->standing.store(stands, std::memory_order_relaxed);
}

void GuardedDevice::State::takeStaged() noexcept {
    if (board->placings.swap()) {
        mapping = workspace::WorkspaceTransform(*board->placings.current());
        moved = true;
    }
    if (board->shapings.swap()) shaper.setSettings(*board->shapings.current());
}

void GuardedDevice::State::clutch(const link::DriverReading& reading, core::Pose& now, double& pedal) noexcept {
    const bool held = settings.clutchButton >= 0 && ((reading.buttons >> settings.clutchButton) & 1u) != 0;
    const bool begins = held && !clutchHeld && freeS >= kFreeS && pedal <= 0.0;
    clutchHeld = held;
    if (begins) clutched = true;
    if (clutched && !held) {
        mapping.regrip(reading, pose.positionMm);
        now.positionMm = pose.positionMm;
        clutched = false;
        fresh = true;
        clutchFade = 0.0;
    } else if (clutched) {
        now.positionMm = pose.positionMm;
        pedal = 0.0;
        fresh = true;
        clutchFade = 0.0;
    }
}

const device::Capability& GuardedDevice::capability() const noexcept {
    return state_->capability;
}

device::Reading GuardedDevice::read(double periodS) noexcept {
    State& s = *state_;
    if (s.settings.advance) {
        s.settings.advance(periodS);
        s.watch();
    }
    s.periodS = periodS;
    s.takeStaged();
    s.frame = s.frames.read();
    device::Reading result;
    result.burInTooth = s.pose;
    const bool wasLost = s.lost;
    const double ageS = static_cast<double>(s.nowNs() - s.frame.nowNs) / kNsPerS;
    // Another placing: for one tick the pose is none, so that the force begins anew, as after any doubt.
    s.lost = std::exchange(s.moved, false) || s.frame.count == 0 || s.frame.gate.trouble != DeviceFault::none ||
             s.frame.reading.trouble != DeviceFault::none || !(ageS <= s.settings.readingTimeoutS);
    if (!s.lost) {
        // Unit to the last bit: the gate lets one per cent pass.
        link::DriverReading reading = s.frame.reading;
        const auto& q = s.frame.reading.orientation;
        const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        for (double& c : reading.orientation)
            c /= length;
        double pedal = reading.pedal >= 0.0f ? std::clamp(static_cast<double>(reading.pedal), 0.0, 1.0)
                                             : (s.settings.upperButtonCuts && (reading.buttons & 1u) != 0 ? 1.0 : 0.0);
        core::Pose pose = s.mapping.burInTooth(reading);
        s.clutch(reading, pose, pedal);
        s.lost = !pose.isValid();
        if (!s.lost) {
            s.pose = pose;
            s.handMm = core::toVec(reading.positionMm);
            result.burInTooth = pose;
            result.pedal = pedal;
            result.buttons = reading.buttons;
        }
    }
    if (s.lost || wasLost) s.fresh = true;
    if (s.lost) s.clutched = false;
    // A hand whose pose is in doubt holds neither pedal nor button.
    result.status = s.lost ? device::ReadStatus::lost : device::ReadStatus::ok;
    s.board->ticks.write({s.shaper.status(), s.clutched});
    return result;
}

void GuardedDevice::command(const Vec3& forceN, const Vec3& torqueNmm) noexcept {
    State& s = *state_;
    s.freeS = forceN.isZero(0.0) ? std::min(1.0, s.freeS + s.periodS) : 0.0;
    link::DriverCommand command;
    if (forceN.allFinite() && torqueNmm.allFinite()) {
        s.clutchFade = s.clutched ? 0.0 : std::min(1.0, s.clutchFade + s.periodS / std::max(s.gate.fadeInS, s.periodS));
        const Vec3 wanted = s.clutchFade * s.mapping.inDevice(forceN);
        const Vec3 shaped = s.shaper.shape(s.handMm, wanted, s.periodS, s.fresh);
        command.forceN = s.clutched ? std::array<double, 3>{} : core::toArray(shaped);
        command.torqueNmm = core::toArray(s.clutchFade * s.mapping.torqueInDevice(torqueNmm));
        s.fresh = false;
    } else {
        // The gate sees it and says so; the shaper's memory is not to be spoiled by it.
        command.forceN = core::toArray(forceN);
        command.torqueNmm = core::toArray(torqueNmm);
        s.fresh = true;
    }
    command.timeNs = s.nowNs();
    command.number = ++s.number;
    s.servo.commands().write(command);
}

Vec3 GuardedDevice::truePositionMm() const noexcept {
    return state_->pose.positionMm;
}

Vec3 GuardedDevice::appliedForceN() const noexcept {
    return state_->mapping.inTooth(core::toVec(state_->frame.sentN));
}

const link::DriverInfo& GuardedDevice::info() const noexcept {
    return state_->driver->info();
}

link::CalibrationState GuardedDevice::calibration() {
    return state_->driver->calibration();
}

std::string GuardedDevice::calibrationStep() {
    return state_->driver->calibrationStep();
}

bool GuardedDevice::calibrate() {
    return state_->driver->calibrate();
}

std::shared_ptr<HealthBoard> GuardedDevice::health() const noexcept {
    return state_->board;
}

}  // namespace handpiece::safety
