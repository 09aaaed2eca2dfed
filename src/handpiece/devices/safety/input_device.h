// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What cannot push (SpaceMouse, gamepad) as the tick sees it: it steers the simulated hand of the pointer. And a foot
/// pedal beside any device.

#include <functional>
#include <memory>

#include "handpiece/devices/link/driver.h"
#include "handpiece/devices/link/pedal_value.h"
#include "handpiece/devices/safety/guarded_device.h"
#include "handpiece/devices/workspace/workspace_mapping.h"
#include "handpiece/tick/device/device.h"
#include "handpiece/tick/device/pointer_device.h"

namespace handpiece::safety {

struct InputSettings {
    workspace::WorkspaceMapping placing;
    device::PointerHandSettings hand;     ///< its dead man's lift, too
    double readingTimeoutS = 0.1;         ///< an older reading is none; inputs come 250 times a second
    int clutchButton = 2;                 ///< bit of the button that is the clutch; below 0: none
    bool upperButtonCuts = true;          ///< when the device has no pedal of its own; not while the lower one is held
    double shakesFullyN = 2.0;            ///< force that shakes as hard as the device can
    double humsFullyN = 0.5;              ///< and cutting vibration that does
    std::function<std::int64_t()> nowNs;  ///< empty: rt::monotonicNs
};

/// The driver's thread writes readings, the tick reads the latest, both through triple buffers. The driver's pose is
/// where the hand wants to be; the simulated hand gives way to the tooth, and the force shakes the device.
///
/// **Dead man.** In any doubt about the input the pedal is up and the bur is lifted along its axis. Afterwards the
/// pedal counts again once it has been let go.
class InputDevice final : public device::Device {
  public:
    /// Starts the driver. Throws core::Error as Driver::start does, for a driver that pushes (GuardedDevice is for
    /// those), and for settings out of range. The capability is that of the pointer's hand.
    InputDevice(std::unique_ptr<link::Driver> driver, const InputSettings& settings);
    ~InputDevice() override;  ///< stops the driver first

    [[nodiscard]] const device::Capability& capability() const noexcept override;
    device::Reading read(double periodS) noexcept HANDPIECE_REALTIME override;
    void command(const core::Vec3& forceN, const core::Vec3& torqueNmm) noexcept HANDPIECE_REALTIME override;
    void watch(const core::Vec3& tipMm, const core::Vec3& bearingN) noexcept HANDPIECE_REALTIME override;
    void vibrate(double amplitudeN) noexcept HANDPIECE_REALTIME override;
    core::Vec3 truePositionMm() const noexcept override;
    core::Vec3 appliedForceN() const noexcept override;

    [[nodiscard]] const link::DriverInfo& info() const noexcept;
    /// A foot pedal beside its own, under the same dead man. Before the first read().
    void usePedal(std::shared_ptr<const link::PedalValue> pedal) noexcept;
    /// Outlives the device; one reader besides the device's own. There is no force to shape.
    [[nodiscard]] std::shared_ptr<HealthBoard> health() const noexcept;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// `device` with a foot pedal beside its own: the one that is pressed harder counts. Throws core::Error without either.
[[nodiscard]] std::unique_ptr<device::Device> withPedal(std::unique_ptr<device::Device> device,
                                                        std::shared_ptr<const link::PedalValue> pedal);

}  // namespace handpiece::safety
