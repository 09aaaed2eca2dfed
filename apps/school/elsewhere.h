// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Requests to other systems: https, or this very machine; no redirects; 256 KB of answer.

#include <string>
#include <utility>
#include <vector>

namespace handpiece::school_server {

struct Elsewhere {
    int status = 0;
    std::string body{};
};
/// Throw core::Error "platform-silent" (why) and "platform-address".
[[nodiscard]] Elsewhere fetch(const std::string& address);
[[nodiscard]] Elsewhere post(const std::string& address, const std::string& body, const char* type,
                             const std::vector<std::pair<std::string, std::string>>& headers = {});
/// Throws core::Error "platform-address" for what is not called.
void requireAddress(const std::string& address);
/// In small letters, without its port; empty: nothing that is called.
[[nodiscard]] std::string hostOf(const std::string& address);

}  // namespace handpiece::school_server
