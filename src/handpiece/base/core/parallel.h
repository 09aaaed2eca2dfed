// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The one way to use several cores for speed. TBB stands behind it, in parallel.cpp alone.

#include <cstddef>
#include <functional>

namespace handpiece::core {

/// Calls body(begin, end) on disjoint pieces that cover [0, count), on up to threadCount() threads.
///
/// Bodies must not depend on how the range is cut: results are the same at any thread count.
/// The first exception is rethrown. Never called from the tick.
void parallelFor(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body);

/// Threads parallelFor may use; at least 1.
[[nodiscard]] std::size_t threadCount();

/// Limits parallelFor to `threads` for the rest of the process; 0 restores the default. For tests and the command line.
void setThreadCount(std::size_t threads);

}  // namespace handpiece::core
