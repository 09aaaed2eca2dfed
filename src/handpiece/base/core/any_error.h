// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The last catch of a program or a thread: whatever was thrown, told as an Error is.

#include <exception>

#include "handpiece/base/core/error.h"

namespace handpiece::core {

/// An Error as it is; of the system's files what, where and what to do; memory that ended; else what is an error of the
/// program itself, with its own words.
[[nodiscard]] Error asError(const std::exception& exception);

}  // namespace handpiece::core
