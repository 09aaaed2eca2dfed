// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The pages of a school's server, in the program's language: what a teacher and a student see in a browser.

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/app/report/report_html.h"
#include "handpiece/school/store/books.h"

namespace handpiece::report {

/// Who looks.
struct Looker {
    std::string code, name;
    std::string requestToken;             ///< of this log-in's forms
    std::vector<HtmlReport::Way> ways{};  ///< to what they may see beside classes and their own work
};
/// Codes, and the names of those whose name one may see.
using Names = std::map<std::string, std::string>;

/// A page with its head: ways, who is logged in, *Log out*. `address`: where it stands, so that its way is marked.
[[nodiscard]] HtmlReport sitePage(std::string title, const Looker& who, std::string_view address = {});
/// Every form that changes something has it.
[[nodiscard]] FormField tokenField(const Looker& who);

/// What the school has besides passwords: a proxy's single sign-on, learning platforms.
struct OtherLogIns {
    bool signOn = false, platform = false;
};
[[nodiscard]] std::string loginPage(const std::string& login, const std::string& wrong, const OtherLogIns& others);
[[nodiscard]] std::string classesPage(const Looker& who, const std::vector<school::SchoolClass>& classes);
/// Students by their names or codes, a column an assignment: score, whether it is proven, marks; each leads to its
/// work.
/// `rooms`: what else there is of this class.
[[nodiscard]] std::string classPage(const Looker& who, const school::ClassPage& page, const Names& names,
                                    const std::vector<HtmlReport::Cell>& rooms = {});
/// All attempts of one person, the newest first.
[[nodiscard]] std::string personPage(
    const Looker& who, const std::string& person, const Names& names,
    const std::vector<std::pair<school::PushedAttempt, std::optional<school::Score>>>& work);
/// One attempt: what the server made of it, what its station said, every criterion, marks and comments; for who looks
/// into it, others' works that it is like.
[[nodiscard]] std::string attemptPage(const Looker& who, const school::PushedAttempt& attempt, const Names& names,
                                      const std::vector<school::Score>& scores, const std::vector<school::Mark>& marks,
                                      const std::vector<school::Comment>& comments,
                                      const std::vector<school::Books::Alike>& alike = {}, bool isAnybodys = false);
/// What cannot be shown, and why.
[[nodiscard]] std::string refusalPage(const std::string& what, const std::string& remedy);

/// "2026-11-18 11:19", UTC.
[[nodiscard]] std::string momentOf(school::Milliseconds since1970);

}  // namespace handpiece::report
