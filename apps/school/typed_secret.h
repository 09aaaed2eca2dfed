// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Passwords that somebody types, or a program writes.

#include <string>

namespace handpiece::school_cli {

/// The next line of standard input, without its end: no list of processes and no history has it. Of a terminal it is
/// asked for by `what`, and what is typed is not shown. Throws core::Error for more than 4096 bytes.
[[nodiscard]] std::string typedSecret(const char* what);
/// Of any descriptor.
[[nodiscard]] std::string typedSecret(const char* what, int from);

}  // namespace handpiece::school_cli
