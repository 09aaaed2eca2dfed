// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A gamepad through SDL 2: sticks move and turn the hand, triggers are pedal and depth, and it shakes with the force.
/// Never tried on hardware: docs/devices/gamepad.md.

#include <memory>

#include "handpiece/devices/drivers/catalogue.h"

namespace handpiece::drivers {

[[nodiscard]] Found lookGamepad();
/// `which` is a part of its name or "#2" for the second one; empty: the first. A pad that is unplugged and plugged in
/// again goes on. Throws core::Error.
[[nodiscard]] std::unique_ptr<link::Driver> openGamepad(const OpenOptions& options);

}  // namespace handpiece::drivers
