// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// An arm in a hand that a test leads: a driver with a thread of its own, whose stylus goes where it is told, however
/// late anything is.

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <thread>

#include "handpiece/base/rt/clock.h"
#include "handpiece/devices/link/driver.h"

namespace handpiece::desktop {

/// Between test and driver; outlives the drivers, so that one that was unplugged is found again.
struct Led {
    std::mutex mutex;
    std::array<double, 3> toMm{0.0, 60.0, 0.0}, atMm{0.0, 60.0, 0.0};
    std::array<double, 4> orientation{1, 0, 0, 0};
    std::atomic<std::uint32_t> buttons{0};
    std::atomic<bool> unplugged{false}, silent{false};
    std::atomic<int> opened{0}, open{0}, calibrations{0};
    std::atomic<bool> wantsCalibration{false};
    std::atomic<double> largestSentN{0.0};

    [[nodiscard]] bool hasCome() {
        const std::lock_guard lock(mutex);
        return std::hypot(toMm[0] - atMm[0], toMm[1] - atMm[1], toMm[2] - atMm[2]) < 1e-9;
    }
    void lead(const std::array<double, 3>& mm) {
        const std::lock_guard lock(mutex);
        toMm = mm;
    }
};

class LedDriver final : public link::Driver {
  public:
    explicit LedDriver(std::shared_ptr<Led> led) : led_(std::move(led)) {
        info_.driver = "openhaptics";
        info_.model = "Led Arm";
        info_.serial = "7";
        info_.capability.name = info_.model;
        info_.capability.maxForceN = 3.0;
        info_.servoHz = 1000.0;
        ++led_->opened;
        ++led_->open;
    }
    ~LedDriver() override {
        stop();
        --led_->open;
    }
    [[nodiscard]] const link::DriverInfo& info() const noexcept override { return info_; }
    void start(link::Servo& servo) override {
        thread_ = std::thread([this, &servo] { run(servo); });
    }
    void stop() noexcept override {
        ended_ = true;
        if (thread_.joinable()) thread_.join();
    }
    [[nodiscard]] link::CalibrationState calibration() override {
        return led_->wantsCalibration ? link::CalibrationState::wantedByHand : link::CalibrationState::good;
    }
    [[nodiscard]] std::string calibrationStep() override { return "Put the stylus into the inkwell."; }
    bool calibrate() override {
        ++led_->calibrations;
        led_->wantsCalibration = false;
        return true;
    }

  private:
    static constexpr double kStepMm = 0.03;

    void run(link::Servo& servo) {
        link::DriverReading reading;
        while (!ended_) {
            {
                const std::lock_guard lock(led_->mutex);
                double awayMm = 0.0;
                for (std::size_t i = 0; i < 3; ++i)
                    awayMm = std::hypot(awayMm, led_->toMm[i] - led_->atMm[i]);
                for (std::size_t i = 0; i < 3 && awayMm > 0.0; ++i)
                    led_->atMm[i] += std::min(1.0, kStepMm / awayMm) * (led_->toMm[i] - led_->atMm[i]);
                reading.positionMm = led_->atMm;
                reading.orientation = led_->orientation;
            }
            if (led_->silent) {
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
                continue;
            }
            reading.timeNs = rt::monotonicNs();
            ++reading.frame;
            reading.buttons = led_->buttons;
            reading.motorTemperature = 0.25f;
            reading.trouble = led_->unplugged ? link::DeviceFault::unplugged : link::DeviceFault::none;
            const link::DriverCommand command = servo.exchange(reading);
            const double sentN = std::hypot(command.forceN[0], command.forceN[1], command.forceN[2]);
            led_->largestSentN = std::max(led_->largestSentN.load(), sentN);
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }

    std::shared_ptr<Led> led_;
    link::DriverInfo info_;
    std::atomic<bool> ended_{false};
    std::thread thread_;
};

}  // namespace handpiece::desktop
