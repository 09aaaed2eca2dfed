// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Whether there is something to do.

#include "handpiece/assess/task/task.h"

namespace handpiece::tasks {

/// Throws core::Error: the preparation does not lie on the tooth, or holds nothing of it. Up to seconds.
void requireTarget(const Task& task);

}  // namespace handpiece::tasks
