// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Memory that a stage of long work leaves behind.

namespace handpiece::core {

/// Gives freed memory back to the system. The allocator keeps what was freed in small pieces, some hundred megabytes
/// after a fine scan, and the next stage would come on top of it. Off the tick; milliseconds.
void giveBackFreeMemory() noexcept;

}  // namespace handpiece::core
