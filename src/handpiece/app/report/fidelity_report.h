// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How good a station feels, as one page to print.

#include <string>

#include "handpiece/devices/fidelity/fidelity.h"

namespace handpiece::report {

/// In the program's language; nothing loaded from elsewhere.
[[nodiscard]] std::string fidelityReport(const fidelity::Report& report);

}  // namespace handpiece::report
