// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How late pictures come, and what it costs: a server as a process of its own, real stations' side, simulated
/// browsers.

#include <cstddef>
#include <string>

namespace handpiece::school_cli {

struct SimulatedSchool {
    std::string pictures{}, sessions{};  ///< folders: JPEG files, and sessions
    std::string database{};
    std::size_t stations = 30, browsers = 8, seconds = 60, attempts = 1;
    bool singly = false;
};
/// Prints what was measured. Throws core::Error.
void simulateSchool(const SimulatedSchool& settings);

}  // namespace handpiece::school_cli
