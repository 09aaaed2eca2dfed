// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Haply Inverse3, Inverse3x and Minverse, with a VerseGrip where there is one, through Haply's own service: a
/// WebSocket on this machine (HANDPIECE_HAPLY_URL names another). Never tried on hardware: docs/devices/haply.md.

#include <cstdint>
#include <memory>
#include <string>

#include "handpiece/devices/drivers/catalogue.h"

namespace handpiece::drivers {

/// DriverReading::vendorCode of this driver: the service has flags, no codes.
inline constexpr int kHaplyNotReady = 1, kHaplyNoPower = 2;

/// One sentence; empty for a code of somebody else's.
[[nodiscard]] std::string haplyErrorInWords(std::int32_t code);

[[nodiscard]] Found lookHaply();
/// Connects and asks what is there. `which` is a device_id; empty: the first arm. Throws core::Error.
[[nodiscard]] std::unique_ptr<link::Driver> openHaply(const OpenOptions& options);

}  // namespace handpiece::drivers
