// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The program that started this one and waits until it is ready, if one does.

namespace handpiece::school_cli {

/// "READY=1", "STOPPING=1": sd_notify(3).
void tellManager(const char* state);

}  // namespace handpiece::school_cli
