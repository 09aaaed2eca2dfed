// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Force Dimension's arms (omega, delta, sigma, lambda) and whatever else speaks through their closed library DHD.

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "handpiece/devices/drivers/catalogue.h"

namespace handpiece::drivers {

[[nodiscard]] Found lookForceDimension();
/// `which`: a serial number, a model ("omega.6"), or a number from 1 in the order in which the library lists them; the
/// first that is free when empty.
[[nodiscard]] std::unique_ptr<link::Driver> openForceDimension(const OpenOptions& options);

/// A Falcon through the same library; told as driver "falcon". Throws core::Error like openForceDimension().
[[nodiscard]] std::unique_ptr<link::Driver> openFalconThroughDhd(const OpenOptions& options);

/// What a DriverReading::vendorCode of these drivers means, and what to do; two sentences.
[[nodiscard]] std::string dhdErrorInWords(std::int32_t code);

/// Between DHD's frame (metre; +x to the user, +y right, +z up) and the device frame (millimetre; +x right, +y up,
/// +z to the user).
[[nodiscard]] std::array<double, 3> positionFromDhd(const std::array<double, 3>& metres) noexcept;
[[nodiscard]] std::array<double, 3> vectorToDhd(const std::array<double, 3>& deviceFrame) noexcept;
/// Columns of `frame` are the handle's axes in DHD's base frame. The handle's own +x (to the user when it is level) is
/// the stylus' tail. Quaternion w x y z; false when `frame` is no rotation.
[[nodiscard]] bool orientationFromDhd(const double (&frame)[3][3], std::array<double, 4>& orientation) noexcept;

}  // namespace handpiece::drivers
