// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What every program with commands does alike: usage, version, language, errors, exit codes.

#include <functional>
#include <string>

#include "cli/command.h"

namespace handpiece::cli {

struct App {
    std::string name, what;
    std::function<void(Command&)> addCommands;
    std::function<void()> begin{};  ///< before the command line is read; what it throws is told as an error
};

/// Runs one command. Returns the exit code: 0 done, 1 failed, 2 wrong usage. Messages go to stderr, results to stdout.
int runApp(int argc, const char* const* argv, const App& of);

}  // namespace handpiece::cli
