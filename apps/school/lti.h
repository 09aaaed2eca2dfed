// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A learning platform's people come by LTI 1.3, and their grades go back (Assignment and Grade Services). No routes
/// here. docs/school-lti.md.

#include <functional>
#include <string>

#include "handpiece/school/store/lti_books.h"
#include "school/jwt.h"

namespace handpiece::school_server {

/// What a launch says, believed.
struct Launch {
    school::Person person;
    std::string to;  ///< where in this server: "/classes/ID" of the assignment that it names, else "/classes"
};
/// The first step: where the browser goes next, at the platform, with a state that `key` seals, which is a secret of
/// this server's; `cookie` is kept by the browser. Nothing of it is kept here, so that nobody can fill the books before
/// a platform has vouched for them. Throws core::Error "platform-unknown".
struct Beginning {
    std::string to, state, cookie;
};
[[nodiscard]] Beginning beginLaunch(school::Books& books, const std::string& key, const std::string& issuer,
                                    const std::string& client, const std::string& hint, const std::string& messageHint,
                                    const std::string& ownAddress, school::Milliseconds now);
/// The second: a token that came with the state of a first step, in the same browser (`cookie`). Throws core::Error:
/// "launch-state" (not begun here, too old, used before, another browser's), "token-...", "launch-claim" (which),
/// "launch-person" (nobody here is known by what it says), "platform-silent". A line item that is not where the
/// platform is gets no grades, and stands in the audit.
[[nodiscard]] Launch takeLaunch(school::Books& books, const std::string& key, const std::string& token,
                                const std::string& state, const std::string& cookie, school::Milliseconds now);

/// Grades that are confirmed by now wait to go; returns how many came to it.
std::size_t queueGrades(school::Books& books, school::Milliseconds now);
/// Sends what may go, one after the other; what fails waits longer each time, up to six hours. Returns how many went.
std::size_t sendGrades(school::Books& books, const RsaKey& key, const std::function<school::Milliseconds()>& clock);

}  // namespace handpiece::school_server
