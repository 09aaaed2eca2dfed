// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The reference arm as a driver: device::SimulatedDevice in a servo of its own, on the wall clock or in steps.

#include <cstdint>
#include <memory>
#include <optional>

#include "handpiece/devices/drivers/catalogue.h"
#include "handpiece/devices/workspace/workspace_mapping.h"
#include "handpiece/tick/device/simulated_device.h"

namespace handpiece::drivers {

struct SimulatedSettings {
    device::SimulatedDeviceSettings arm;
    /// Of the bur in the tooth frame; empty: a slow circle above the tooth.
    std::optional<device::Motion> motion;
    /// With which the tooth frame is left for the device frame; the one of the GuardedDevice, or the motion does not
    /// arrive at the tooth as given.
    workspace::WorkspaceMapping placing;
    double servoHz = 1000.0;
    bool stepped = false;  ///< no thread and no wall clock: step() is the servo
    std::string model = "simulated arm";
};

/// One device, as the others are. On the wall clock a real-time thread of its own runs the servo (SCHED_FIFO where it
/// is granted). Stepped, in virtual time, with a GuardedDevice and a HapticLoop:
///
///     auto driver = std::make_unique<SimulatedDriver>(settings);   // settings.stepped = true
///     SimulatedDriver* servo = driver.get();                       // lives in the GuardedDevice
///     guard.nowNs = [servo] { return servo->nowNs(); };
///     guard.advance = [servo](double periodS) { servo->step(periodS); };
///     GuardedDevice device(safety::withFaults(std::move(driver), faults, log), guard);
class SimulatedDriver final : public link::Driver {
  public:
    /// Throws core::Error for figures that cannot be simulated.
    explicit SimulatedDriver(SimulatedSettings settings);
    ~SimulatedDriver() override;

    [[nodiscard]] const link::DriverInfo& info() const noexcept override;
    void start(link::Servo& servo) override;
    void stop() noexcept override;
    void relax() noexcept override;

    /// Stepped only: lets `periodS` pass and exchanges as many frames as fall into it.
    void step(double periodS) noexcept HANDPIECE_REALTIME;
    /// Virtual time when stepped, else rt::monotonicNs().
    [[nodiscard]] std::int64_t nowNs() const noexcept;
    /// What the arm pushes the hand with now, tooth frame. Stepped only.
    [[nodiscard]] core::Vec3 appliedForceN() const noexcept;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

[[nodiscard]] Found lookSimulated();
[[nodiscard]] std::unique_ptr<link::Driver> openSimulated(const OpenOptions& options);

}  // namespace handpiece::drivers
