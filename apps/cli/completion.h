// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Completion scripts for shells, made from the commands themselves and so always true.

#include <string>

#include "cli/command.h"

namespace handpiece::cli {

/// Adds `completion bash|zsh|fish`, which prints the script for what `app`, the program of that name, holds when it
/// runs.
void addCompletionCommand(Command& app, const std::string& program);

}  // namespace handpiece::cli
