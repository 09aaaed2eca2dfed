// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Capability records of known devices, by name. docs/physics.md#device says where each figure comes from.

#include <string_view>
#include <vector>

#include "handpiece/tick/device/device.h"

namespace handpiece::device {

/// The records there are: "simulated" (the reference arm), "omni", "touch", "touch-x".
[[nodiscard]] const std::vector<Capability>& knownDevices();
/// Throws core::Error naming the devices there are.
[[nodiscard]] const Capability& capabilityByName(std::string_view name);
/// Throws core::Error when a limit is not a finite number above zero (torque, damping and encoder step may be zero).
void validate(const Capability& capability);

}  // namespace handpiece::device
