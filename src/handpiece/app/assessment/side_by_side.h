// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Many pieces of work at a time, each read and measured by itself.

#include <cstddef>
#include <functional>

#include "handpiece/base/core/progress.h"

namespace handpiece::assessment {

/// `one(i, its progress)` for each of `count`, on as many threads as there are cores, `most` at most; one after the
/// other where sessions cannot be read side by side. Threads of their own: each may wait for inner work without being
/// given another's. `progress` hears the mean of all, one at a time. Throws core::Error "cancelled", and what the first
/// `one` threw, when all have ended; the others begin nothing new.
void eachSideBySide(std::size_t count, std::size_t most, const core::Progress& progress,
                    const std::function<void(std::size_t, const core::Progress&)>& one);

}  // namespace handpiece::assessment
