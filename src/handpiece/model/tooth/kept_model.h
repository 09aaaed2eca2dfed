// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Whether a tooth opens at once.

#include "handpiece/model/tooth/tooth_model.h"

namespace handpiece::tooth {

/// Whether loadModel() would reopen it: the distances are kept somewhere, which are most of the work.
[[nodiscard]] bool isKept(const cases::Case& toothCase, const LoadSettings& settings);

}  // namespace handpiece::tooth
