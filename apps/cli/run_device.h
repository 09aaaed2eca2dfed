// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A run at a device behind its gate: a person at a real one, or the simulated arm with faults on purpose.

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "cli/command.h"
#include "handpiece/app/input/device_opening.h"
#include "studies/run_job.h"

namespace handpiece::cli {

/// What decides which device is used and how; of `run` and `device` alike.
struct DeviceOptions {
    std::string name = "simulated", which, inject, profile, controller, crisp;
    double scale = 0.0;  ///< 0: the profile's
    bool leftHanded = false, pedal = false;
};
/// --device and what goes with it.
void addDeviceOptions(Command& command, DeviceOptions& options);
/// What the school says where the command line does not. Its problems are told.
void applySchoolDefaults(const Command& command, DeviceOptions& options);
/// Throws core::Error for a name that there is not, a scale, an on or off that is none.
void validate(const DeviceOptions& options);

/// The same for the desk.
[[nodiscard]] input::DeviceChoice choiceOf(const DeviceOptions& options);
/// True where a person's hand moves it: there is no motion.
[[nodiscard]] inline bool isReal(const DeviceOptions& options) {
    return options.name != "simulated";
}
/// True unless the simulated arm is used as it always was, without a gate.
[[nodiscard]] bool isGuarded(const DeviceOptions& options);

/// The device of one run. Made before the long work, so that one that is not there is told at once; opened when the
/// tooth is known; lives until its outcomes are told.
class RunDevice {
  public:
    /// Loads the library, finds the device; does not start it. Throws core::Error.
    explicit RunDevice(const DeviceOptions& options);
    ~RunDevice();
    RunDevice(const RunDevice&) = delete;
    RunDevice& operator=(const RunDevice&) = delete;

    /// Starts it for this tooth and puts it in `settings`' place of the simulated arm; `motion` is what the simulated
    /// arm does. Limits of the force become the device's own.
    void open(studies::RunSettings& settings, const device::Motion* motion, const input::ToothPlace& tooth);
    /// Tells trouble on stderr as it comes and goes. Listener's thread.
    void watch();
    /// Once the loop is gone: what the gate let through and what each fault came to.
    void add(nlohmann::ordered_json& summary) const;
    void print() const;
    [[nodiscard]] const device::Capability& capability() const;
    [[nodiscard]] const link::DriverInfo& info() const;
    [[nodiscard]] double scale() const;
    [[nodiscard]] bool leftHanded() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Seconds that a person has at a device when no duration is given.
inline constexpr double kHandS = 60.0;

}  // namespace handpiece::cli
