// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Between a driver and whoever owns it: passes all on both ways. What derives from it and needs members in exchange()
/// stops the driver before they go.

#include <memory>
#include <utility>

#include "handpiece/devices/link/driver.h"

namespace handpiece::link {

class PassingDriver : public Driver, public Servo {
  public:
    [[nodiscard]] const DriverInfo& info() const noexcept override { return driver_->info(); }
    void start(Servo& servo) override {
        servo_ = &servo;
        driver_->start(*this);
    }
    void stop() noexcept override { driver_->stop(); }
    void relax() noexcept override { driver_->relax(); }
    [[nodiscard]] CalibrationState calibration() override { return driver_->calibration(); }
    [[nodiscard]] std::string calibrationStep() override { return driver_->calibrationStep(); }
    bool calibrate() override { return driver_->calibrate(); }
    [[nodiscard]] DriverCommand exchange(const DriverReading& reading) noexcept HANDPIECE_REALTIME override {
        return servo_->exchange(reading);
    }

  protected:
    explicit PassingDriver(std::unique_ptr<Driver> driver) : driver_(std::move(driver)) {}

  private:
    std::unique_ptr<Driver> driver_;
    Servo* servo_ = nullptr;
};

}  // namespace handpiece::link
