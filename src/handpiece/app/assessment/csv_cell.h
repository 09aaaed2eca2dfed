// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Text in a table for other programs.

#include <string>

namespace handpiece::assessment {

/// As one cell of a CSV: quoted where it must be, and nothing but a number that a table would take for a formula.
[[nodiscard]] std::string csvCell(std::string text);

}  // namespace handpiece::assessment
