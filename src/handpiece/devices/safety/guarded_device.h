// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A vendor's device as the tick sees it. The only way from a Driver to a Device: so no force passes the gate by.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "handpiece/devices/link/driver.h"
#include "handpiece/devices/safety/gate.h"
#include "handpiece/devices/workspace/workspace_mapping.h"
#include "handpiece/tick/device/device.h"
#include "handpiece/tick/stability/shaper.h"

namespace handpiece::safety {

struct GuardSettings {
    GateSettings gate;  ///< held to the driver's own record and servo: it can be stricter, never wider
    workspace::WorkspaceMapping placing;
    stability::ShaperSettings shaping;
    /// What the arm may be used for, where that is less than its driver's record says (a profile's shares).
    std::optional<device::Capability> atTheHand;
    double readingTimeoutS = 0.02;  ///< the tick calls an older reading lost
    int clutchButton = 2;           ///< bit of the button that is the clutch; below 0: none
    bool upperButtonCuts = true;    ///< when the device has no pedal of its own
    // Virtual time, for drivers::SimulatedDriver: its clock, and what lets its servo run on at the beginning of each
    // read(). There is no watchdog thread then: read() does its look.
    std::function<std::int64_t()> nowNs;  ///< empty: rt::monotonicNs
    std::function<void(double periodS)> advance;
};

/// How it stands, for other threads than tick and servo. Plain.
struct Health {
    GateStatus gate;
    stability::ShaperStatus shaping;
    std::uint64_t frames = 0;            ///< of the device's servo
    double servoHz = 0.0;                ///< over the last second
    std::array<double, 3> positionMm{};  ///< of the stylus, device frame
    std::array<double, 4> orientation{1, 0, 0, 0};
    std::uint32_t buttons = 0;
    std::array<double, 3> sentN{};  ///< last force that went to the device, device frame
    bool clutched = false;
    std::uint64_t relaxed = 0;  ///< how often the watchdog found the servo standing and had the motors switched off
};

/// Shared by the device, which writes, and one listener, who reads. Made before the device.
class HealthBoard;

/// Reads the driver's latest frame, places it, hands the tick's force through shaper, link and gate. read() and
/// command() belong to the tick; the driver's thread runs beside it and the two meet in triple buffers only. Between
/// two loops nothing may call them for as long as it likes: the gate holds the force at zero and fades in when they go
/// on.
///
/// A third thread, the watchdog, looks at the driver's: when no frame has come for the gate's reading timeout it has
/// the motors switched off (Driver::relax).
///
/// **Clutch.** Honoured only while the bur is free: no force wanted for 50 ms and the pedal up. While it is held the
/// bur's tip stands still and turns with the hand, the pedal is up and the force is zero; afterwards the force fades
/// in.
class GuardedDevice final : public device::Device {
  public:
    /// Starts the driver. Throws core::Error as Driver::start does, and for settings out of range. The capability is
    /// that at the bur.
    GuardedDevice(std::unique_ptr<link::Driver> driver, const GuardSettings& settings);
    ~GuardedDevice() override;  ///< stops the driver first

    [[nodiscard]] const device::Capability& capability() const noexcept override;
    device::Reading read(double periodS) noexcept HANDPIECE_REALTIME override;
    void command(const core::Vec3& forceN, const core::Vec3& torqueNmm) noexcept HANDPIECE_REALTIME override;
    core::Vec3 truePositionMm() const noexcept override;
    core::Vec3 appliedForceN() const noexcept override;  ///< what the gate let through last, tooth frame

    [[nodiscard]] const link::DriverInfo& info() const noexcept;
    // The driver's own, for one thread that is not the tick's, any time.
    [[nodiscard]] link::CalibrationState calibration();
    [[nodiscard]] std::string calibrationStep();
    bool calibrate();
    /// Outlives the device; one reader besides the device's own.
    [[nodiscard]] std::shared_ptr<HealthBoard> health() const noexcept;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

class HealthBoard {
  public:
    virtual ~HealthBoard() = default;
    /// The latest; one reader thread.
    [[nodiscard]] virtual Health read() noexcept = 0;
    /// Takes effect at the tick's next read; from one thread that is not the tick's. The bur keeps still until it is
    /// clear of the tooth, as after any doubt. Throws core::Error for values out of range, and ("scale-at-start") for a
    /// scale below that at the start: the loop's limits are those of the start.
    virtual void place(const workspace::WorkspaceMapping& placing) = 0;
    /// Throws core::Error for values out of range.
    virtual void shape(const stability::ShaperSettings& settings) = 0;
};

}  // namespace handpiece::safety
