// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The one way from a name to a haptic device, for the command line and the window: which there are, one opened behind
/// its gate, its profile, and where a tooth lies in its reach.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/devices/drivers/catalogue.h"
#include "handpiece/devices/drivers/pedal.h"
#include "handpiece/devices/safety/guarded_device.h"
#include "handpiece/devices/safety/injector.h"
#include "handpiece/devices/workspace/profile.h"
#include "handpiece/tick/device/device.h"
#include "handpiece/tick/device/pointer_device.h"
#include "handpiece/tick/force/parameters.h"

namespace handpiece::input {

/// drivers::look(); the simulated arm, which is always there, comes last. Opens and moves nothing.
[[nodiscard]] std::vector<drivers::Found> lookForDevices();
[[nodiscard]] const std::vector<std::string>& deviceNames();

/// The tooth as far as its place in an arm's reach depends on it. cases::Case has the last two: 0 when not known.
struct ToothPlace {
    core::Box box;  ///< of its outer surface, tooth frame
    int fdiNumber = 0, buccalSign = 1;
};
/// Where a tooth lies comfortably in a device's reach: the middle of its top at `profile`'s point, occlusal up, and the
/// handle where startPose() has it when it comes from the right and the front (a left hand's from the left). What the
/// profile turns comes on top of that.
[[nodiscard]] workspace::WorkspaceMapping placingFor(const workspace::Profile& profile, const ToothPlace& tooth);
/// The turn alone: tooth axes into device axes.
[[nodiscard]] core::Quat toothTurnFor(const ToothPlace& tooth, bool leftHanded);

struct DeviceChoice {
    std::string name = "simulated";       ///< of deviceNames()
    std::string which;                    ///< device name or serial within the driver; empty: its default
    double servoHz = 0.0;                 ///< 0: the driver's own choice
    std::filesystem::path profileFolder;  ///< empty: workspace::profileFolder()
    std::filesystem::path profile;        ///< this file instead of the one of the device; empty: the device's
    bool keptProfile = true;              ///< false: what fits its model, whatever is kept in the folder
    /// Instead of the profile's.
    std::optional<double> scale, forceScale;
    std::optional<bool> leftHanded, passivityController, frictionCompensation;
    std::optional<workspace::WorkspaceMapping> placing;  ///< whole: nothing is fitted to the tooth
    std::string faults;                                  ///< safety::parseFaults(); empty: none
    bool pedal = false;  ///< a foot pedal too, where there is one: throws when there is none
    /// Instead: what somebody else's pedal says, now or later; the one that is pressed harder counts.
    std::shared_ptr<const link::PedalValue> foot;
    device::PointerHandSettings hand;  ///< of devices that do not push
    ToothPlace tooth;
    // Virtual time for drivers::SimulatedDriver, as safety::GuardSettings has it; empty: the clock on the wall.
    std::function<std::int64_t()> nowNs;
    std::function<void(double periodS)> advance;
};

/// A driver by name that was not started: for fidelity::check() and calibration. Of the simulated arm: one held still
/// (openDevice() has it draw circles above the tooth). Throws as drivers::open().
[[nodiscard]] std::unique_ptr<link::Driver> openDriver(const DeviceChoice& choice);
/// The profile that `choice` asks for, its overrides in place, without the tooth. Throws core::Error.
[[nodiscard]] workspace::Profile profileOf(const DeviceChoice& choice, const link::DriverInfo& info);

/// Calibration of a device that runs; for one thread that is not the tick's.
struct Calibration {
    std::function<link::CalibrationState()> state;
    std::function<std::string()> step;  ///< what the person does, in one sentence
    std::function<bool()> tryOnce;      ///< true when it is calibrated now
};

/// A device that runs.
struct OpenDevice {
    std::unique_ptr<device::Device> device;       ///< for the loop
    std::shared_ptr<safety::HealthBoard> health;  ///< outlives the device; one reader
    link::DriverInfo info;
    workspace::Profile profile;                  ///< with the overrides; to be changed and written again
    workspace::WorkspaceMapping placing;         ///< in use: the profile's with the tooth in it
    device::Capability capability;               ///< at the bur: the device's own
    Calibration calibration;                     ///< as long as the device lives
    std::vector<safety::Fault> faults;           ///< that will be injected
    std::shared_ptr<safety::FaultLog> faultLog;  ///< null without faults; to be read once the device is gone
    std::shared_ptr<drivers::FootPedal> pedal;   ///< null without; kept while the device is used
};
/// Throws core::Error: no such device, its driver's reasons, a bad profile, a bad --inject.
[[nodiscard]] OpenDevice openDevice(const DeviceChoice& choice);
/// The same for a driver that was made elsewhere (a simulated arm with a motion of its own).
[[nodiscard]] OpenDevice openDevice(std::unique_ptr<link::Driver> driver, const DeviceChoice& choice);

/// What the force model must know of the device: torque about its stylus where it has torque axes.
[[nodiscard]] force::Parameters fittedTo(const OpenDevice& device, force::Parameters parameters);

/// Trouble as a message for people: an id of link::idOf() ("unplugged"), its sentence, remedy, and the code in words
/// where the vendor's library told one. Nothing while all is well (or starting).
[[nodiscard]] std::optional<core::Error> troubleOf(const safety::GateStatus& status, const link::DriverInfo& device);

}  // namespace handpiece::input
