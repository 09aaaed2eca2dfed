// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Novint's Falcon: through Force Dimension's library where that is installed, else over its own cable by libusb.

#include <cstdint>
#include <memory>
#include <string>

#include "handpiece/devices/drivers/catalogue.h"

namespace handpiece::drivers {

[[nodiscard]] Found lookFalcon();
/// Through the library when it is there and sees a Falcon, else directly.
[[nodiscard]] std::unique_ptr<link::Driver> openFalcon(const OpenOptions& options);
/// Over libusb. Its firmware is its maker's: the device has it loaded, or HANDPIECE_FALCON_FIRMWARE names a file of the
/// user's; else core::Error "firmware-missing". `which`: serial number, or a number from 1.
[[nodiscard]] std::unique_ptr<link::Driver> openFalconDirectly(const OpenOptions& options);

/// What a DriverReading::vendorCode means: libusb's below zero, the library's above.
[[nodiscard]] std::string falconErrorInWords(std::int32_t code);

}  // namespace handpiece::drivers
