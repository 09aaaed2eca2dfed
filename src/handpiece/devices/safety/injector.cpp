// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/safety/injector.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/rt/second.h"
#include "handpiece/devices/link/passing_driver.h"
#include "handpiece/devices/safety/guard_servo.h"

namespace handpiece::safety {

using link::DeviceFault;
using link::DriverCommand;
using link::DriverReading;

namespace {
using rt::kNsPerS;
constexpr double kJumpMm = 100.0;

double lengthOf(const std::array<double, 3>& v) noexcept {
    return core::hypot(v[0], v[1], v[2]);
}

/// The next of a sequence of bits that look random (splitmix64).
std::uint64_t mix(std::uint64_t& state) noexcept {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
}

/// Every bit of the reading but for the two that a driver counts itself.
void fillWithGarbage(DriverReading& reading, std::uint64_t seed) noexcept {
    std::uint64_t state = seed * 2 + 1;
    for (double& v : reading.positionMm)
        v = std::bit_cast<double>(mix(state));
    for (double& v : reading.orientation)
        v = std::bit_cast<double>(mix(state));
    reading.buttons = static_cast<std::uint32_t>(mix(state));
    reading.pedal = std::bit_cast<float>(static_cast<std::uint32_t>(mix(state)));
    reading.motorTemperature = std::bit_cast<float>(static_cast<std::uint32_t>(mix(state)));
    reading.trouble = static_cast<DeviceFault>(mix(state) & 0xff);
    reading.vendorCode = static_cast<std::int32_t>(mix(state));
    reading.timeNs = static_cast<std::int64_t>(mix(state));
}

}  // namespace

std::vector<FaultOutcome> FaultLog::outcomes() const {
    return {outcomes_.begin(), outcomes_.begin() + static_cast<std::ptrdiff_t>(count())};
}

/// Its exchange() is called in the driver's thread.
class FaultyDriver final : public link::PassingDriver {
  public:
    FaultyDriver(std::unique_ptr<link::Driver> driver, std::vector<Fault> faults, std::shared_ptr<FaultLog> log)
        : PassingDriver(std::move(driver)), faults_(std::move(faults)), log_(std::move(log)) {
        std::stable_sort(faults_.begin(), faults_.end(), [](const Fault& a, const Fault& b) { return a.atS < b.atS; });
        log_->outcomes_.assign(faults_.size(), FaultOutcome{});
    }
    ~FaultyDriver() override { PassingDriver::stop(); }

    void start(link::Servo& servo) override {
        guard_ = dynamic_cast<GuardServo*>(&servo);
        PassingDriver::start(servo);
    }
    /// The watchdog's thread.
    void relax() noexcept override {
        relaxed_.store(true, std::memory_order_release);
        PassingDriver::relax();
    }

    [[nodiscard]] DriverCommand exchange(const DriverReading& given) noexcept HANDPIECE_REALTIME override {
        if (startNs_ == 0) startNs_ = given.timeNs;
        const double nowS = static_cast<double>(given.timeNs - startNs_) / kNsPerS;
        begin(nowS);
        DriverReading reading = given;
        const bool stalls = spoil(reading, nowS);
        if (!stalls) {
            relaxed_.store(false, std::memory_order_release);
            last_ = PassingDriver::exchange(reading);
        } else if (relaxed_.load(std::memory_order_acquire)) {
            last_.forceN = last_.torqueNmm = {};
            last_.vibration = 0.0f;
        }
        note(stalls ? given.timeNs : last_.timeNs, !stalls);
        return last_;
    }

  private:
    void begin(double nowS) noexcept {
        while (begun_ < faults_.size() && faults_[begun_].atS <= nowS) {
            FaultOutcome& outcome = log_->outcomes_[begun_];
            outcome.fault = faults_[begun_];
            outcome.beganNs = startNs_ + static_cast<std::int64_t>(std::llround(faults_[begun_].atS * kNsPerS));
            outcome.forceBeforeN = outcome.largestN = lengthOf(last_.forceN);
            ++begun_;
            log_->begun_.store(begun_, std::memory_order_release);
        }
    }

    /// True when the servo stands.
    bool spoil(DriverReading& reading, double nowS) noexcept {
        bool stalls = false, holds = false;
        while (firstLive_ < begun_ && faults_[firstLive_].atS + faults_[firstLive_].lastsS <= nowS)
            ++firstLive_;
        for (std::size_t i = firstLive_; i < begun_; ++i) {
            const Fault& fault = faults_[i];
            if (fault.atS + fault.lastsS <= nowS) continue;
            switch (fault.kind) {
                case FaultKind::unplug:
                    reading.trouble = DeviceFault::unplugged;
                    break;
                case FaultKind::notANumber:
                    if (i % 2 == 0)
                        reading.positionMm[i % 3] = std::numeric_limits<double>::quiet_NaN();
                    else
                        reading.orientation[i % 4] = std::numeric_limits<double>::infinity();
                    break;
                case FaultKind::jump:
                    reading.positionMm[i % 3] += kJumpMm * fault.size;
                    break;
                case FaultKind::stall:
                    stalls = true;
                    break;
                case FaultKind::error:
                    reading.trouble = DeviceFault::vendorError;
                    reading.vendorCode = static_cast<std::int32_t>(fault.size);
                    break;
                case FaultKind::badData:
                    fillWithGarbage(reading, reading.frame);
                    break;
                case FaultKind::hot:
                    reading.motorTemperature = static_cast<float>(fault.size);
                    break;
                case FaultKind::dropInput:
                    reading.trouble = DeviceFault::inputLost;
                    break;
                case FaultKind::tickStall:
                    holds = true;
                    break;
            }
        }
        if (guard_) guard_->holdTick(holds);
        return stalls;
    }

    void note(std::int64_t timeNs, bool answered) noexcept {
        const double force = lengthOf(last_.forceN);
        GateOutput& output = log_->output_;
        output.largestN = std::max(output.largestN, force);
        const bool doubtful = guard_ && guard_->gateStatus().trouble != DeviceFault::none;
        if (answered) {
            if (output.samples > 0 && !doubtful && timeNs > noted_) {
                const auto &a = last_.forceN, &b = before_;
                const double change = core::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
                output.largestSlopeNPerS =
                    std::max(output.largestSlopeNPerS, change / (static_cast<double>(timeNs - noted_) / kNsPerS));
            }
            ++output.samples;
            before_ = last_.forceN;
            noted_ = timeNs;
        }
        if (begun_ == 0) return;
        FaultOutcome& outcome = log_->outcomes_[begun_ - 1];
        outcome.largestN = std::max(outcome.largestN, force);
        if (outcome.toZeroS < 0.0 && force == 0.0)
            outcome.toZeroS = static_cast<double>(timeNs - outcome.beganNs) / kNsPerS;
        if (!outcome.told && answered && doubtful) {
            outcome.told = true;
            outcome.trouble = guard_->gateStatus().trouble;
        }
    }

    std::vector<Fault> faults_;
    std::shared_ptr<FaultLog> log_;
    GuardServo* guard_ = nullptr;  // null: some other servo
    std::size_t begun_ = 0, firstLive_ = 0;
    std::int64_t startNs_ = 0, noted_ = 0;
    DriverCommand last_;
    std::array<double, 3> before_{};
    std::atomic<bool> relaxed_{false};
};

std::unique_ptr<link::Driver> withFaults(std::unique_ptr<link::Driver> driver, std::vector<Fault> faults,
                                         std::shared_ptr<FaultLog> log) {
    if (!log) log = std::make_shared<FaultLog>();
    return std::make_unique<FaultyDriver>(std::move(driver), std::move(faults), std::move(log));
}

}  // namespace handpiece::safety
