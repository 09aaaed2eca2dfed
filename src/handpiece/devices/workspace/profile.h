// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What was set and measured for one device, kept in one file a device: docs/formats/device-profile.md.

#include <filesystem>
#include <optional>
#include <string>

#include "handpiece/devices/workspace/placing.h"
#include "handpiece/tick/stability/shaper.h"

namespace handpiece::workspace {

struct Profile {
    std::string driver, model, serial;  ///< the device it is of
    Placing placing;
    stability::ShaperSettings shaping;
    /// At most this share of the device's own limits; what was found stable for this unit.
    double forceShare = 1.0, stiffnessShare = 1.0;
};

/// Where profiles lie: $XDG_CONFIG_HOME/handpiece/devices (or ~/.config/...).
[[nodiscard]] std::filesystem::path profileFolder();
/// Reads a TOML file; unknown keys, a device other than `info` and values out of range are core::Errors
/// ("profile-of-another-device").
[[nodiscard]] Profile readProfile(const std::filesystem::path& file, const link::DriverInfo& info);
/// The profile of this device, or what fits its model where there is none yet.
[[nodiscard]] Profile profileFor(const link::DriverInfo& info, const std::filesystem::path& folder);
/// Written beside its place and renamed.
void writeProfile(const std::filesystem::path& folder, const Profile& profile);

}  // namespace handpiece::workspace
