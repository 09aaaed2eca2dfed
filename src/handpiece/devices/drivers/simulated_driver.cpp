// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/simulated_driver.h"

#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/base/rt/realtime_thread.h"
#include "handpiece/tick/device/capability.h"

namespace handpiece::drivers {
namespace {

using core::Pose;
using core::Quat;
using core::Vec3;

constexpr double kNsPerS = 1e9;
constexpr std::int64_t kVirtualStartNs = 1'000'000'000;
constexpr int kServoPriority = 82;  // above the tick: it is the device
// The motion when none is given: a circle a hand could draw, clear of any tooth.
const Vec3 kRestMm(0.0, 0.0, 30.0);
constexpr double kCircleMm = 10.0, kCircleMmS = 30.0;
constexpr int kCircles = 2000;

device::Motion circles() {
    return device::closedLoop({kRestMm, Quat::Identity()}, Vec3::UnitX(), Vec3::UnitY(), kCircleMm, kCircleMmS,
                              kCircles);
}

}  // namespace

struct SimulatedDriver::State {
    explicit State(SimulatedSettings with)
        : settings(std::move(with)),
          arm(settings.arm, settings.motion ? *std::exchange(settings.motion, std::nullopt) : circles()),
          mapping(settings.placing) {
        info.driver = "simulated";
        info.model = settings.model;
        info.version = "of this program";
        info.capability = settings.arm.capability;
        info.capability.name = settings.model;
        info.capability.rateHz = settings.servoHz;
        info.servoHz = settings.servoHz;
        info.frictionN = settings.arm.frictionN;
        info.massKg = settings.arm.massKg;
        info.sources = "device/simulated_device.h; limits as the record of the simulated arm";
    }

    /// The reading whose place at the tooth is that pose: `mapping` backwards.
    [[nodiscard]] link::DriverReading readingOf(const Pose& burInTooth) const noexcept {
        link::DriverReading reading;
        const Quat stylus =
            (settings.placing.toothInDevice * burInTooth.orientation * mapping.burInStylus().conjugate()).normalized();
        reading.orientation = {stylus.w(), stylus.x(), stylus.y(), stylus.z()};
        const Vec3 atOrigin = mapping.burInTooth(reading).positionMm;
        const Vec3 hand = settings.placing.scale * mapping.inDevice(burInTooth.positionMm - atOrigin);
        reading.positionMm = {hand.x(), hand.y(), hand.z()};
        return reading;
    }

    void frame(double elapsedS, std::int64_t nowNs) noexcept {
        // Motors that were switched off meanwhile have not pushed meanwhile.
        if (off.exchange(false, std::memory_order_relaxed)) arm.command(Vec3::Zero(), Vec3::Zero());
        const device::Reading at = arm.read(elapsedS);
        link::DriverReading reading = readingOf(at.burInTooth);
        reading.timeNs = nowNs;
        reading.frame = ++frames;
        reading.pedal = static_cast<float>(at.pedal);
        const link::DriverCommand command = servo->exchange(reading);
        arm.command(mapping.inTooth(core::toVec(command.forceN)), Vec3::Zero());
    }

    SimulatedSettings settings;
    device::SimulatedDevice arm;
    workspace::WorkspaceTransform mapping;
    link::DriverInfo info;
    link::Servo* servo = nullptr;
    std::uint64_t frames = 0;
    double owedS = 0.0;
    std::int64_t virtualNs = kVirtualStartNs;
    std::atomic<bool> ends{false}, off{false};
    std::unique_ptr<rt::RealtimeThread> thread;
};

SimulatedDriver::SimulatedDriver(SimulatedSettings settings) {
    workspace::validate(settings.placing);
    if (!(settings.servoHz >= 50.0 && settings.servoHz <= 10000.0)) {
        throw core::Error(fmt::format("a servo of {} Hz", settings.servoHz), "simulated device",
                          "ask for 50 to 10,000 Hz");
    }
    state_ = std::make_unique<State>(std::move(settings));
}

SimulatedDriver::~SimulatedDriver() {
    stop();
}

const link::DriverInfo& SimulatedDriver::info() const noexcept {
    return state_->info;
}

void SimulatedDriver::start(link::Servo& servo) {
    State* s = state_.get();
    link::requireStartable(s->servo != nullptr, s->ends.load(), "simulated device");
    s->servo = &servo;
    if (s->settings.stepped) return;
    const double periodS = 1.0 / s->settings.servoHz;
    s->thread = std::make_unique<rt::RealtimeThread>(
        [s, periodS] {
            rt::PeriodicClock clock(static_cast<std::int64_t>(std::llround(periodS * kNsPerS)));
            clock.start();
            while (!s->ends.load(std::memory_order_acquire)) {
                const rt::Beat beat = clock.wait();
                s->frame(periodS * static_cast<double>(beat.periods), rt::monotonicNs());
            }
            s->arm.command(Vec3::Zero(), Vec3::Zero());
        },
        kServoPriority);
}

void SimulatedDriver::stop() noexcept {
    state_->ends.store(true, std::memory_order_release);
    state_->thread.reset();
}

void SimulatedDriver::relax() noexcept {
    state_->off.store(true, std::memory_order_relaxed);
}

void SimulatedDriver::step(double periodS) noexcept {
    State& s = *state_;
    if (!s.servo || s.ends.load(std::memory_order_acquire)) return;
    const double frameS = 1.0 / s.settings.servoHz;
    s.owedS += periodS;
    const std::int64_t endNs = s.virtualNs + static_cast<std::int64_t>(std::llround(periodS * kNsPerS));
    while (s.owedS >= frameS - 1e-9) {
        s.owedS -= frameS;
        s.virtualNs = endNs - static_cast<std::int64_t>(std::llround(std::max(0.0, s.owedS) * kNsPerS));
        s.frame(frameS, s.virtualNs);
    }
    s.virtualNs = endNs;
}

std::int64_t SimulatedDriver::nowNs() const noexcept {
    return state_->settings.stepped ? state_->virtualNs : rt::monotonicNs();
}

Vec3 SimulatedDriver::appliedForceN() const noexcept {
    return state_->off.load(std::memory_order_relaxed) ? Vec3(Vec3::Zero()) : state_->arm.appliedForceN();
}

Found lookSimulated() {
    Found found;
    found.driver = "simulated";
    found.makes = "the simulated arm";
    found.available = true;
    found.models = {"simulated arm"};
    return found;
}

std::unique_ptr<link::Driver> openSimulated(const OpenOptions& options) {
    SimulatedSettings settings;
    if (!options.which.empty() && options.which != settings.model) {
        settings.arm.capability = device::capabilityByName(options.which);  // "omni", "touch", ...: names what there is
        settings.model = options.which;
    }
    if (options.servoHz > 0.0) settings.servoHz = options.servoHz;
    return std::make_unique<SimulatedDriver>(std::move(settings));
}

}  // namespace handpiece::drivers
