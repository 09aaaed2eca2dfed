// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What an administrator sees and changes in a browser: people, classes, stations, the audit.

#include <functional>
#include <string>
#include <vector>

#include "school/pages.h"

namespace handpiece::school_server {

/// What was sent in a form; fields that were not are empty.
using Sent = std::function<std::string(const char*)>;

[[nodiscard]] Page peoplePage(const Visit& visit, const std::string& find, const std::string& wrong = {});
[[nodiscard]] Page addPerson(const Visit& visit, const Sent& sent);
/// `file`: its bytes as they came.
[[nodiscard]] Page importList(const Visit& visit, const Sent& sent, const std::string& fileName,
                              const std::string& file);
[[nodiscard]] Page accountPage(const Visit& visit, const std::string& code, const std::string& shown = {},
                               const std::string& wrong = {});
/// `what`: "name", "roles", "code", "suspend", "resume", "enrol", "leave", "erase".
[[nodiscard]] Page changeAccount(const Visit& visit, const std::string& code, const std::string& what, const Sent& sent,
                                 const std::string& address);
/// A file; also for oneself.
[[nodiscard]] Page exportPage(const Visit& visit, const std::string& code);
[[nodiscard]] Page officeClassesPage(const Visit& visit, const std::string& wrong = {});
/// A new one; or one is closed, or somebody put into it or taken out.
[[nodiscard]] Page addClass(const Visit& visit, const Sent& sent);
[[nodiscard]] Page officeClassPage(const Visit& visit, const std::string& id, const std::string& wrong = {});
[[nodiscard]] Page changeClass(const Visit& visit, const std::string& id, const std::string& what, const Sent& sent);
[[nodiscard]] Page stationsPage(const Visit& visit, const std::string& shown = {});
[[nodiscard]] Page addStationCode(const Visit& visit, const Sent& sent);
[[nodiscard]] Page releaseStation(const Visit& visit, const std::string& id);
[[nodiscard]] Page revokeStation(const Visit& visit, const std::string& id);
/// Of oneself unless one may see all.
[[nodiscard]] Page auditPage(const Visit& visit, const std::string& before, const std::string& about);
[[nodiscard]] Page ownAccountPage(const Visit& visit, const std::string& shown = {}, const std::string& wrong = {});
/// A code for a computer of one's own; and such a computer's end.
[[nodiscard]] Page addOwnStation(const Visit& visit, const Sent& sent);
[[nodiscard]] Page revokeOwnStation(const Visit& visit, const std::string& station);
/// `isTheirs` is called when the old password was right.
[[nodiscard]] Page setOwnPassword(const Visit& visit, const Sent& sent, const std::function<void()>& isTheirs);

}  // namespace handpiece::school_server
