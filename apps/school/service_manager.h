// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A program that runs until it is told to end, and the one that started it and waits until it is ready, if one does.

#include <atomic>

namespace handpiece::school_cli {

/// "READY=1", "STOPPING=1": sd_notify(3).
void tellManager(const char* state);

/// SIGTERM ends waitForEnd() from here on.
void listenForEnd();
/// Until Ctrl-C, SIGTERM, or `ended`.
void waitForEnd(const std::atomic<bool>& ended);

}  // namespace handpiece::school_cli
