// SPDX-License-Identifier: Apache-2.0
// Log-ins that somebody else vouches for: a proxy that speaks OpenID Connect, a learning platform (LTI 1.3).
#include <fmt/format.h>

#include <algorithm>
#include <mutex>

#include "handpiece/app/report/report_html.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"
#include "handpiece/school/people/secret.h"
#include "school/answers.h"
#include "school/lti.h"
#include "school/routes.h"

namespace handpiece::school_server {
namespace {

using config::words;
using httplib::Request;
using httplib::Response;

constexpr const char* kLaunchCookie = "handpiece-lti";

/// What leaves a trace whoever asks: not as fast as they ask.
void noteRefusal(Service& of, const std::string& what, const std::string& from, const std::string& why) {
    {
        const std::lock_guard lock(of.guessing);
        const school::Milliseconds now = of.clock();
        const bool waits = of.throttle.waitMs(what + from, now) > 0;
        of.throttle.failed(what + from, now);
        if (waits) return;
    }
    of.books.take()->note({"server", of.clock()}, what, "", fmt::format("{}: {}", from, why));
}

/// The cookie of a log-in is not sent in the wake of a form that came from elsewhere: a page of ours stands in between.
Page welcome(Service& of, const school::Person& person, const std::string& to, const char* how) {
    const std::string token = school::newSecret();
    const school::Milliseconds now = of.clock();
    auto open = of.books.take();
    open->addLogin(token, person.code, now + kLoginMs, {person.code, now});
    open->note({person.code, now}, "logged in by", person.code, how);
    report::HtmlReport page(words()("school.title"));
    page.paragraph(words()("school-exam.welcome", person.name.empty() ? person.code : person.name));
    page.link(to, words()("school-exam.go-on"));
    return Page{200, page.text(), {}, token};
}

void signOn(Service& of, const Request& request, Response& response) {
    const SignOn& settings = of.settings.signOn;
    const std::string said = request.get_header_value(settings.header.c_str());
    const bool isProxy =
        std::find(settings.proxies.begin(), settings.proxies.end(), request.remote_addr) != settings.proxies.end();
    const bool knowsSecret =
        !settings.secret.empty() && school::isSameSecret(school::sha256(request.get_header_value("X-Handpiece-Secret")),
                                                         school::sha256(settings.secret));
    // Of two headers one was a browser's, which the proxy let through.
    const bool isOnce = request.get_header_value_count(settings.header.c_str()) == 1 &&
                        request.get_header_value_count("X-Handpiece-Secret") == 1;
    if (!isProxy || !knowsSecret || !isOnce || said.empty() || said.size() > 200) {
        if (!said.empty())
            noteRefusal(of, "sign-on refused", request.remote_addr,
                        !isProxy       ? "no proxy of ours"
                        : !knowsSecret ? "without the proxy's secret"
                        : !isOnce      ? "two headers of one name"
                                       : "no name");
        return answer(response, refused(words()("school-exam.no-sign-on"), 403), isSecure(request, of.settings));
    }
    std::optional<school::Person> person;
    {
        auto open = of.books.take();
        person = school::LtiBooks(*open).personByExternal(said);
        if (!person) person = open->personByLogin(said);
    }
    if (!person) {
        noteRefusal(of, "sign-on refused", request.remote_addr, "nobody here has this name");
        return answer(response, refused(words()("school-exam.unknown-here"), 403), isSecure(request, of.settings));
    }
    answer(response, welcome(of, *person, "/classes", "single sign-on"), isSecure(request, of.settings));
}

bool isSecureAddress(const Request& request, const Service& of) {
    return isSecure(request, of.settings) || of.settings.address.starts_with("https://");
}

void refuseLaunch(Service& of, const Request& request, Response& response, const core::Error& e) {
    noteRefusal(of, "launch refused", request.remote_addr, e.id() + " " + e.problem().substr(0, 200));
    const int status = e.id() == "platform-silent" ? 502 : 403;
    answer(response, refused(e.problem() + ": " + e.remedy(), status), isSecure(request, of.settings));
}

void beginHere(Service& of, const Request& request, Response& response) {
    if (of.settings.address.empty())
        return answer(response, refused(words()("school-exam.no-address"), 404), isSecure(request, of.settings));
    try {
        auto open = of.books.take();
        const Beginning beginning =
            beginLaunch(*open, of.launchKey, request.get_param_value("iss"), request.get_param_value("client_id"),
                        request.get_param_value("login_hint").substr(0, 1000),
                        request.get_param_value("lti_message_hint").substr(0, 4000), of.settings.address, of.clock());
        answer(response, Page{303, {}, beginning.to}, isSecure(request, of.settings));
        // It comes back by a form of the platform's: only a cookie that says None comes along.
        response.set_header("Set-Cookie",
                            fmt::format("{}={}; Path=/lti; HttpOnly; Max-Age=600{}", kLaunchCookie, beginning.cookie,
                                        isSecureAddress(request, of) ? "; Secure; SameSite=None" : ""));
    } catch (const core::Error& e) {
        if (e.id() != "platform-unknown") throw;
        refuseLaunch(of, request, response, e);
    }
}

void launchHere(Service& of, const Request& request, Response& response) {
    try {
        std::optional<Launch> launch;
        {
            auto open = of.books.take();
            launch = takeLaunch(*open, of.launchKey, request.get_param_value("id_token"),
                                request.get_param_value("state"), secretInCookie(request, kLaunchCookie), of.clock());
        }
        answer(response, welcome(of, launch->person, launch->to, "LTI 1.3"), isSecureAddress(request, of));
    } catch (const core::Error& e) {
        const std::string& id = e.id();
        if (!id.starts_with("launch-") && !id.starts_with("token-") && !id.starts_with("platform-")) throw;
        refuseLaunch(of, request, response, e);
    }
}

}  // namespace

std::vector<Entry> signOnRoutes(Service* of) {
    const auto on = [of](void (*work)(Service&, const Request&, Response&)) {
        return Handler([of, work](const Request& request, Response& response) { work(*of, request, response); });
    };
    return {
        {"GET", "/sign-on", on(signOn)},
        {"GET", "/lti/login", on(beginHere)},
        {"POST", "/lti/login", on(beginHere)},
        {"POST", "/lti/launch", on(launchHere)},
        {"GET", "/lti/jwks", Handler([of](const Request&, Response& response) {
             response.set_content(RsaKey(of->settings.data / "lti.pem").keySet(), "application/json");
         })},
    };
}

}  // namespace handpiece::school_server
