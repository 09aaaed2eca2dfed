// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// PHANToM Omni, Touch, Touch X and Premium through the HD library of OpenHaptics, loaded when it is asked for.
/// Never tried on hardware: docs/devices/openhaptics.md.

#include <cstdint>

#include "handpiece/devices/drivers/catalogue.h"

namespace handpiece::drivers {

[[nodiscard]] Found lookOpenHaptics();
/// `which`: name of a device as the vendor's set-up program calls it; empty: its default one. HANDPIECE_HD_LIBRARY is
/// the only library tried when it is set.
[[nodiscard]] std::unique_ptr<link::Driver> openOpenHaptics(const OpenOptions& options);
/// What an error code of the HD library means and what to do, in one line.
[[nodiscard]] std::string openHapticsErrorInWords(std::int32_t code);
/// The record for a model as HD names it ("Touch X"): a table, for what the library does not tell.
[[nodiscard]] device::Capability openHapticsCapability(std::string_view model);

}  // namespace handpiece::drivers
