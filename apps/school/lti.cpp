// SPDX-License-Identifier: Apache-2.0
#include "school/lti.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>

#include "handpiece/app/statements/statements.h"
#include "handpiece/base/config/outside_json.h"
#include "handpiece/base/core/error.h"
#include "handpiece/school/people/secret.h"
#include "school/elsewhere.h"
#include "school/http.h"

namespace handpiece::school_server {
namespace {

using Json = nlohmann::json;
using school::Books;
using school::LtiBooks;
using school::Milliseconds;

constexpr std::int64_t kSkewS = 120, kLongestS = 3600;
constexpr Milliseconds kBegunMs = 600'000;
constexpr const char* kClaim = "https://purl.imsglobal.org/spec/lti/claim/";
constexpr const char* kEndpoint = "https://purl.imsglobal.org/spec/lti-ags/claim/endpoint";
constexpr const char* kScoreScope = "https://purl.imsglobal.org/spec/lti-ags/scope/score";

/// Keys of platforms, asked for again after ten minutes, or where a token names one that is not known yet (once a
/// minute).
class KeySets {
  public:
    std::string of(const std::string& address, bool isStale, Milliseconds now) {
        {
            const std::lock_guard lock(mutex_);
            const auto found = sets_.find(address);
            if (found != sets_.end() && now - found->second.at < (isStale ? 60'000 : 600'000))
                return found->second.text;
        }
        const Elsewhere answer = fetch(address);
        if (answer.status != 200)
            throw core::Error(fmt::format("the platform's keys are not there: it answers {}", answer.status), address,
                              "check the address of its keys")
                .as("platform-silent", {std::to_string(answer.status)});
        const std::lock_guard lock(mutex_);
        if (sets_.size() > 100) sets_.clear();
        sets_[address] = {answer.body, now};
        return answer.body;
    }

  private:
    struct Kept {
        std::string text;
        Milliseconds at = 0;
    };
    std::mutex mutex_;
    std::map<std::string, Kept> sets_;
};
KeySets& keySets() {
    static KeySets sets;
    return sets;
}

core::Error claim(const char* which, const std::string& why) {
    return core::Error(fmt::format("the platform's launch is not accepted: {} ({})", which, why), "launch",
                       "begin anew, from the platform; if it comes again, tell who looks after it")
        .as("launch-claim", {which, why});
}

const Json& at(const Json& json, const std::string& key) {
    static const Json none;
    if (!json.is_object()) return none;
    const auto found = json.find(key);
    return found == json.end() ? none : *found;
}
std::string text(const Json& json, const std::string& key) {
    const Json& found = at(json, key);
    return found.is_string() ? found.get<std::string>() : std::string();
}
std::int64_t seconds(const Json& json, const std::string& key) {
    const Json& found = at(json, key);
    if (!found.is_number()) throw claim(key.c_str(), "it is no time");
    const double value = found.get<double>();
    if (!std::isfinite(value) || std::abs(value) > 1e11) throw claim(key.c_str(), "it is no time");
    return static_cast<std::int64_t>(value);
}

void requireClaims(const Json& c, const school::LtiPlatform& platform, const std::string& nonce, Milliseconds now) {
    const std::int64_t nowS = now / 1000;
    if (text(c, "iss") != platform.issuer) throw claim("iss", "another platform's");
    const Json& aud = at(c, "aud");
    const bool isOurs = aud.is_string()
                            ? aud.get<std::string>() == platform.client
                            : aud.is_array() && std::find(aud.begin(), aud.end(), platform.client) != aud.end();
    if (!isOurs) throw claim("aud", "not for this server");
    if (aud.is_array() && aud.size() > 1 && text(c, "azp") != platform.client)
        throw claim("azp", "not for this server");
    if (c.contains("azp") && text(c, "azp") != platform.client) throw claim("azp", "not for this server");
    const std::int64_t made = seconds(c, "iat"), ends = seconds(c, "exp");
    if (ends + kSkewS <= nowS) throw claim("exp", "it is too old");
    if (made > nowS + kSkewS) throw claim("iat", "it is of the future: see the clocks of both");
    if (made + kLongestS <= nowS) throw claim("iat", "it is too old");
    if (c.contains("nbf") && seconds(c, "nbf") > nowS + kSkewS) throw claim("nbf", "it is not valid yet");
    if (!school::isSameSecret(text(c, "nonce"), nonce)) throw claim("nonce", "another log-in's");
    const std::string base = kClaim;
    if (text(c, base + "version") != "1.3.0") throw claim("version", "1.3.0 is known here");
    if (text(c, base + "message_type") != "LtiResourceLinkRequest") throw claim("message_type", "not known here");
    const std::string deployment = text(c, base + "deployment_id");
    if (std::find(platform.deployments.begin(), platform.deployments.end(), deployment) == platform.deployments.end())
        throw claim("deployment_id", "not known here: " + deployment.substr(0, 60));
    const std::string subject = text(c, "sub");
    if (subject.empty() || subject.size() > 255) throw claim("sub", "nobody");
}

school::Person personOf(const LtiBooks& lti, const school::LtiPlatform& platform, const Json& c) {
    // The class list's id, where the platform has it (OneRoster), else its own; never another platform's.
    for (const std::string& known : {text(at(c, std::string(kClaim) + "lis"), "person_sourcedid"), text(c, "sub")})
        if (!known.empty())
            if (auto person = lti.personOn(platform, known)) return *person;
    throw core::Error("this school's books do not know who you are on that platform", "launch",
                      "ask your teacher: handpiece school lti person")
        .as("launch-person", {text(c, "sub")});
}

std::string bodyOf(const school::LtiLine& line, const school::Worth& worth) {
    const bool isGraded = worth.points && worth.maxPoints;
    Json body{{"userId", line.subject},
              {"timestamp", statements::timestamp(std::max(worth.decided, worth.came))},
              {"activityProgress", "Completed"},
              // Platforms count only what is fully graded: what no person has confirmed waits.
              {"gradingProgress", isGraded ? "FullyGraded" : "PendingManual"}};
    if (isGraded) body["scoreGiven"] = *worth.points, body["scoreMaximum"] = *worth.maxPoints;
    return body.dump();
}

std::string bearerOf(const school::LtiPlatform& platform, const RsaKey& key, Milliseconds now) {
    const std::int64_t nowS = now / 1000;
    const std::string assertion = key.signedToken(Json{
        {"iss", platform.client},
        {"sub", platform.client},
        {"aud", platform.tokenAddress},
        {"iat", nowS},
        {"exp", nowS + 300},
        {"jti", school::newId()}}.dump());
    httplib::Params form{{"grant_type", "client_credentials"},
                         {"client_assertion_type", "urn:ietf:params:oauth:client-assertion-type:jwt-bearer"},
                         {"client_assertion", assertion},
                         {"scope", kScoreScope}};
    const Elsewhere answer =
        post(platform.tokenAddress, httplib::detail::params_to_query_str(form), "application/x-www-form-urlencoded");
    const Json json = config::outsideJson<Json>(answer.body);
    const std::string token = answer.status == 200 ? text(json, "access_token") : std::string();
    if (token.empty() || token.size() > 8000 ||
        std::any_of(token.begin(), token.end(), [](char c) { return static_cast<unsigned char>(c) <= 0x20; }))
        throw core::Error(fmt::format("the platform gives no access: it answers {}", answer.status),
                          platform.tokenAddress, "see whether it knows this server's key: /lti/jwks")
            .as("platform-silent", {std::to_string(answer.status)});
    return token;
}

/// "EXPIRES.PLATFORM.SEAL": whoever comes back with it began here, in the browser that has the cookie.
std::string stateOf(const std::string& key, Milliseconds expires, const std::string& platform,
                    const std::string& cookie) {
    const std::string open = fmt::format("{}.{}", expires, platform);
    return open + "." + school::sealOf(key, fmt::format("state {} in {}", open, cookie));
}
struct Begun {
    Milliseconds expires = 0;
    std::string platform{};
};
/// None: not by this key, or in another browser.
std::optional<Begun> begunBy(const std::string& key, const std::string& state, const std::string& cookie) {
    Begun begun;
    const char* const last = state.data() + state.size();
    const auto [end, ec] = std::from_chars(state.data(), last, begun.expires);
    const std::size_t seal = state.rfind('.');
    const auto first = static_cast<std::size_t>(end - state.data());
    if (cookie.empty() || ec != std::errc() || end == last || *end != '.' || seal <= first) return {};
    begun.platform = state.substr(first + 1, seal - first - 1);
    if (!school::isSameSecret(stateOf(key, begun.expires, begun.platform, cookie), state)) return {};
    return begun;
}
std::string nonceOf(const std::string& key, const std::string& state) {
    return school::sealOf(key, "nonce of " + state);
}

/// What lets this server write grades is sent to where the platform is, as its administrator told it; a launch may name
/// any address.
bool isAt(const school::LtiPlatform& platform, const std::string& line) {
    const std::string host = hostOf(line);
    if (host.empty() || (line.starts_with("http://") && !platform.tokenAddress.starts_with("http://"))) return false;
    const auto known = {&platform.issuer, &platform.authAddress, &platform.tokenAddress, &platform.keysAddress};
    return std::any_of(known.begin(), known.end(), [&](const std::string* own) { return hostOf(*own) == host; });
}

/// .../lineitems/1?x=y -> .../lineitems/1/scores?x=y
std::string scoresAddress(const std::string& line) {
    const std::size_t end = std::min(line.find_first_of("?#"), line.size());
    return line.substr(0, end) + "/scores" + line.substr(end);
}

}  // namespace

Beginning beginLaunch(Books& books, const std::string& key, const std::string& issuer, const std::string& client,
                      const std::string& hint, const std::string& messageHint, const std::string& ownAddress,
                      Milliseconds now) {
    const LtiBooks lti(books);
    const auto platform = lti.platform(issuer, client);
    if (!platform)
        throw core::Error("this platform is not known here", issuer.substr(0, 200),
                          "its administrator gives its addresses to this school's: handpiece school lti platform")
            .as("platform-unknown", {issuer.substr(0, 200)});
    Beginning beginning{platform->authAddress, {}, school::newSecret()};
    beginning.state = stateOf(key, now + kBegunMs, platform->id, beginning.cookie);
    httplib::Params asks{
        {"scope", "openid"},  {"response_type", "id_token"},   {"response_mode", "form_post"},
        {"prompt", "none"},   {"client_id", platform->client}, {"redirect_uri", ownAddress + "/lti/launch"},
        {"login_hint", hint}, {"state", beginning.state},      {"nonce", nonceOf(key, beginning.state)}};
    if (!messageHint.empty()) asks.emplace("lti_message_hint", messageHint);
    beginning.to +=
        (beginning.to.find('?') == std::string::npos ? "?" : "&") + httplib::detail::params_to_query_str(asks);
    return beginning;
}

Launch takeLaunch(Books& books, const std::string& key, const std::string& token, const std::string& state,
                  const std::string& cookie, Milliseconds now) {
    LtiBooks lti(books);
    const auto notBegun = [](const char* why) {
        return core::Error(fmt::format("this log-in cannot be gone on with: {}", why), "launch",
                           "begin anew, from the platform, in a window of its own")
            .as("launch-state", {why});
    };
    const auto begun = begunBy(key, state, cookie);
    if (!begun) throw notBegun("it was not begun here, or in another browser");
    if (begun->expires <= now) throw notBegun("it took too long");
    const auto platform = lti.platform(begun->platform);
    if (!platform) throw notBegun("its platform is gone");
    std::string claims;
    try {
        claims = claimsOf(token, keySets().of(platform->keysAddress, false, now));
    } catch (const core::Error& e) {
        if (e.id() != "token-key" && e.id() != "token-forged") throw;
        // It may have new keys.
        claims = claimsOf(token, keySets().of(platform->keysAddress, true, now));
    }
    const Json c = config::requireOutsideJson<Json>(claims);
    requireClaims(c, *platform, nonceOf(key, state), now);
    if (!lti.isFirst(state, platform->id, begun->expires, now)) throw notBegun("it came before");
    Launch launch{personOf(lti, *platform, c), "/classes"};
    const std::string id = text(at(c, std::string(kClaim) + "custom"), "assignment");
    if (const auto assignment = id.size() <= 64 ? books.assignment(id) : std::nullopt) {
        bool isStudent = false;
        for (const school::Enrolment& one : books.enrolments(assignment->schoolClass))
            isStudent = isStudent || (one.person == launch.person.code && one.role == "student");
        launch.to = isStudent ? "/people/" + launch.person.code : "/classes/" + assignment->schoolClass;
        const Json& endpoint = at(c, kEndpoint);
        const Json& scopes = at(endpoint, "scope");
        const std::string line = text(endpoint, "lineitem");
        if (isStudent && !line.empty() && line.size() <= 1000 && scopes.is_array() &&
            std::find(scopes.begin(), scopes.end(), kScoreScope) != scopes.end()) {
            if (isAt(*platform, line))
                lti.set(school::LtiLine{id, launch.person.code, platform->id, text(c, "sub"), line});
            else
                books.note({"server", now}, "line item refused", launch.person.code,
                           fmt::format("{} is not where {} is", line.substr(0, 200), platform->issuer.substr(0, 200)));
        }
    }
    return launch;
}

std::size_t queueGrades(Books& books, Milliseconds now) {
    LtiBooks lti(books);
    std::size_t queued = 0;
    for (const school::LtiLine& line : lti.lines()) {
        const school::Worth worth = lti.worthOf(line.assignment, line.person);
        if (worth.came == 0 || worth.verdict == "void") continue;
        if (lti.queue(line, bodyOf(line, worth), now)) ++queued;
    }
    return queued;
}

std::size_t sendGrades(Books& books, const RsaKey& key, const std::function<Milliseconds()>& clock) {
    LtiBooks lti(books);
    std::map<std::string, std::string> bearers;
    std::size_t sent = 0;
    for (int most = 1000; most > 0; --most) {
        const auto grade = lti.nextGrade(clock());
        if (!grade) break;
        std::string problem;
        try {
            const auto platform = lti.platform(grade->line.platform);
            if (!platform) throw core::Error("its platform is gone");
            // Before its platform's addresses were others, or by an older version.
            if (!isAt(*platform, grade->line.address))
                throw core::Error("its line item is not where the platform is", grade->line.address.substr(0, 200),
                                  "give the platform's addresses anew: handpiece school lti platform")
                    .as("platform-address", {grade->line.address.substr(0, 200)});
            std::string& bearer = bearers[platform->id];
            if (bearer.empty()) bearer = bearerOf(*platform, key, clock());
            const Elsewhere answer =
                post(scoresAddress(grade->line.address), grade->body, "application/vnd.ims.lis.v1.score+json",
                     {{"Authorization", "Bearer " + bearer}});
            if (answer.status < 200 || answer.status > 299)
                problem = fmt::format("the platform answers {}", answer.status);
            if (answer.status == 401) bearer.clear();
        } catch (const core::Error& e) {
            problem = e.what();
        }
        if (problem.empty()) {
            lti.sent(grade->number, clock());
            ++sent;
        } else {
            constexpr Milliseconds kFirstMs = 30'000, kLongestMs = 6 * 3'600'000;
            const Milliseconds wait = std::min(kLongestMs, kFirstMs << std::min<std::int64_t>(grade->tries, 12));
            lti.failed(grade->number, problem, clock() + wait);
        }
    }
    return sent;
}

}  // namespace handpiece::school_server
