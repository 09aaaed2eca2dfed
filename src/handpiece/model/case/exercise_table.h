// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// `[exercise]` as a table, for files that have one beside other things.

#include "handpiece/base/config/table.h"
#include "handpiece/model/case/exercise.h"

namespace handpiece::cases {

/// Throws core::Error with file and line.
[[nodiscard]] Exercise readExercise(const config::Table& exercise);

}  // namespace handpiece::cases
