// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Text in a table for other programs.

#include <string>

namespace handpiece::core {

/// As one cell of a CSV: quoted where it must be (also where a program takes the semicolon for the comma), and nothing
/// but a number that a table would take for a formula.
[[nodiscard]] std::string csvCell(std::string text);

}  // namespace handpiece::core
