// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What was set and measured for one device, kept in one file a device: docs/formats/device-profile.md.

#include <filesystem>
#include <optional>
#include <string>

#include "handpiece/devices/workspace/workspace_mapping.h"
#include "handpiece/tick/stability/shaper.h"

namespace handpiece::workspace {

struct Profile {
    std::string driver, model, serial;  ///< the device it is of
    WorkspaceMapping placing;
    stability::ShaperSettings shaping;
    /// At most this share of the device's own limits; what was found stable for this unit.
    double forceShare = 1.0, stiffnessShare = 1.0;
    int clutchButton = 2;  ///< bit of the button that is the clutch; -1: none
};

/// What fits a device's model: the middle of its reach, limits and friction of its record.
[[nodiscard]] Profile defaultProfile(const link::DriverInfo& info);
/// What the device can do within the profile's shares, at the hand: for limits of gate, shaper and force model.
[[nodiscard]] device::Capability withinShares(const device::Capability& atTheHand, const Profile& profile);

/// Where profiles lie: $XDG_CONFIG_HOME/handpiece/devices (or ~/.config/...).
[[nodiscard]] std::filesystem::path profileFolder();
/// The device's file within a folder: driver and serial (else model), of letters, digits and - alone.
[[nodiscard]] std::filesystem::path profileFile(const std::filesystem::path& folder, const link::DriverInfo& info);
/// Reads a TOML file; unknown keys, a device other than `info` and values out of range are core::Errors
/// ("profile-of-another-device"). Limits are the device's own, whatever the file says; Placing::toothMm is the case's.
[[nodiscard]] Profile readProfile(const std::filesystem::path& file, const link::DriverInfo& info);
/// The profile of this device, or what fits its model where there is none yet.
[[nodiscard]] Profile profileFor(const link::DriverInfo& info, const std::filesystem::path& folder);
/// Written beside its place and renamed. Throws core::Error, also for values that could not be read again.
void writeProfile(const std::filesystem::path& folder, const Profile& profile);

}  // namespace handpiece::workspace
