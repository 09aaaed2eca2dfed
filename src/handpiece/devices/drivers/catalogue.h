// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Which devices there can be, which are there, and how to open one.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/devices/link/driver.h"

namespace handpiece::drivers {

/// One kind of device and whether it can be had on this machine now.
struct Found {
    std::string
        driver;  ///< name for open(): "openhaptics", "forcedimension", "haply", "falcon", "spacemouse", "gamepad"
    std::string makes;   ///< for people: "3D Systems Touch, Touch X, PHANToM (OpenHaptics HD)"
    bool pushes = true;  ///< false: input only
    bool available = false;
    std::vector<std::string> models;  ///< connected, as far as can be told without moving them
    /// One that is connected: as OpenOptions::which takes it, and for people.
    struct Unit {
        std::string which, label;
    };
    std::vector<Unit> units;       ///< as far as one can be told from the other
    std::string why;               ///< when not available: one sentence
    std::string remedy;            ///< and what to do
    bool triedOnHardware = false;  ///< by us. Says so in lists and docs
};

/// Looks for all of them; loads libraries, opens nothing for longer than a look. Takes up to a second.
[[nodiscard]] std::vector<Found> look();
[[nodiscard]] const std::vector<std::string>& names();

struct OpenOptions {
    std::string which;     ///< device name or serial within the driver; empty: its default
    double servoHz = 0.0;  ///< 0: the driver's own choice
};
/// Throws core::Error: no such driver (names what there is), library missing or wrong, device busy, no permission, no
/// licence, two libraries at once: each with its remedy.
[[nodiscard]] std::unique_ptr<link::Driver> open(std::string_view driver, const OpenOptions& options = {});
/// What a vendorCode of a reading means and what to do, in one line; empty for 0.
[[nodiscard]] std::string vendorErrorInWords(std::string_view driver, std::int32_t code);

}  // namespace handpiece::drivers
