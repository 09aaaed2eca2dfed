// SPDX-License-Identifier: Apache-2.0
// An administrator's pages; what each does with an account of their own; a password by a one-time code.
#include <fmt/format.h>

#include <algorithm>
#include <mutex>

#include "handpiece/app/report/school_pages.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"
#include "handpiece/school/people/secret.h"
#include "handpiece/school/store/books_accounts.h"
#include "school/answers.h"
#include "school/office_pages.h"
#include "school/routes.h"

namespace handpiece::school_server {
namespace {

using config::words;
using httplib::Request;
using httplib::Response;

Sent sentOf(const Request& request) {
    return [&request](const char* name) { return sentBy(request, name); };
}

std::string firstPage(const std::string& login, const std::string& wrong, bool isDone = false) {
    const auto word = [](const char* id) { return words()(std::string("school-office.") + id); };
    report::HtmlReport page(word("first-title"));
    page.ofSite({}, {}, {});
    if (!wrong.empty()) page.paragraph(wrong, report::HtmlReport::Tone::bad);
    if (isDone) {
        page.paragraph(word("first-done"), report::HtmlReport::Tone::good);
        page.link("/login", words()("school.log-in"));
        return page.text();
    }
    page.paragraph(word("first-about"), report::HtmlReport::Tone::note);
    const auto field = [](const char* name, std::string label, const char* kind, const std::string& value,
                          const char* complete) {
        report::FormField one{name, std::move(label), kind, value};
        one.isRequired = true, one.complete = complete;
        return one;
    };
    page.form({"/first",
               {field("login", words()("school.login"), "text", login, "username"),
                field("code", word("first-code"), "text", {}, "one-time-code"),
                field("new", word("first-new"), "password", {}, "new-password"),
                field("again", word("first-again"), "password", {}, "new-password")},
               {{word("first-do")}}});
    return page.text();
}

/// As a log-in, and as slow to guess.
Page setFirstPassword(Service& of, const Request& request) {
    const std::string login = request.get_param_value("login"), fresh = request.get_param_value("new");
    const auto refusedWith = [&](int status, const std::string& why) {
        return Page{status, firstPage(login.substr(0, 200), why)};
    };
    if (fresh != request.get_param_value("again")) return refusedWith(400, words()("school-office.first-not-same"));
    try {
        school::requireGoodPassword(fresh, login);
    } catch (const core::Error& e) {
        return refusedWith(400, fmt::format("{} ({})", e.problem(), e.remedy()));
    }
    const school::Milliseconds now = of.clock();
    const std::string client = clientOf(request, of.settings);
    if (const std::int64_t wait = of.waitToGuess(client, login); wait > 0)
        return refusedWith(429, words()("school.wait", (wait + 999) / 1000));
    const auto open = of.books.take();
    const std::string code = school::typedStationCode(request.get_param_value("code").substr(0, 60));
    if (login.size() > 200 ||
        !school::BooksAccounts(*open).setPasswordByCode(login, code, school::hashOfPassword(fresh), now))
        return refusedWith(401, words()("school-office.first-wrong"));
    of.guessedRight(client, login);
    return {200, firstPage({}, {}, true)};
}

/// Whoever found a browser open must not learn the password here faster than at the door.
Page changeOwnPassword(Service& of, const Request& request, const Visit& visit) {
    const std::string client = clientOf(request, of.settings);
    if (const std::int64_t wait = of.waitToGuess(client, visit.person.login); wait > 0)
        return {429, ownAccountPage(visit, {}, words()("school.wait", (wait + 999) / 1000)).body};
    return setOwnPassword(visit, sentOf(request), [&] { of.guessedRight(client, visit.person.login); });
}

/// Where it is reached, as far as the server knows.
std::string addressOf(const Request& request, const Service& of) {
    const std::string host = request.get_header_value("Host");
    const bool isPlain =
        !host.empty() && host.size() < 200 && std::all_of(host.begin(), host.end(), [](unsigned char c) {
            return std::isalnum(c) != 0 || c == '.' || c == '-' || c == ':' || c == '[' || c == ']';
        });
    return isPlain ? fmt::format("{}://{}", isSecure(request, of.settings) ? "https" : "http", host) : std::string();
}

}  // namespace

std::vector<Entry> officeRoutes(Service* of) {
    return {
        {"GET", "/first", Handler([of](const Request& request, Response& response) {
             answer(response, Page{200, firstPage({}, {})}, isSecure(request, of->settings));
         })},
        {"POST", "/first", Handler([of](const Request& request, Response& response) {
             answer(response, setFirstPassword(*of, request), isSecure(request, of->settings));
         })},
        {"GET", "/account", Shown([](const Request&, const Visit& v) { return ownAccountPage(v); })},
        {"POST", "/account", Shown([of](const Request& r, const Visit& v) { return changeOwnPassword(*of, r, v); })},
        {"POST", "/account/stations",
         Shown([](const Request& r, const Visit& v) { return addOwnStation(v, sentOf(r)); })},
        {"POST", "/account/stations/([0-9a-f]{32})/revoke",
         Shown([](const Request& r, const Visit& v) { return revokeOwnStation(v, r.matches[1]); })},
        {"GET", "/account/export", Shown([](const Request&, const Visit& v) { return exportPage(v, v.person.code); })},
        {"GET", "/office/people",
         Shown([](const Request& r, const Visit& v) { return peoplePage(v, r.get_param_value("find")); })},
        {"POST", "/office/people", Shown([](const Request& r, const Visit& v) { return addPerson(v, sentOf(r)); })},
        {"POST", "/office/people/import", Shown([](const Request& r, const Visit& v) {
             const auto file = r.has_file("file") ? r.get_file_value("file") : httplib::MultipartFormData();
             return importList(v, sentOf(r), file.filename.empty() ? "file" : file.filename, file.content);
         })},
        {"GET", "/office/people/([0-9A-Za-z._-]{1,64})",
         Shown([](const Request& r, const Visit& v) { return accountPage(v, r.matches[1]); })},
        {"GET", "/office/people/([0-9A-Za-z._-]{1,64})/export",
         Shown([](const Request& r, const Visit& v) { return exportPage(v, r.matches[1]); })},
        {"POST", "/office/people/([0-9A-Za-z._-]{1,64})/(name|roles|code|suspend|resume|enrol|leave|erase)",
         Shown([of](const Request& r, const Visit& v) {
             return changeAccount(v, r.matches[1], r.matches[2], sentOf(r), addressOf(r, *of));
         })},
        {"GET", "/office/classes", Shown([](const Request&, const Visit& v) { return officeClassesPage(v); })},
        {"POST", "/office/classes", Shown([](const Request& r, const Visit& v) { return addClass(v, sentOf(r)); })},
        {"GET", "/office/classes/([0-9A-Za-z._-]{1,64})",
         Shown([](const Request& r, const Visit& v) { return officeClassPage(v, r.matches[1]); })},
        {"POST", "/office/classes/([0-9A-Za-z._-]{1,64})/(enrol|close)",
         Shown([](const Request& r, const Visit& v) { return changeClass(v, r.matches[1], r.matches[2], sentOf(r)); })},
        {"GET", "/office/stations", Shown([](const Request&, const Visit& v) { return stationsPage(v); })},
        {"POST", "/office/stations",
         Shown([](const Request& r, const Visit& v) { return addStationCode(v, sentOf(r)); })},
        {"POST", "/office/stations/([0-9a-f]{32})/release",
         Shown([](const Request& r, const Visit& v) { return releaseStation(v, r.matches[1]); })},
        {"POST", "/office/stations/([0-9a-f]{32})/revoke",
         Shown([](const Request& r, const Visit& v) { return revokeStation(v, r.matches[1]); })},
        {"GET", "/office/audit", Shown([](const Request& r, const Visit& v) {
             return auditPage(v, r.get_param_value("before"), r.get_param_value("about"));
         })},
    };
}

}  // namespace handpiece::school_server
