// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What goes back over HTTP: messages, errors, pages; each with its content security policy.

#include <string>

#include "handpiece/base/core/error.h"
#include "school/http.h"
#include "school/pages.h"

namespace handpiece::school_server {

constexpr school::Milliseconds kLoginMs = 12 * 3'600'000;  // a working day

void answer(httplib::Response& response, const std::string& json, int status = 200);
void answer(httplib::Response& response, const core::Error& error);
/// A page, or the way to another. `secure`: over TLS, and the cookie never goes over anything else.
void answer(httplib::Response& response, Page&& page, bool secure);
/// Of the log-in's cookie; empty: there is none.
[[nodiscard]] std::string tokenOf(const httplib::Request& request);
/// The first of this name that is as long as school::newSecret() is; empty: there is none.
[[nodiscard]] std::string secretInCookie(const httplib::Request& request, const std::string& cookie);
/// What a form sent, whichever way it is encoded; empty: nothing.
[[nodiscard]] std::string sentBy(const httplib::Request& request, const char* name);
/// Throws core::Error "message-damaged" for what is no whole number.
[[nodiscard]] std::uint64_t numberOf(const httplib::Request& request, const char* name);

}  // namespace handpiece::school_server
