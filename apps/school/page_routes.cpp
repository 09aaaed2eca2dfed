// SPDX-License-Identifier: Apache-2.0
// Log-in, and what persons see of classes and work.
#include "handpiece/app/report/school_pages.h"
#include "handpiece/base/config/words.h"
#include "handpiece/school/people/secret.h"
#include "handpiece/school/store/books_accounts.h"
#include "handpiece/school/store/lti_books.h"
#include "school/answers.h"
#include "school/routes.h"

namespace handpiece::school_server {
namespace {

using httplib::Request;
using httplib::Response;

std::string logInPage(Service& of, const std::string& login = {}, const std::string& wrong = {}) {
    const bool hasPlatform = !of.settings.address.empty() && !school::LtiBooks(*of.books.take()).platforms().empty();
    return report::loginPage(login, wrong, {!of.settings.signOn.proxies.empty(), hasPlatform});
}

Page logIn(Service& of, const Request& request) {
    const std::string login = request.get_param_value("login"), password = request.get_param_value("password");
    const school::Milliseconds now = of.clock();
    const std::string client = clientOf(request, of.settings);
    const std::int64_t wait = of.waitToGuess(client, login);
    if (wait > 0) return {429, logInPage(of, login, config::words()("school.wait", (wait + 999) / 1000)), {}, {}};
    constexpr std::size_t kMostPassword = 256;
    // Not held while the password is worked on, which takes long.
    const auto person = login.size() <= 200 ? of.books.take()->personByLogin(login) : std::nullopt;
    bool isRight = false;
    if (password.size() <= kMostPassword) {
        if (person && !person->password.empty())
            isRight = school::isPassword(person->password, password);
        else
            school::spendPasswordTime(password);
    }
    if (!isRight) return {401, logInPage(of, login, config::words()("school.wrong-login")), {}, {}};
    of.guessedRight(client, login);
    // Made with less than is used by now: this is the one time that the password is here.
    if (school::isHashOutdated(person->password))
        school::BooksAccounts(*of.books.take())
            .renewHash(person->code, person->password, school::hashOfPassword(password));
    if (school::BooksAccounts(*of.books.take()).isSuspended(person->code))
        return {403, logInPage(of, login, config::words()("school-office.is-suspended"))};
    const std::string token = school::newSecret();
    of.books.take()->addLogin(token, person->code, now + kLoginMs, {person->code, now});
    return {303, {}, "/classes", token};
}

}  // namespace

std::vector<Entry> pageRoutes(Service* of) {
    return {
        {"GET", "/login", Handler([of](const Request& request, Response& response) {
             answer(response, Page{200, logInPage(*of), {}, {}}, isSecure(request, of->settings));
         })},
        {"POST", "/login", Handler([of](const Request& request, Response& response) {
             answer(response, logIn(*of, request), isSecure(request, of->settings));
         })},
        {"POST", "/logout", Shown([](const Request&, const Visit& visit) {
             visit.books.endLogin(visit.token);
             return Page{303, {}, "/login", std::string()};
         })},
        {"GET", "/", Shown([](const Request&, const Visit&) {
             return Page{303, {}, "/classes", {}};
         })},
        {"GET", "/classes", Shown([](const Request&, const Visit& visit) { return classesOf(visit); })},
        {"GET", "/classes/([0-9A-Za-z._-]{1,64})",
         Shown([](const Request& request, const Visit& visit) { return classOf(visit, request.matches[1]); })},
        {"GET", "/people/([0-9A-Za-z._-]{1,64})",
         Shown([](const Request& request, const Visit& visit) { return personOf(visit, request.matches[1]); })},
        {"GET", "/attempts/([0-9a-f]{32})",
         Shown([](const Request& request, const Visit& visit) { return attemptOf(visit, request.matches[1]); })},
        {"GET", "/attempts/([0-9a-f]{32})/result", Shown([of](const Request& request, const Visit& visit) {
             return resultOf(visit, request.matches[1], of->readings);
         })},
    };
}

}  // namespace handpiece::school_server
