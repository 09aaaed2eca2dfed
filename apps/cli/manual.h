// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Manual pages, made from the commands themselves and so always true.

#include <string>

#include "cli/command.h"

namespace handpiece::cli {

/// Adds the hidden `manual FOLDER`, by which the build writes a page for the program and for each of its commands.
void addManualCommand(Command& app, const std::string& program);

}  // namespace handpiece::cli
