// SPDX-License-Identifier: Apache-2.0
// Each role at each route; what strangers send. docs/school-office.md#who-may-call-what has the table.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "handpiece/school/people/throttle.h"
#include "handpiece/school/store/books_accounts.h"
#include "school/answers.h"
#include "school/server/pages_fixture.h"
#include "school/slow_guard.h"

namespace handpiece::school_server::security_test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kDocs = HANDPIECE_SOURCE_DIR "/docs/school-office.md";
constexpr const char *kBegin = "<!-- routes -->\n", *kEnd = "<!-- /routes -->\n";

class SecurityTest : public PagesTest {
  protected:
    /// What stands in the place of a group of a pattern: things that are there, another's.
    std::string addressOf(const std::string& pattern) const {
        const auto is = [&](const char* start) { return pattern.starts_with(start); };
        return pathOf(pattern, [&](std::size_t group) -> std::string {
            if (group > 0) return {};
            if (is("/people/") || is("/office/people/")) return "s017";
            if (pattern.find("/classes/") != pattern.npos) return "c1";
            if (is("/attempts/")) return assigned_;
            if (is("/office/stations/")) return std::string(32, 'c');
            if (is("/assignments/")) return "as1";
            if (is("/exercises/")) return rubric::hashText(tasks::contentHash(blockTask()));
            if (is("/rubrics/")) return rubric::hashText(rubric::hashOf(rubric::parseRubric(kRubric, "rubric.toml")));
            return {};
        });
    }
    static int ask(httplib::Client& http, const Route& route, const std::string& path, const httplib::Headers& headers,
                   const httplib::Params& form) {
        const auto result = route.method == "GET"   ? http.Get(path, headers)
                            : route.method == "PUT" ? http.Put(path, headers, "x", "text/plain")
                                                    : http.Post(path, headers, form);
        if (!result) return 0;
        if (result->status == 303 && result->get_header_value("Location") == "/login" && path != "/logout") return 401;
        return result->status;
    }
};

/// "yes": it is answered, even if with what is missing in it; else it is not theirs.
std::string inTable(const Route& route, int status) {
    // A wrong password is refused to everybody.
    if (route.caller == Caller::anyone && status < 500 && status != 0) return "yes";
    return status == 401 || status == 403 || status == 426 ? ""
           : status == 0 || status >= 500                  ? std::to_string(status)
                                                           : "yes";
}

TEST_F(SecurityTest, EachRoleAtEachRouteAsTheDocsSay) {
    School school(data());
    Books open = books();
    const Act act{"server", 5};
    const std::vector<std::pair<const char*, const char*>> who{
        {"nobody", ""}, {"student", "s018"}, {"teacher", "t1"}, {"examiner", "e1"}, {"administrator", "a1"}};
    std::string table =
        "| route | nobody | student | teacher | examiner | administrator | station | exam station "
        "| worker |\n|---|---|---|---|---|---|---|---|---|\n";
    const std::string key(64, 'd'), examKey(64, 'e'), examStation(32, 'e'), workerKey(64, 'f');
    open.offerCode("a-code-for-exams", "exam room", systemClock()() + 1'000'000, act, "exam");
    ASSERT_TRUE(open.enrolStation("a-code-for-exams", examStation, examKey, systemClock()()));
    open.releaseForExams(examStation, act);
    open.offerCode("a-code-for-a-worker", "large machine", systemClock()() + 1'000'000, act, "worker");
    ASSERT_TRUE(open.enrolStation("a-code-for-a-worker", std::string(32, 'f'), workerKey, systemClock()()));
    const std::vector<Route> routes = Server::routes();
    std::vector<std::string> lines(routes.size());
    const auto tryRoute = [&](const Route& route) {
        std::string pattern = std::regex_replace(route.pattern, std::regex("\\(\\[[^)]*\\)"), "ID");
        pattern = std::regex_replace(pattern, std::regex("\\|"), "\\|");
        std::string line = fmt::format("| `{} {}` |", route.method, pattern);
        const std::string path = addressOf(route.pattern);
        for (const auto& [role, code] : who) {
            httplib::Client http(school.address());
            http.set_read_timeout(60);
            httplib::Headers headers{{"Handpiece-Protocol", "1"}};
            httplib::Params form;
            if (*code) {
                const std::string token = school::newSecret();
                open.addLogin(token, code, systemClock()() + 1'000'000, act);
                headers.emplace("Cookie", "handpiece=" + token);
                form.emplace("token", school::requestTokenOf(token));
            }
            line += fmt::format(" {} |", inTable(route, ask(http, route, path, headers, form)));
        }
        httplib::Client http(school.address());
        http.set_read_timeout(60);
        for (const std::string& its : {key, examKey, workerKey})
            line += fmt::format(
                " {} |", inTable(route, ask(http, route, path,
                                            {{"Handpiece-Protocol", "1"}, {"Authorization", "Bearer " + its}}, {})));
        return line + "\n";
    };
    // Another school for each would be slow. What changes nothing goes first, then what changes least: who begins a
    // desk sees no marks from then on.
    const auto turnOf = [](const Route& route) {
        return route.method == "GET" ? 0 : route.pattern.ends_with("/marking") ? 2 : 1;
    };
    for (int turn = 0; turn < 3; ++turn)
        for (std::size_t i = 0; i < routes.size(); ++i)
            if (turnOf(routes[i]) == turn) lines[i] = tryRoute(routes[i]);
    for (const std::string& line : lines)
        table += line;
    std::ifstream in(kDocs);
    std::stringstream docs;
    docs << in.rdbuf();
    std::string text = docs.str();
    const std::size_t from = text.find(kBegin), to = text.find(kEnd);
    ASSERT_NE(from, text.npos) << kDocs;
    ASSERT_NE(to, text.npos) << kDocs;
    const std::string there = text.substr(from + std::string(kBegin).size(), to - from - std::string(kBegin).size());
    if (std::getenv("HANDPIECE_WRITE_ROUTES")) {
        text.replace(from + std::string(kBegin).size(), there.size(), table);
        std::ofstream(kDocs) << text;
        return;
    }
    EXPECT_EQ(there, table) << "look at each line that differs; HANDPIECE_WRITE_ROUTES=1 writes what is";
}

TEST_F(SecurityTest, WhatIsInjectedIsTextOrRefusedAndNeverAFault) {
    School school(data());
    Books open = books();
    const std::string token = school::newSecret();
    open.addLogin(token, "a1", systemClock()() + 1'000'000, {"server", 5});
    const std::vector<std::string> strings{"' OR '1'='1",
                                           "'; DROP TABLE people; --",
                                           "\"><script>alert(1)</script>",
                                           "../../../../etc/passwd",
                                           "..%2f..%2f",
                                           std::string("a\0b", 3),
                                           "\xff\xfe\xc0\xaf",
                                           "%s%s%n",
                                           "{0}{1}{}",
                                           "\r\nSet-Cookie: a=b",
                                           std::string(100'000, 'A'),
                                           "-1",
                                           "9999999999999999999999",
                                           "$1",
                                           "$(reboot)",
                                           "=cmd|' /C calc'!A0"};
    const std::vector<const char*> names{"login", "password",  "code",  "new",    "again",  "name",
                                         "role",  "find",      "about", "before", "class",  "person",
                                         "sure",  "retention", "old",   "bytes",  "offset", "do"};
    httplib::Client http(school.address());
    std::size_t asked = 0;
    for (const Route& route : Server::routes()) {
        if (route.pattern == "/logout" || route.caller == Caller::station || route.caller == Caller::worker) continue;
        for (const std::string& string : strings) {
            httplib::Headers headers{{"Cookie", "handpiece=" + token}, {"Handpiece-Protocol", "1"}};
            httplib::Params form{{"token", school::requestTokenOf(token)}};
            std::string query;
            for (const char* name : names) {
                form.emplace(name, string);
                if (string.size() < 1000)
                    query += (query.empty() ? "?" : "&") + std::string(name) + "=" +
                             httplib::detail::encode_query_param(string);
            }
            const std::string path = addressOf(route.pattern) + (route.method == "GET" ? query : "");
            const auto result = route.method == "GET" ? http.Get(path, headers) : http.Post(path, headers, form);
            ASSERT_TRUE(result) << route.pattern << " " << string.substr(0, 40);
            EXPECT_LT(result->status, 500)
                << route.method << " " << path.substr(0, 200) << " " << string.substr(0, 40) << "\n"
                << result->body.substr(0, 300);
            EXPECT_THAT(result->body, Not(HasSubstr("<script>alert"))) << route.pattern;
            EXPECT_EQ(result->get_header_value("Set-Cookie").find("a=b"), std::string::npos);
            EXPECT_THAT(result->body, Not(HasSubstr("root:x"))) << route.pattern;
            ++asked;
        }
    }
    EXPECT_GT(asked, 300u);
    EXPECT_TRUE(open.person("s018"));
    // In the path itself.
    for (const std::string path : {"/office/people/../../etc/passwd", "/office/people/%2e%2e%2f%2e%2e%2fetc%2fpasswd",
                                   "/api/v1/files/..%2f..%2fbooks.db", "/files/books.db", "/books.db", "//etc/passwd",
                                   "/classes/c1/../../people", "/classes/%00", "/classes/c1%0d%0aX:1"}) {
        const auto result = http.Get(path, {{"Cookie", "handpiece=" + token}});
        ASSERT_TRUE(result) << path;
        EXPECT_THAT(result->status, testing::AnyOf(404, 403, 400)) << path;
        EXPECT_THAT(result->body, Not(HasSubstr("root:x")));
    }
}

sockaddr_in loopback(in_addr_t host, int port) {
    sockaddr_in at{};
    at.sin_family = AF_INET, at.sin_port = htons(static_cast<std::uint16_t>(port)), at.sin_addr.s_addr = htonl(host);
    return at;
}
/// To a port of this machine, from one of its loopback's addresses; -1: nobody is there.
int lineFrom(in_addr_t host, int port) {
    const int line = socket(AF_INET, SOCK_STREAM, 0);
    const sockaddr_in from = loopback(host, 0), to = loopback(INADDR_LOOPBACK, port);
    if (bind(line, reinterpret_cast<const sockaddr*>(&from), sizeof from) == 0 &&
        connect(line, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0)
        return line;
    close(line);
    return -1;
}
bool isOpen(int line) {
    char byte = 0;
    const ssize_t got = recv(line, &byte, 1, MSG_DONTWAIT);
    return got > 0 || (got < 0 && errno == EAGAIN);
}

/// Sends as it is, and hears what comes until the other side closes.
std::string raw(int port, const std::string& text, int waitS = 3, in_addr_t from = INADDR_LOOPBACK) {
    std::string heard;
    const int line = lineFrom(from, port);
    const timeval patience{waitS, 0};
    setsockopt(line, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    if (line >= 0) {
        for (std::size_t at = 0; at < text.size();) {
            const ssize_t sent = send(line, text.data() + at, text.size() - at, MSG_NOSIGNAL);
            if (sent <= 0) break;
            at += static_cast<std::size_t>(sent);
        }
        char piece[4096];
        for (ssize_t got; (got = recv(line, piece, sizeof piece, 0)) > 0;)
            heard.append(piece, static_cast<std::size_t>(got));
    }
    close(line);
    return heard;
}

TEST_F(SecurityTest, TooLongIsRefusedAndTheNextIsServed) {
    School school(data());
    const auto statusOf = [](const std::string& heard) { return heard.size() > 12 ? heard.substr(9, 3) : heard; };
    const std::string close = "Connection: close\r\n";
    httplib::Client http(school.address());
    const auto large = http.Post("/api/v1/enrol", std::string((4 << 20) + 1, ' '), "application/json");
    ASSERT_TRUE(large);
    EXPECT_EQ(large->status, 413);
    // Without a log-in: nested so deep that it ended the server, and with so many keys that it took 14 s.
    const std::string deep = "{\"code\":" + std::string(120'000, '[') + std::string(120'000, ']') + "}";
    EXPECT_EQ(http.Post("/api/v1/enrol", deep, "application/json")->status, 413);
    const std::string less = "{\"code\":" + std::string(60'000, '[') + std::string(60'000, ']') + "}";
    EXPECT_EQ(http.Post("/api/v1/enrol", less, "application/json")->status, 400);
    std::string keys = "{\"code\":1";
    for (int i = 0; i < 300'000; ++i)
        keys += fmt::format(",\"{}\":1", i);
    EXPECT_EQ(http.Post("/api/v1/enrol", keys + "}", "application/json")->status, 413);
    EXPECT_THAT(
        statusOf(raw(school.port(), "GET /" + std::string(20'000, 'a') + " HTTP/1.1\r\nHost: x\r\n" + close + "\r\n")),
        testing::AnyOf("414", "404", "400"));
    EXPECT_THAT(statusOf(raw(school.port(), "GET /login HTTP/1.1\r\nHost: x\r\nX: " + std::string(100'000, 'h') +
                                                "\r\n" + close + "\r\n")),
                testing::AnyOf("400", "431", ""));
    std::string many = "GET /login HTTP/1.1\r\n";
    for (int i = 0; i < 5000; ++i)
        many += fmt::format("X-{}: y\r\n", i);
    EXPECT_THAT(statusOf(raw(school.port(), many + close + "\r\n")), testing::AnyOf("431", ""));
    EXPECT_THAT(statusOf(raw(school.port(), "\x16\x03\x01 not HTTP at all\r\n\r\n")), testing::AnyOf("400", ""));
    EXPECT_EQ(statusOf(raw(school.port(), "POST /login HTTP/1.1\r\nHost: x\r\n" + close +
                                              "Transfer-Encoding: chunked\r\n\r\nzzz\r\n")),
              "411");
    // Bodies without a length, with two, packed (809 bytes were a gigabyte), at no address, by another method: none of
    // it is read, and what follows is nobody's next request.
    const std::string hidden = "GET /healthz HTTP/1.1\r\nHost: x\r\n\r\n";
    for (const auto& [head, status] : {std::pair{"POST /login", "411"},
                                       {"POST /login HTTP/1.1\r\nContent-Length: 5\r\nContent-Length: 6", "400"},
                                       {"POST /login HTTP/1.1\r\nContent-Length: 5x", "400"},
                                       {"GET /login HTTP/1.1\r\nContent-Length: 5", "400"},
                                       {"POST /login HTTP/1.1\r\nContent-Encoding: br\r\nContent-Length: 5", "415"},
                                       {"POST /nowhere HTTP/1.1\r\nContent-Length: 5", "404"},
                                       {"DELETE /login HTTP/1.1\r\nContent-Length: 5", "405"}}) {
        const std::string line =
            std::string(head).find("HTTP") == std::string::npos ? std::string(head) + " HTTP/1.1" : std::string(head);
        const std::string heard = raw(school.port(), line + "\r\nHost: x\r\n\r\n" + hidden);
        EXPECT_EQ(statusOf(heard), status) << head;
        EXPECT_EQ(heard.find("HTTP/1.1", 8), heard.npos) << "answered twice: " << heard;
    }
    // Pieces, each of which would have a head of its own: all is sent whole, and of many nothing.
    std::string pieces = "bytes=0-1";
    const std::string whole =
        raw(school.port(), "GET /healthz HTTP/1.1\r\nHost: x\r\n" + close + "Range: " + pieces + "\r\n\r\n");
    EXPECT_EQ(statusOf(whole), "200");
    EXPECT_THAT(whole, HasSubstr("well\n"));
    for (int i = 0; i < 1000; ++i)
        pieces += ",0-1";
    const std::string torn = raw(school.port(), "GET /healthz HTTP/1.1\r\nHost: x\r\nRange: " + pieces + "\r\n\r\n");
    EXPECT_EQ(statusOf(torn), "416");
    EXPECT_LT(torn.size(), 2000u);
    // A line of a header, and headers, without end: cut off long before they are a megabyte.
    for (const std::string& endless : {std::string(1 << 16, 'h'), std::string("X: y\r\n")}) {
        const int line = socket(AF_INET, SOCK_STREAM, 0);
        sockaddr_in to{};
        to.sin_family = AF_INET, to.sin_port = htons(static_cast<std::uint16_t>(school.port())),
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        ASSERT_EQ(connect(line, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
        std::string some = "GET /login HTTP/1.1\r\nHost: x\r\nX: ";
        std::size_t sent = 0;
        const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(30);
        while (send(line, some.data(), some.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(some.size()) &&
               std::chrono::steady_clock::now() < until) {
            sent += some.size();
            some = endless;
            if (sent > (1 << 18)) std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        EXPECT_LT(std::chrono::steady_clock::now(), until) << sent << " bytes were taken";
        ::close(line);
    }
    EXPECT_EQ(http.Get("/healthz")->status, 200);
}

TEST_F(SecurityTest, WhoSendsAByteASecondStopsNobodyAndIsCutOff) {
    constexpr int kSlow = 300;
    School school(data(), 0, 0, std::chrono::seconds(2));
    std::vector<int> lines;
    const std::string start = "GET /login HTTP/1.1\r\nHost: x\r\nX-Slow: ";
    for (int i = 0; i < kSlow; ++i) {
        const int line = socket(AF_INET, SOCK_STREAM, 0);
        sockaddr_in to{};
        to.sin_family = AF_INET, to.sin_port = htons(static_cast<std::uint16_t>(school.port())),
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        ASSERT_EQ(connect(line, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
        ASSERT_EQ(send(line, start.data(), start.size(), MSG_NOSIGNAL), static_cast<ssize_t>(start.size()));
        lines.push_back(line);
    }
    // Others are served in the meantime, each over a new connection, and a file that is large too.
    int alive = kSlow;
    for (int second = 0; second < 60 && alive > 0; ++second) {
        httplib::Client http(school.address());
        http.set_read_timeout(10);
        const auto well = http.Get("/healthz");
        ASSERT_TRUE(well) << "in second " << second << " with " << alive << " slow ones";
        EXPECT_EQ(well->status, 200);
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
        alive = 0;
        for (const int line : lines) {
            alive += send(line, "x", 1, MSG_NOSIGNAL) == 1 && isOpen(line) ? 1 : 0;
        }
    }
    EXPECT_EQ(alive, 0);
    for (const int line : lines)
        close(line);
}

/// So many of one address, each in the middle of a head.
std::vector<int> crowd(int port, int count) {
    const std::string start = "GET /login HTTP/1.1\r\nHost: x\r\nX-Slow: ";
    std::vector<int> lines;
    for (int i = 0; i < count; ++i) {
        lines.push_back(lineFrom(INADDR_LOOPBACK, port));
        EXPECT_EQ(send(lines.back(), start.data(), start.size(), MSG_NOSIGNAL), static_cast<ssize_t>(start.size()));
    }
    return lines;
}
constexpr const char* kIsWell = "GET /healthz HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n";

TEST_F(SecurityTest, OneAddressShutsNobodyOut) {
    // It would hold each of the threads, and more.
    School school(data(), School::Odd{.database = databaseOf(data()), .threads = 250});
    const std::vector<int> lines = crowd(school.port(), 300);
    const auto began = std::chrono::steady_clock::now();
    const std::string heard = raw(school.port(), kIsWell, 10, INADDR_LOOPBACK + 1);
    EXPECT_TRUE(heard.starts_with("HTTP/1.1 200")) << heard;
    EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(2));
    // Its youngest stay, and it is answered itself.
    EXPECT_TRUE(raw(school.port(), kIsWell, 10).starts_with("HTTP/1.1 200"));
    std::ptrdiff_t open = 300;
    for (int tenth = 0; tenth < 20 && open > 200; ++tenth) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        open = std::count_if(lines.begin(), lines.end(), isOpen);
    }
    EXPECT_LE(open, 200);
    EXPECT_GE(open, 190);
    for (const int line : lines)
        close(line);
}

TEST_F(SecurityTest, BehindANamedProxyMayBeMany) {
    School school(data(), School::Odd{.database = databaseOf(data()), .threads = 300, .proxies = {"127.0.0.1"}});
    const std::vector<int> lines = crowd(school.port(), 250);
    std::this_thread::sleep_for(std::chrono::seconds(1));
    EXPECT_EQ(std::count_if(lines.begin(), lines.end(), isOpen), 250);
    for (const int line : lines)
        close(line);
}

TEST(SlowGuardTest, BeyondTheBoundsWhoIsSilentLongestGoes) {
    const int listening = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in own = loopback(INADDR_LOOPBACK, 0);
    socklen_t size = sizeof own;
    ASSERT_EQ(bind(listening, reinterpret_cast<const sockaddr*>(&own), sizeof own), 0);
    ASSERT_EQ(listen(listening, 16), 0);
    ASSERT_EQ(getsockname(listening, reinterpret_cast<sockaddr*>(&own), &size), 0);
    SlowGuard guard(listening, std::chrono::minutes(10), {3, 5, {"127.0.0.9"}});
    std::vector<int> lines, taken;
    // Each is looked at before the next comes.
    const auto comes = [&](in_addr_t host) {
        lines.push_back(lineFrom(INADDR_LOOPBACK + host, ntohs(own.sin_port)));
        taken.push_back(accept(listening, nullptr, nullptr));
        std::this_thread::sleep_for(std::chrono::milliseconds(400));
    };
    const auto open = [&] {
        std::string all;
        for (const int line : lines)
            all += isOpen(line) ? 'o' : '-';
        return all;
    };
    for (int i = 0; i < 3; ++i)
        comes(0);
    EXPECT_EQ(open(), "ooo");
    comes(0);
    EXPECT_EQ(open(), "-ooo");
    {
        // One that is being answered stays, and the next after it goes.
        sockaddr_in other{};
        size = sizeof other;
        ASSERT_EQ(getsockname(lines[1], reinterpret_cast<sockaddr*>(&other), &size), 0);
        const SlowGuard::Working working(guard, fmt::format("127.0.0.1 {}", ntohs(other.sin_port)));
        comes(0);
        EXPECT_EQ(open(), "-o-oo");
        comes(1), comes(2);
        EXPECT_EQ(open(), "-o-oooo");
        comes(3);
        EXPECT_EQ(open(), "-o--oooo") << "of all";
        comes(0);
        EXPECT_EQ(open(), "-o---oooo");
    }
    // A proxy's are bounded by the room alone.
    for (const std::vector<int>* all : {&lines, &taken})
        for (const int line : *all)
            close(line);
    lines.clear(), taken.clear();
    for (int i = 0; i < 5; ++i)
        comes(8);
    EXPECT_EQ(open(), "ooooo");
    comes(8);
    EXPECT_EQ(open(), "-ooooo");
    for (const std::vector<int>* all : {&lines, &taken})
        for (const int line : *all)
            close(line);
    close(listening);
}

TEST(SlowGuardTest, OfThoseThatComeBetweenTwoLooksTheYoungestStay) {
    const int listening = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in own = loopback(INADDR_LOOPBACK, 0);
    socklen_t size = sizeof own;
    ASSERT_EQ(bind(listening, reinterpret_cast<const sockaddr*>(&own), sizeof own), 0);
    ASSERT_EQ(listen(listening, 16), 0);
    ASSERT_EQ(getsockname(listening, reinterpret_cast<sockaddr*>(&own), &size), 0);
    SlowGuard guard(listening, std::chrono::minutes(10), {2, 100, {}});
    // A tenth of a second between two looks: some of these rounds lie within one.
    for (int round = 0; round < 8; ++round) {
        std::vector<int> all;
        for (int i = 0; i < 5; ++i) {
            all.push_back(lineFrom(INADDR_LOOPBACK + 1u + static_cast<in_addr_t>(round), ntohs(own.sin_port)));
            std::this_thread::sleep_for(std::chrono::milliseconds(12));
            all.push_back(accept(listening, nullptr, nullptr));
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(250));
        std::string open;
        for (std::size_t i = 0; i < all.size(); i += 2)
            open += isOpen(all[i]) ? 'o' : '-';
        EXPECT_EQ(open, "---oo");
        for (const int line : all)
            close(line);
    }
    close(listening);
}

TEST_F(SecurityTest, ConnectionsThatAreNotTheServersAreLeftAlone) {
    School school(data(), 0, 0, std::chrono::seconds(1));
    // Another server of this process, at the same port of another address: nobody says a word there.
    const auto at = [&](in_addr_t host) {
        sockaddr_in to{};
        to.sin_family = AF_INET, to.sin_port = htons(static_cast<std::uint16_t>(school.port()));
        to.sin_addr.s_addr = htonl(host);
        return to;
    };
    const sockaddr_in other = at(INADDR_LOOPBACK + 1), own = at(INADDR_LOOPBACK);
    const int listening = socket(AF_INET, SOCK_STREAM, 0), there = socket(AF_INET, SOCK_STREAM, 0),
              here = socket(AF_INET, SOCK_STREAM, 0);
    ASSERT_EQ(bind(listening, reinterpret_cast<const sockaddr*>(&other), sizeof other), 0);
    ASSERT_EQ(listen(listening, 1), 0);
    ASSERT_EQ(connect(there, reinterpret_cast<const sockaddr*>(&other), sizeof other), 0);
    const int accepted = accept(listening, nullptr, nullptr);
    ASSERT_EQ(connect(here, reinterpret_cast<const sockaddr*>(&own), sizeof own), 0);
    // The server's own of that age is cut off.
    const timeval patience{20, 0};
    setsockopt(here, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    ASSERT_EQ(send(here, "G", 1, MSG_NOSIGNAL), 1);
    char byte = 0;
    EXPECT_LE(recv(here, &byte, 1, 0), 0);
    EXPECT_NE(errno, EAGAIN);
    std::this_thread::sleep_for(std::chrono::seconds(1));
    EXPECT_EQ(recv(there, &byte, 1, MSG_DONTWAIT), -1) << "was cut off";
    EXPECT_EQ(errno, EAGAIN);
    for (const int line : {listening, there, here, accepted})
        close(line);
}

TEST_F(SecurityTest, WhoComesByTlsStaysThere) {
    const auto logIn = [](const School& school, const httplib::Headers& headers) {
        httplib::Client http(school.address());
        const auto in = http.Post("/login", headers, httplib::Params{{"login", "t1"}, {"password", kPassword}});
        EXPECT_EQ(in->status, 303);
        return std::pair(in->get_header_value("Set-Cookie"), in->get_header_value("Strict-Transport-Security"));
    };
    const httplib::Headers tls{{"X-Forwarded-Proto", "https"}};
    {
        const School school(data(), School::Odd{.database = databaseOf(data()), .proxies = {"127.0.0.1"}});
        const auto [cookie, strict] = logIn(school, tls);
        EXPECT_THAT(cookie, HasSubstr("; Secure"));
        EXPECT_THAT(strict, HasSubstr("max-age="));
        EXPECT_THAT(logIn(school, {}), testing::Pair(Not(HasSubstr("Secure")), ""));
        EXPECT_THAT(logIn(school, {{"X-Forwarded-Proto", "http"}}), testing::Pair(Not(HasSubstr("Secure")), ""));
        EXPECT_THAT(logIn(school, {{"X-Forwarded-Proto", "https"}, {"X-Forwarded-Proto", "http"}}),
                    testing::Pair(Not(HasSubstr("Secure")), ""));
    }
    const School school(data());
    EXPECT_THAT(logIn(school, tls), testing::Pair(Not(HasSubstr("Secure")), "")) << "no proxy of ours says so";
}

TEST_F(SecurityTest, AnErrorDoesNotTellWhereTheBooksLie) {
    const auto told = [](const std::string& id) {
        httplib::Response response;
        answer(response, core::Error("there is none", "/srv/handpiece/books.db", "check it").as(id, {"person", "x"}));
        return response.body;
    };
    for (const char* id : {"books-unknown", "books-duplicate", "books-changed", "no-space", "account-suspended",
                           "store-locked", "not-writable", "of nobody's"})
        EXPECT_THAT(told(id), Not(HasSubstr("/srv"))) << id;
    EXPECT_THAT(told("message-damaged"), HasSubstr("/srv")) << "a place in what was sent";
    EXPECT_THAT(told("books-unknown"), testing::AllOf(HasSubstr("there is none"), HasSubstr("check it")));
}

TEST_F(SecurityTest, TheOldPasswordIsGuessedNoFasterThanAtTheDoor) {
    School school(data());
    Browser teacher(school.address());
    ASSERT_EQ(teacher.logIn("t1"), 303);
    const httplib::Params guess{{"old", "not that one"}, {"new", "quite another one"}, {"again", "quite another one"}};
    for (int i = 0; i < school::kFreeOfLogin; ++i)
        EXPECT_EQ(teacher.send("/account", guess)->status, 400) << i;
    EXPECT_EQ(teacher.send("/account", guess)->status, 429);
    EXPECT_EQ(Browser(school.address()).logIn("t1"), 429) << "one count of both";
    EXPECT_EQ(Browser(school.address()).logIn("t2"), 303);
    // What is right and no good as a new one is no guess.
    Browser other(school.address());
    ASSERT_EQ(other.logIn("e1"), 303);
    for (int i = 0; i < 2 * school::kFreeOfLogin; ++i)
        EXPECT_EQ(other.send("/account", {{"old", kPassword}, {"new", "short"}, {"again", "short"}})->status, 400) << i;
}

TEST_F(SecurityTest, AnOldHashIsRenewedAtTheNextLogIn) {
    // Of kPassword, with less memory and one pass.
    const std::string weak =
        "$argon2id$v=19$m=8192,t=1,p=1$H1rsSiu27fSrI3bkvk3y9w$wgVCx5Vf/5StYCeikHwyTif0staEMcZzUu7OxNzt8gM";
    Books open = books();
    open.setPassword("t1", weak, {"server", 5});
    School school(data());
    EXPECT_EQ(Browser(school.address()).logIn("t1", "a wrong long one"), 401);
    EXPECT_EQ(open.person("t1")->password, weak);
    Browser teacher(school.address());
    ASSERT_EQ(teacher.logIn("t1"), 303);
    const std::string fresh = open.person("t1")->password;
    EXPECT_THAT(fresh, testing::StartsWith("$argon2id$v=19$m=19456,t=2,p=1$"));
    ASSERT_EQ(Browser(school.address()).logIn("t1"), 303);
    EXPECT_EQ(open.person("t1")->password, fresh) << "once";
    EXPECT_EQ(teacher.get("/classes")->status, 200) << "who is in stays in";
    school::BooksAccounts(open).renewHash("t1", weak, "another");
    EXPECT_EQ(open.person("t1")->password, fresh) << "it was set meanwhile";
}

TEST_F(SecurityTest, AGivenLogInIsNotTakenOver) {
    School school(data());
    // A token that somebody put into the browser before is never the one after the log-in.
    const std::string planted(64, 'b');
    httplib::Client http(school.address());
    const auto in = http.Post("/login", {{"Cookie", "handpiece=" + planted}},
                              httplib::Params{{"login", "t1"}, {"password", kPassword}});
    ASSERT_EQ(in->status, 303);
    const std::string set = in->get_header_value("Set-Cookie");
    EXPECT_THAT(set, Not(HasSubstr(planted)));
    EXPECT_THAT(set, testing::AllOf(HasSubstr("HttpOnly"), HasSubstr("SameSite=Strict")));
    EXPECT_EQ(http.Get("/classes", {{"Cookie", "handpiece=" + planted}})->status, 303);
    // No form without this log-in's token, whatever the browser sends by itself.
    Browser teacher(school.address());
    ASSERT_EQ(teacher.logIn("t1"), 303);
    Browser other(school.address());
    ASSERT_EQ(other.logIn("t2"), 303);
    for (const Route& route : Server::routes()) {
        if (route.caller != Caller::person || route.method != "POST") continue;
        const std::string path = addressOf(route.pattern);
        EXPECT_EQ(teacher.post(path, httplib::Params{})->status, 403) << path;
        EXPECT_EQ(teacher.post(path, httplib::Params{{"token", school::requestTokenOf(other.cookie())}})->status, 403)
            << path;
    }
}

}  // namespace
}  // namespace handpiece::school_server::security_test
