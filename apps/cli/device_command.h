// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the commands under `device` share.

#include <string>

#include "cli/command.h"
#include "cli/run_device.h"

namespace handpiece::cli {

void addDeviceCalibrateCommand(Command& device);

/// The device meant when none is named: the school's, else the first one there is that pushes, else the simulated arm.
[[nodiscard]] std::string deviceMeant();

}  // namespace handpiece::cli
