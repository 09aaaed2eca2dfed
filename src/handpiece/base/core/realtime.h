// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Marks functions that run inside the tick: they never allocate, lock, wait, throw, log or touch a file.

#if defined(__clang__) && __clang_major__ >= 20
#define HANDPIECE_REALTIME [[clang::nonblocking]]
#else
/// No compiler of Debian 12 checks it; tests/support/realtime_trap does, at run time.
#define HANDPIECE_REALTIME
#endif
