// SPDX-License-Identifier: Apache-2.0
// Log-ins that a proxy or a learning platform vouches for, grades and statements on their way to others, against a
// platform in a process of its own with its own keys.
#include <cstdio>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "handpiece/app/statements/statements.h"
#include "handpiece/school/store/exam_books.h"
#include "handpiece/school/store/lti_books.h"
#include "handpiece/school/store/teaching.h"
#include "school/jwt.h"
#include "school/lti.h"
#include "school/server/browser.h"
#include "school/server/school_fixture.h"
#include "school/statements_push.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::school_server::elsewhere_test {
namespace {

using nlohmann::json;
using school::LtiBooks;
using school::Milliseconds;
using test::errorIdOf;
using test::errorOf;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

constexpr const char* kClaim = "https://purl.imsglobal.org/spec/lti/claim/";
constexpr const char* kOwn = "http://localhost:9";  // as it is said, never called
const std::string kKey(64, 'k');

/// A process of Node's.
class Platform {
  public:
    Platform() : pipe_(popen("exec node " HANDPIECE_PLATFORM " 2>/dev/null", "r")) {
        if (pipe_ != nullptr && std::fscanf(pipe_, "%d", &port_) != 1) port_ = 0;
    }
    ~Platform() {
        if (port_ > 0) (void)ask("/end", "{}");
        if (pipe_ != nullptr) pclose(pipe_);
    }
    Platform(const Platform&) = delete;
    Platform& operator=(const Platform&) = delete;
    [[nodiscard]] bool isThere() const { return port_ > 0; }
    [[nodiscard]] std::string address() const { return fmt::format("http://127.0.0.1:{}", port_); }
    std::string ask(const std::string& path, const json& body) const {
        httplib::Client http(address());
        const auto result =
            http.Post(path, body.is_string() ? body.get<std::string>() : body.dump(), "application/json");
        return result ? result->body : std::string();
    }
    [[nodiscard]] json told() const { return json::parse(ask("/told", "{}")); }

  private:
    std::FILE* pipe_;
    int port_ = 0;
};

class ElsewhereTest : public SchoolTest {
  protected:
    void SetUp() override {
        if (!platform_.isThere()) GTEST_SKIP() << "Node is not installed: no learning platform to test against";
        SchoolTest::SetUp();
        Books open(data());
        const Act act{"server", 1};
        const school::Person teacher{"t1", "Dr. Sato", "t1", "", "", {"teacher"}, 1, 0};
        open.add(std::span(&teacher, 1), act);
        open.add(school::SchoolClass{"c1", "Operative", "", 0, 1, 0}, act);
        const std::vector<school::Enrolment> in{{"c1", "s017", "student"}, {"c1", "t1", "teacher"}};
        open.enrol(in, act);
        const std::string exercise = rubric::hashText(tasks::contentHash(blockTask()));
        open.add(school::Assignment{"as1", "c1", exercise, open.pack(exercise)->rubric, "Block", "practice", "", 1,
                                    4'000'000'000'000},
                 act);
        LtiBooks lti(open);
        lti.setExternal("s017", "u-17", act);
        lti.setExternal("t1", "sourced-1", act);
        (void)lti.set({"",
                       "https://platform.example",
                       "client-1",
                       platform_.address() + "/auth",
                       platform_.address() + "/token",
                       platform_.address() + "/jwks",
                       {"d1", "d2"},
                       true},
                      act);
        now_ = systemClock()();
    }

    struct Begun {
        std::string state, nonce, cookie;
    };
    Begun begin(Books& open, Milliseconds now) const {
        const Beginning beginning =
            beginLaunch(open, kKey, "https://platform.example", "", "hint", "message", kOwn, now);
        httplib::Params asked;
        httplib::detail::parse_query_text(beginning.to.substr(beginning.to.find('?') + 1), asked);
        EXPECT_EQ(asked.find("state")->second, beginning.state);
        EXPECT_EQ(asked.find("redirect_uri")->second, std::string(kOwn) + "/lti/launch");
        EXPECT_EQ(asked.find("response_mode")->second, "form_post");
        EXPECT_EQ(asked.find("lti_message_hint")->second, "message");
        return {beginning.state, asked.find("nonce")->second, beginning.cookie};
    }
    [[nodiscard]] json claims(const std::string& nonce, Milliseconds now) const {
        const std::string base = kClaim;
        return {{"iss", "https://platform.example"},
                {"aud", "client-1"},
                {"sub", "u-17"},
                {"iat", now / 1000},
                {"exp", now / 1000 + 600},
                {"nonce", nonce},
                {base + "version", "1.3.0"},
                {base + "message_type", "LtiResourceLinkRequest"},
                {base + "deployment_id", "d1"},
                {base + "custom", {{"assignment", "as1"}}},
                {"https://purl.imsglobal.org/spec/lti-ags/claim/endpoint",
                 {{"scope", {"https://purl.imsglobal.org/spec/lti-ags/scope/score"}},
                  {"lineitem", platform_.address() + "/lineitems/1?x=1"}}}};
    }
    /// From the beginning; what `change` makes of claims and of how they are signed. Empty: accepted.
    std::string launched(const std::function<void(json& claims, json& how)>& change, Milliseconds skew = 0) {
        Books open(data());
        const Begun begun = begin(open, now_);
        json how = json::object(), said = claims(begun.nonce, now_ + skew);
        change(said, how);
        how["claims"] = said;
        const std::string token = platform_.ask("/sign", how);
        return errorIdOf([&] { person_ = takeLaunch(open, kKey, token, begun.state, begun.cookie, now_).person.code; });
    }
    /// Finished and pushed, as work on the assignment.
    std::string work() const {
        Books open(data());
        school::PushedAttempt p;
        Chair chair;
        p.attempt = *chair.store().attempt(chair.finish(session(), "one.h5"));
        p.station = std::string(32, 'c'), p.person = "s017", p.assignment = "as1", p.received = now_;
        p.files = {school::sha256Of(session())};
        (void)open.enrolStation(kCode, p.station, std::string(64, 'd'), 2);
        EXPECT_TRUE(open.push(p));
        return p.attempt.id;
    }

    Platform platform_;
    Milliseconds now_ = 0;
    std::string person_;
};

TEST_F(ElsewhereTest, APlatformsPeopleComeIn) {
    const auto asIs = [](json&, json&) {};
    EXPECT_EQ(launched(asIs), "");
    EXPECT_EQ(person_, "s017");
    EXPECT_EQ(launched(asIs, 100'000), "") << "its clock is ahead";
    EXPECT_EQ(launched(asIs, -100'000), "");
    EXPECT_EQ(launched([](json& c, json&) { c["aud"] = json::array({"client-1"}); }), "");
    EXPECT_EQ(launched([](json& c, json&) {
                  c["aud"] = json::array({"client-1", "x"});
                  c["azp"] = "client-1";
              }),
              "");
    EXPECT_EQ(launched([](json& c, json&) { c[std::string(kClaim) + "deployment_id"] = "d2"; }), "");
    // The class list's id goes before the platform's own.
    EXPECT_EQ(launched([](json& c, json&) {
                  c[std::string(kClaim) + "lis"] = {{"person_sourcedid", "sourced-1"}};
                  c["sub"] = "anybody";
              }),
              "");
    EXPECT_EQ(person_, "t1");
    // Where it sends its grade.
    Books open(data());
    const auto lines = LtiBooks(open).lines();
    ASSERT_THAT(lines, SizeIs(1)) << "of the student, not of the teacher";
    EXPECT_EQ(lines.front().subject, "u-17");
    EXPECT_THAT(lines.front().address, HasSubstr("/lineitems/1?x=1"));
    // A new key of the platform's: asked for again, a minute later at the earliest.
    platform_.ask("/rotate", json::object());
    now_ += 61'000;
    EXPECT_EQ(launched(asIs), "");
}

TEST_F(ElsewhereTest, WhatIsNotThePlatformsWordIsRefused) {
    const std::string base = kClaim;
    const auto refused = [&](const char* id, const std::function<void(json&, json&)>& change) {
        EXPECT_EQ(launched(change), id) << change.target_type().name();
    };
    refused("token-damaged", [](json&, json& how) { how["header"] = {{"alg", "none"}}; });
    refused("token-damaged", [](json&, json& how) { how["header"] = {{"alg", "HS256"}}; });
    refused("token-damaged", [](json&, json& how) { how["header"] = {{"crit", {"x"}}}; });
    refused("token-damaged", [](json&, json& how) { how["raw"] = "bm8ganNvbg"; });
    refused("token-forged", [](json&, json& how) { how["by"] = "other"; });
    refused("token-key", [](json&, json& how) { how["header"] = {{"kid", "k9"}}; });
    refused("token-key", [](json&, json& how) {
        how["header"] = {{"kid", "small"}};
        how["by"] = "small";
    });
    refused("launch-claim", [](json& c, json&) { c["iss"] = "https://other.example"; });
    refused("launch-claim", [](json& c, json&) { c["aud"] = "client-2"; });
    refused("launch-claim", [](json& c, json&) { c.erase("aud"); });
    refused("launch-claim", [](json& c, json&) { c["aud"] = json::array({"client-1", "x"}); });
    refused("launch-claim", [](json& c, json&) { c["azp"] = "x"; });
    refused("launch-claim", [](json& c, json&) { c["exp"] = c["iat"].get<std::int64_t>() - 130; });
    refused("launch-claim", [](json& c, json&) { c["exp"] = "never"; });
    refused("launch-claim", [](json& c, json&) { c["iat"] = c["iat"].get<std::int64_t>() + 130; });
    refused("launch-claim", [](json& c, json&) { c["iat"] = 1; });
    refused("launch-claim", [](json& c, json&) { c["nbf"] = c["iat"].get<std::int64_t>() + 130; });
    refused("launch-claim", [](json& c, json&) { c["nonce"] = std::string(64, 'a'); });
    refused("launch-claim", [](json& c, json&) { c.erase("nonce"); });
    refused("launch-claim", [&](json& c, json&) { c[base + "version"] = "1.1"; });
    refused("launch-claim", [&](json& c, json&) { c[base + "message_type"] = "LtiDeepLinkingRequest"; });
    refused("launch-claim", [&](json& c, json&) { c[base + "deployment_id"] = "d3"; });
    refused("launch-claim", [](json& c, json&) { c["sub"] = ""; });
    refused("launch-person", [](json& c, json&) { c["sub"] = "u-99"; });
    Books open(data());
    // One state once; of this browser; not older than ten minutes.
    const Begun first = begin(open, now_), second = begin(open, now_), old = begin(open, now_ - 601'000);
    const std::string token = platform_.ask("/sign", {{"claims", claims(first.nonce, now_)}});
    const auto taken = [&](const std::string& state, const std::string& cookie, const std::string& key = kKey) {
        return errorIdOf([&] { (void)takeLaunch(open, key, token, state, cookie, now_); });
    };
    EXPECT_EQ(taken(first.state, second.cookie), "launch-state");
    EXPECT_EQ(taken(first.state, ""), "launch-state");
    EXPECT_EQ(taken("", ""), "launch-state");
    EXPECT_EQ(taken(first.state, first.cookie, std::string(64, 'o')), "launch-state") << "another server's";
    for (const std::string& no :
         {std::string("."), std::string(".."), std::string("1"), std::string("1."), "9" + first.state,
          first.state + "0", std::string(5000, '.'), std::string("99999999999999999999.a.b"),
          first.state.substr(0, first.state.rfind('.'))})
        EXPECT_EQ(taken(no, first.cookie), "launch-state") << no.substr(0, 100);
    EXPECT_EQ(taken(first.state, first.cookie), "");
    EXPECT_EQ(taken(first.state, first.cookie), "launch-state") << "the same again";
    EXPECT_EQ(taken(second.state, second.cookie), "launch-claim")
        << "the same token in another log-in: its nonce is used";
    EXPECT_EQ(taken(old.state, old.cookie), "launch-state");
    EXPECT_EQ(errorIdOf([&] { (void)beginLaunch(open, kKey, "https://nobody.example", "", "", "", kOwn, now_); }),
              "platform-unknown");
    for (const std::string& nonsense :
         {std::string(), std::string("x"), std::string("a.b.c"), std::string("..."), std::string(70'000, 'a')})
        EXPECT_EQ(errorIdOf([&] { (void)claimsOf(nonsense, "{\"keys\":[]}"); }), "token-damaged") << nonsense.size();
    // Every bit of a token counts.
    const std::string keys = platform_.ask("/jwks", "{}");
    EXPECT_EQ(errorIdOf([&] { (void)claimsOf(token, keys); }), "");
    std::mt19937_64 random(test::seed(20261126));
    for (int i = 0; i < 300; ++i) {
        std::string changed = token;
        const std::size_t at = random() % changed.size();
        changed[at] = static_cast<char>(changed[at] ^ (1 << (random() % 7)));
        EXPECT_NE(errorIdOf([&] { (void)claimsOf(changed, keys); }), "") << at;
    }
}

TEST_F(ElsewhereTest, OnePlatformsIdIsNobodyOnAnother) {
    Books open(data());
    LtiBooks lti(open);
    const Act act{"server", 1};
    const std::string id = lti.set({"", "https://sandbox.example", "client-1", "a", "t", "k", {"d1"}, false}, act);
    const school::LtiPlatform sandbox = *lti.platform(id), other = *lti.platform("https://platform.example", "");
    EXPECT_TRUE(other.hasLists);
    EXPECT_EQ(lti.personOn(other, "u-17")->code, "s017");
    // A sandbox in which anybody makes a "17" signed in as that school's.
    EXPECT_FALSE(lti.personOn(sandbox, "u-17"));
    lti.setPerson(sandbox, "u-17", "t1", act);
    lti.setPerson(sandbox, "u-17", "t1", act);
    EXPECT_EQ(lti.personOn(sandbox, "u-17")->code, "t1");
    EXPECT_EQ(lti.personOn(other, "u-17")->code, "s017");
    EXPECT_EQ(errorIdOf([&] { lti.setPerson(sandbox, "u-17", "s017", act); }), "books-duplicate");
    EXPECT_EQ(errorIdOf([&] { lti.setPerson(sandbox, "", "s017", act); }), "books-invalid");
}

TEST_F(ElsewhereTest, ABrowserGoesThroughALaunchAndIsNoted) {
    Settings settings;
    settings.data = data(), settings.port = 0, settings.workers = 0, settings.keepsHouse = false;
    settings.address = kOwn;
    Server server(settings);
    std::thread thread([&] { server.run(); });
    httplib::Client http(fmt::format("http://127.0.0.1:{}", server.port()));
    while (!http.Get("/healthz"))
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const auto start = http.Post("/lti/login", httplib::Params{{"iss", "https://platform.example"},
                                                               {"login_hint", "h"},
                                                               {"target_link_uri", kOwn},
                                                               {"client_id", "client-1"}});
    ASSERT_EQ(start->status, 303) << start->body;
    const std::string to = start->get_header_value("Location");
    httplib::Params asked;
    httplib::detail::parse_query_text(to.substr(to.find('?') + 1), asked);
    const std::string state = asked.find("state")->second;
    const std::string cookie = start->get_header_value("Set-Cookie");
    EXPECT_THAT(cookie, AllOf(testing::StartsWith("handpiece-lti="), HasSubstr("HttpOnly")));
    const std::string browser = cookie.substr(0, cookie.find(';'));
    const std::string token =
        platform_.ask("/sign", {{"claims", claims(asked.find("nonce")->second, systemClock()())}});
    const httplib::Params form{{"id_token", token}, {"state", state}};
    EXPECT_EQ(http.Post("/lti/launch", form)->status, 403) << "another browser's";
    const auto launched = http.Post("/lti/launch", {{"Cookie", browser}}, form);
    ASSERT_EQ(launched->status, 200) << launched->body;
    EXPECT_THAT(launched->body, AllOf(HasSubstr("Ida"), HasSubstr("/people/s017")));
    const std::string login = launched->get_header_value("Set-Cookie").substr(0, 74);
    EXPECT_EQ(http.Get("/people/s017", {{"Cookie", login}})->status, 200);
    EXPECT_EQ(http.Post("/lti/launch", {{"Cookie", browser}}, form)->status, 403) << "once";
    const auto unknown = http.Get("/lti/login?iss=https://nobody.example&login_hint=h");
    EXPECT_EQ(unknown->status, 403);
    EXPECT_THAT(http.Get("/lti/jwks")->body, AllOf(HasSubstr("\"RS256\""), Not(HasSubstr("\"d\""))));
    EXPECT_EQ(fs::status(data() / "lti.pem").permissions(), fs::perms::owner_read | fs::perms::owner_write);
    server.stop();
    thread.join();
    std::size_t refused = 0;
    for (const school::AuditLine& line : books().audit(0, 1000))
        refused += line.what == "launch refused" ? 1 : 0;
    EXPECT_EQ(refused, 3u);
}

TEST_F(ElsewhereTest, HoweverManyBeginNobodyElseIsShutOut) {
    Books open(data());
    const Begun first = begin(open, now_);
    const std::string token = platform_.ask("/sign", {{"claims", claims(first.nonce, now_)}});
    for (int i = 0; i < 10'100; ++i)
        (void)beginLaunch(open, kKey, "https://platform.example", "client-1", "", "", kOwn, now_);
    EXPECT_EQ(errorIdOf([&] { (void)takeLaunch(open, kKey, token, first.state, first.cookie, now_); }), "");
    EXPECT_EQ(launched([](json&, json&) {}), "");
    // What came is known for as long as it could come again.
    LtiBooks lti(open);
    const std::string platform = lti.platforms().front().id;
    EXPECT_TRUE(lti.isFirst("a state", platform, 2000, 1000));
    EXPECT_FALSE(lti.isFirst("a state", platform, 2000, 1999));
}

TEST_F(ElsewhereTest, GradesGoToThePlatformAndNowhereElse) {
    const auto line = [&](const std::string& address) {
        EXPECT_EQ(launched([&](json& c, json&) {
                      c["https://purl.imsglobal.org/spec/lti-ags/claim/endpoint"]["lineitem"] = address;
                  }),
                  "")
            << "the person comes in all the same";
        Books open(data());
        const auto lines = LtiBooks(open).lines();
        return lines.empty() ? std::string() : lines.front().address;
    };
    std::size_t refused = 0;
    for (const char* elsewhere : {"https://thief.example/lineitems/1", "https://platform.example.thief.example/1",
                                  "http://platform.example/1", "https://platform.example@thief.example/1",
                                  "http://localhost:1/lineitems/1", "ftp://platform.example/1", "x"}) {
        EXPECT_EQ(line(elsewhere), "") << elsewhere;
        ++refused;
    }
    std::size_t noted = 0;
    for (const school::AuditLine& one : books().audit(0, 1000))
        noted += one.what == "line item refused" && one.about == "s017" ? 1 : 0;
    EXPECT_EQ(noted, refused);
    EXPECT_EQ(line("https://PLATFORM.example:8443/lineitems/1"), "https://PLATFORM.example:8443/lineitems/1");
    EXPECT_EQ(line(platform_.address() + "/lineitems/1"), platform_.address() + "/lineitems/1");
    // The platform has other addresses by now, all of them by TLS: what waits is not sent after it.
    (void)work();
    Books open(data());
    EXPECT_EQ(queueGrades(open, now_), 1u);
    LtiBooks lti(open);
    school::LtiPlatform moved = lti.platforms().front();
    moved.authAddress = moved.tokenAddress = moved.keysAddress = "https://platform.example/x";
    (void)lti.set(moved, {"server", 1});
    const RsaKey key(data() / "lti.pem");
    EXPECT_EQ(sendGrades(open, key, [&] { return now_; }), 0u);
    EXPECT_THAT(lti.grades().back().problem, HasSubstr("not where the platform is"));
    EXPECT_EQ(platform_.told()["scores"].size(), 0u);
}

TEST_F(ElsewhereTest, GradesGoBackOnceTheyAreConfirmed) {
    Settings settings;
    settings.data = data(), settings.port = 0, settings.workers = 0, settings.keepsHouse = false;
    Server server(settings);
    std::thread thread([&] { server.run(); });
    platform_.ask("/config", {{"toolKeys", fmt::format("http://127.0.0.1:{}/lti/jwks", server.port())}});
    EXPECT_EQ(launched([](json&, json&) {}), "");
    const RsaKey key(data() / "lti.pem");
    Milliseconds now = now_;
    const auto clock = [&] { return now; };
    Books open(data());
    LtiBooks lti(open);
    EXPECT_EQ(queueGrades(open, now), 0u) << "nothing was done yet";
    const std::string attempt = work();
    EXPECT_EQ(queueGrades(open, now), 1u);
    EXPECT_EQ(queueGrades(open, now), 0u) << "the same again";
    EXPECT_EQ(sendGrades(open, key, clock), 1u) << lti.grades().back().problem;
    json told = platform_.told();
    ASSERT_EQ(told["scores"].size(), 1u);
    EXPECT_EQ(told["scores"][0]["gradingProgress"], "PendingManual") << "no machine grades alone";
    EXPECT_FALSE(told["scores"][0].contains("scoreGiven"));
    EXPECT_EQ(told["scores"][0]["userId"], "u-17");
    EXPECT_EQ(told["scores"][0]["address"], "/lineitems/1/scores?x=1");
    // A teacher's mark, not given back yet, and then.
    (void)open.push(school::Mark{school::newId(), attempt, "t1", "teacher", "yes", 8.5, 10.0, "{}", now + 1000},
                    {"t1", now + 1000});
    EXPECT_EQ(queueGrades(open, now), 0u);
    school::Teaching(open).release(std::span(&attempt, 1), true, {"t1", now + 2000});
    EXPECT_EQ(queueGrades(open, now), 1u);
    platform_.ask("/config", {{"failScores", 2}});
    EXPECT_EQ(sendGrades(open, key, clock), 0u);
    EXPECT_THAT(lti.grades().back().problem, HasSubstr("503"));
    EXPECT_EQ(sendGrades(open, key, clock), 0u) << "not at once again";
    EXPECT_EQ(lti.grades().back().tries, 1);
    now += 31'000;
    EXPECT_EQ(sendGrades(open, key, clock), 0u);
    now += 61'000;
    EXPECT_EQ(sendGrades(open, key, clock), 1u);
    told = platform_.told();
    ASSERT_EQ(told["scores"].size(), 2u);
    EXPECT_EQ(told["scores"][1]["gradingProgress"], "FullyGraded");
    EXPECT_EQ(told["scores"][1]["scoreGiven"], 8.5);
    EXPECT_EQ(told["scores"][1]["scoreMaximum"], 10.0);
    // A platform that does not know this server's key.
    platform_.ask("/config", {{"toolKeys", platform_.address() + "/jwks"}});
    (void)open.push(school::Mark{school::newId(), attempt, "t1", "teacher", "yes", 9.0, 10.0, "{}", now + 9000},
                    {"t1", now + 9000});
    EXPECT_EQ(queueGrades(open, now), 1u);
    EXPECT_EQ(sendGrades(open, key, clock), 0u);
    EXPECT_THAT(lti.grades().back().problem, HasSubstr("gives no access"));
    // Whoever is erased: nothing that leads to them waits any more.
    open.erase("s017", {"server", now});
    EXPECT_THAT(lti.grades(), SizeIs(0));
    EXPECT_THAT(lti.lines(), SizeIs(0));
    server.stop();
    thread.join();
}

TEST_F(ElsewhereTest, AProxyIsBelievedAndNobodyElse) {
    const std::string secret(64, 's');
    const auto with = [&](const std::vector<std::string>& proxies, const httplib::Headers& headers) {
        Settings settings;
        settings.data = data(), settings.port = 0, settings.workers = 0, settings.keepsHouse = false;
        settings.signOn.proxies = proxies, settings.signOn.secret = secret;
        Server server(settings);
        std::thread thread([&] { server.run(); });
        httplib::Client http(fmt::format("http://127.0.0.1:{}", server.port()));
        while (!http.Get("/healthz"))
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        const auto result = http.Get("/sign-on", headers);
        std::string cookie = result->get_header_value("Set-Cookie");
        // The header alone opens nothing.
        EXPECT_EQ(http.Get("/classes", headers)->get_header_value("Location"), "/login");
        server.stop();
        thread.join();
        return std::pair(result->status, cookie);
    };
    const httplib::Headers right{{"X-Handpiece-User", "ida"}, {"X-Handpiece-Secret", secret}};
    EXPECT_EQ(with({"127.0.0.1"}, right).first, 200);
    EXPECT_EQ(with({"127.0.0.1"}, {{"X-Handpiece-User", "u-17"}, {"X-Handpiece-Secret", secret}}).first, 200)
        << "by external id";
    EXPECT_THAT(with({"127.0.0.1"}, right).second, AllOf(HasSubstr("HttpOnly"), Not(HasSubstr("Secure"))));
    httplib::Headers overTls = right;
    overTls.emplace("X-Forwarded-Proto", "https");
    EXPECT_THAT(with({"127.0.0.1"}, overTls).second, HasSubstr("Secure"));
    EXPECT_EQ(with({"10.0.0.1"}, right), std::pair(403, std::string())) << "no proxy of ours";
    EXPECT_EQ(with({}, right).first, 403);
    EXPECT_EQ(with({"127.0.0.1"}, {{"X-Handpiece-User", "ida"}}).first, 403);
    EXPECT_EQ(with({"127.0.0.1"}, {{"X-Handpiece-User", "ida"}, {"X-Handpiece-Secret", secret + "x"}}).first, 403);
    EXPECT_EQ(with({"127.0.0.1"}, {{"X-Handpiece-Secret", secret}}).first, 403);
    EXPECT_EQ(with({"127.0.0.1"}, {{"X-Handpiece-User", "nobody"}, {"X-Handpiece-Secret", secret}}).first, 403);
    // One of two was a browser's.
    for (const char* doubled : {"X-Handpiece-User", "X-Handpiece-Secret"}) {
        httplib::Headers two = right;
        two.emplace(doubled, right.find(doubled)->second);
        EXPECT_EQ(with({"127.0.0.1"}, two), std::pair(403, std::string())) << doubled;
    }
    std::vector<std::string> why;
    for (const school::AuditLine& line : books().audit(0, 1000))
        if (line.what == "sign-on refused") why.push_back(line.detail);
    EXPECT_THAT(why,
                testing::ElementsAre(HasSubstr("127.0.0.1: no proxy of ours"), HasSubstr("no proxy of ours"),
                                     HasSubstr("without the proxy's secret"), HasSubstr("without the proxy's secret"),
                                     HasSubstr("nobody here"), HasSubstr("two headers"), HasSubstr("two headers")));
}

TEST_F(ElsewhereTest, StatementsGoToARecordStoreOnceEach) {
    Chair chair;
    std::vector<std::string> ids;
    for (int i = 0; i < 45; ++i)
        ids.push_back(chair.finish(session(), fmt::format("{}.h5", i)));
    const statements::Actor actor{"https://school.example", "s017"};
    const school_station::RecordStore lrs{platform_.address() + "/xapi/", "u", "p"};
    const fs::path progress = chair.home() / "statements.json";
    const auto push = [&] { return school_station::pushStatements(chair.store(), actor, lrs, progress); };
    // It falls silent after the first piece, and goes on from there.
    school_station::RecordStore wrong = lrs;
    wrong.password = "x";
    EXPECT_THAT(errorOf([&] { (void)school_station::pushStatements(chair.store(), actor, wrong, progress); }),
                AllOf(HasSubstr("401"), HasSubstr("password")));
    platform_.ask("/config", {{"failStatements", 1}});
    EXPECT_EQ(errorIdOf([&] { (void)push(); }), "statements-refused");
    EXPECT_EQ(platform_.told()["statements"].size(), 0u);
    EXPECT_EQ(push().sent, 45u);
    EXPECT_EQ(push().sent, 0u);
    EXPECT_EQ(platform_.told()["statements"].size(), 45u);
    // All once more, from the beginning: nothing is doubled.
    fs::remove(progress);
    const school_station::PushedStatements again = push();
    EXPECT_EQ(again.sent, 0u);
    EXPECT_EQ(again.there, 45u);
    EXPECT_EQ(platform_.told()["statements"].size(), 45u);
    // One more, which comes between what is there.
    (void)chair.finish(session(), "late.h5");
    fs::remove(progress);
    EXPECT_EQ(push().sent, 1u);
    // They are those that `export --xapi` writes.
    std::vector<statements::Work> works;
    for (const school::Attempt& attempt : chair.store().attempts())
        works.push_back({attempt});
    std::map<std::string, json> exported, there;
    for (const json& one : json::parse(statements::statementsOf(works, actor)))
        exported[one["id"]] = one;
    const json told = platform_.told();
    for (const json& one : told["statements"])
        there[one["id"]] = one;
    EXPECT_TRUE(exported == there) << "1.0 and 1 are one number";
    EXPECT_EQ(there.size(), 46u);
    core::writeFile(progress, std::string("[]"));
    EXPECT_EQ(errorIdOf([&] { (void)push(); }), "statements-progress");
    const school_station::RecordStore silent{"http://127.0.0.1:1/xapi", "", ""};
    EXPECT_EQ(errorIdOf([&] {
                  (void)school_station::pushStatements(chair.store(), actor, silent, chair.home() / "other.json");
              }),
              "platform-silent");
    for (const char* no : {"", "ftp://x", "http://lrs.example/xapi", "https://", "https://a@b/", "https://x y/"})
        EXPECT_EQ(errorIdOf([&] {
                      (void)school_station::pushStatements(chair.store(), actor, {no, "", ""}, chair.home() / "o.json");
                  }),
                  "platform-address")
            << no;
}

}  // namespace
}  // namespace handpiece::school_server::elsewhere_test
