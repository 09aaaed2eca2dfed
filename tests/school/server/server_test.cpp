// SPDX-License-Identifier: Apache-2.0
// A server, its stations and what goes wrong between them: over real HTTP, with real sessions.
#include <atomic>
#include <set>

#include "handpiece/school/people/secret.h"
#include "school/server/browser.h"
#include "school/worker.h"
#include "support/error_of.h"

namespace handpiece::school_server::server_test {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

TEST_F(SchoolTest, WorkIsPushedProvenAndScored) {
    School school(data());
    Chair chair;
    Enrolment enrolment = school_station::enrol(school.address(), kCode, "s017");
    const std::string attempt = chair.finish(session(), "one.h5");
    chair.store().add(school::Judgement{attempt, 80.0, "fine", 6000});
    const school_station::Pushed pushed = chair.push(enrolment);
    EXPECT_EQ(pushed.attempts, 1u);
    EXPECT_EQ(pushed.judgements, 1u);
    EXPECT_EQ(pushed.files, 1u);
    EXPECT_EQ(pushed.bytes, fs::file_size(session()));
    EXPECT_THAT(pushed.refused, SizeIs(0));
    EXPECT_THAT(school_station::status(enrolment).missing, SizeIs(0));
    // Nothing is left to be said; and said once more, from before, it is all the same.
    EXPECT_EQ(chair.push(enrolment).attempts, 0u);
    Enrolment forgot = enrolment;
    forgot.sent = 0;
    EXPECT_EQ(chair.push(forgot).bytes, 0u);
    EXPECT_EQ(books().attemptsOf("s017").size(), 1u);

    Worker worker(worksOf({data(), databaseOf(data())}, systemClock()));
    EXPECT_TRUE(worker.workOnce());
    EXPECT_FALSE(worker.workOnce()) << "once";
    const std::vector<school::Score> scores = scoresOf(attempt);
    ASSERT_EQ(scores.size(), 1u);
    EXPECT_EQ(scores.front().state, "proven") << scores.front().reason;
    const assessment::Result own = assessment::scoreWork(assessment::readWork(session(), blockTask()), blockTask(),
                                                         rubric::parseRubric(kRubric, "rubric.toml"));
    EXPECT_EQ(scores.front().score, own.assessment.score) << "the station's own, to the bit";
    EXPECT_EQ(scores.front().stateHash, own.identity.stateHash);
    httplib::Client http(school.address());
    const auto metrics = http.Get("/metrics");
    ASSERT_TRUE(metrics);
    EXPECT_THAT(metrics->body, HasSubstr("handpiece_attempts_total 1"));
    EXPECT_THAT(metrics->body, HasSubstr("handpiece_jobs{state=\"done\"} 1"));
}

TEST_F(SchoolTest, ABoastAndAForeignSessionAreFound) {
    School school(data());
    Chair chair;
    Enrolment enrolment = school_station::enrol(school.address(), kCode, "s017");
    const std::string boast = chair.finish(session(), "one.h5", 99.0);
    // The recording was changed after the score: the bytes are others than the attempt names.
    const std::string changed = chair.finish(session(), "two.h5");
    {
        std::vector<std::byte> bytes = core::readFile(session());
        bytes[bytes.size() / 3] ^= std::byte{1};
        core::writeFile(chair.home() / "sessions" / "two.h5", bytes);
    }
    (void)chair.push(enrolment);
    Worker worker(worksOf({data(), databaseOf(data())}, systemClock()));
    while (worker.workOnce()) {
    }
    EXPECT_THAT(scoresOf(boast).front().reason, HasSubstr("its station said 99 of 100"));
    EXPECT_EQ(scoresOf(changed).front().state, "refused");
    EXPECT_THAT(scoresOf(changed).front().reason, HasSubstr("another than the attempt names"));
}

TEST_F(SchoolTest, OnePersonsSessionIsNotAnothersWork) {
    School school(data());
    {
        Books open = books();
        const school::Person other{"s018", "Jun", "jun", "", "", {"student"}, 1, 0};
        open.add(std::span(&other, 1), {"server", 1});
        open.offerCode("ABC-DEF-GHJ-KMP", "chair 2", 4'000'000'000'000, {"server", 1});
    }
    Worker worker(worksOf({data(), databaseOf(data())}, systemClock()));
    Chair own, borrowed;
    Enrolment mine = school_station::enrol(school.address(), kCode, "s017");
    const std::string first = own.finish(session(), "one.h5");
    (void)own.push(mine);
    EXPECT_TRUE(worker.workOnce());
    Enrolment theirs = school_station::enrol(school.address(), "ABC-DEF-GHJ-KMP", "s018");
    const std::string second = borrowed.finish(session(), "one.h5");
    (void)borrowed.push(theirs);
    EXPECT_TRUE(worker.workOnce());
    EXPECT_EQ(scoresOf(first).back().state, "proven");
    EXPECT_EQ(scoresOf(second).back().state, "refused");
    EXPECT_THAT(scoresOf(second).back().reason, HasSubstr("another person's"));
}

TEST_F(SchoolTest, WorkOnWhatTheSchoolGaveIsToldAsThat) {
    School school(data());
    {
        Books open = books();
        const Act act{"server", 1};
        open.add(school::SchoolClass{"c1", "Class", "", 0, 1, 0}, act);
        const school::Enrolment one{"c1", "s017", "student"};
        open.enrol(std::span(&one, 1), act);
        const std::string exercise = rubric::hashText(tasks::contentHash(blockTask()));
        const std::string rubric = open.pack(exercise)->rubric;
        open.add(school::Assignment{"early", "c1", exercise, rubric, "Early", "practice", "", 1, 500}, act);
        open.add(school::Assignment{"now", "c1", exercise, rubric, "Now", "practice", "", 2000, 9000}, act);
    }
    Chair chair;
    Enrolment enrolment = school_station::enrol(school.address(), kCode, "s017");
    const std::string attempt = chair.finish(session(), "one.h5");
    (void)chair.push(enrolment);
    EXPECT_EQ(books().attempt(attempt)->assignment, "now");
    EXPECT_EQ(books().classPage("c1").cells.size(), 1u);
}

// Any enrolled station acted for anybody: work and live pictures in another's name.
TEST_F(SchoolTest, AStationOfAPersonActsForNobodyElseAndClassWorkMayNeedOne) {
    {
        Books open = books();
        const Act act{"server", 1};
        const school::Person other{"s018", "Jun", "jun", "", "", {"student"}, 1, 0};
        open.add(std::span(&other, 1), act);
        open.add(school::SchoolClass{"c1", "Class", "", 0, 1, 0}, act);
        const std::vector<school::Enrolment> in{{"c1", "s017", "student"}, {"c1", "s018", "student"}};
        open.enrol(in, act);
        const std::string exercise = rubric::hashText(tasks::contentHash(blockTask()));
        open.add(
            school::Assignment{"now", "c1", exercise, open.pack(exercise)->rubric, "Now", "practice", "", 2000, 9000},
            act);
        open.offerCode("ABC-DEF-GHJ-KMP", "Ida's own", 4'000'000'000'000, act, "practice", "s017");
    }
    School school(data(), School::Odd{.database = databaseOf(data()), .ownStationsOnly = true});
    // Whose it is says the code, and not who types it.
    // And one that is not what is meant is not spent.
    const auto tried = [&](const char* code, const char* person, const char* kind = "practice") {
        return test::errorIdOf([&] { (void)school_station::enrol(school.address(), code, person, kind); });
    };
    EXPECT_EQ(tried("ABC-DEF-GHJ-KMP", "s018"), "code-other");
    EXPECT_EQ(tried("ABC-DEF-GHJ-KMP", "", "exam"), "code-other");
    EXPECT_EQ(tried(kCode, ""), "code-other") << "whose work is it?";
    Enrolment own = school_station::enrol(school.address(), "ABC-DEF-GHJ-KMP", "");
    EXPECT_EQ(own.person, "s017");
    EXPECT_EQ(tried("ABC-DEF-GHJ-KMP", ""), "code-unknown") << "spent";
    Chair chair;
    Enrolment asJun = own;
    asJun.person = "s018";
    const std::string first = chair.finish(session(), "one.h5");
    EXPECT_EQ(test::errorIdOf([&] { (void)chair.push(asJun); }), "station-anothers");
    EXPECT_EQ(test::errorIdOf([&] { (void)school_station::tasksOf(asJun); }), "station-anothers");
    httplib::Client http(school.address());
    const httplib::Headers headers{{"Handpiece-Protocol", "1"}, {"Authorization", "Bearer " + own.key}};
    EXPECT_EQ(http.Get("/api/v1/tasks/s018", headers)->status, 403);
    EXPECT_EQ(http.Get("/api/v1/tasks/s017", headers)->status, 200);
    (void)chair.push(own);
    EXPECT_EQ(books().attempt(first)->person, "s017");
    EXPECT_EQ(books().attempt(first)->assignment, "now");
    // One that is anybody's: its class work waits there, and goes when it is enrolled as somebody's own.
    Chair room;
    Enrolment anybodys = school_station::enrol(school.address(), kCode, "s018");
    const std::string waits = room.finish(session(), "two.h5");
    EXPECT_EQ(test::errorIdOf([&] { (void)room.push(anybodys); }), "station-anybodys");
    EXPECT_FALSE(books().attempt(waits));
    EXPECT_EQ(school_station::waitingIn(room.store(), anybodys), 1u);
    books().offerCode("ABC-DEF-GHJ-KMQ", "Jun's own", 4'000'000'000'000, {"server", 1}, "practice", "s018");
    Enrolment again = school_station::enrol(school.address(), "ABC-DEF-GHJ-KMQ", "");
    again.sent = anybodys.sent, again.books = anybodys.books;
    (void)room.push(again);
    EXPECT_EQ(books().attempt(waits)->person, "s018");
    // Revoked by its person, it sends nothing more.
    books().revoke(again.station, {"s018", 1});
    (void)room.finish(session(), "three.h5");
    EXPECT_EQ(test::errorIdOf([&] { (void)room.push(again); }), "not-enrolled");
}

TEST_F(SchoolTest, WithoutTheServerNothingIsLost) {
    Chair chair;
    Enrolment enrolment;
    int port = 0;
    {
        School school(data());
        port = school.port();
        enrolment = school_station::enrol(school.address(), kCode, "s017");
    }
    const std::string attempt = chair.finish(session(), "one.h5");
    EXPECT_THAT(test::errorOf([&] { (void)chair.push(enrolment); }), HasSubstr("nobody answers there"));
    EXPECT_EQ(enrolment.sent, 0);
    School again(data(), 0, port);
    EXPECT_EQ(chair.push(enrolment).files, 1u);
    EXPECT_EQ(chair.kept().sent, enrolment.sent);
    EXPECT_TRUE(books().attempt(attempt));
}

TEST_F(SchoolTest, WhatWasCutOffGoesOnFromThere) {
    School school(data());
    Chair chair;
    Enrolment enrolment = school_station::enrol(school.address(), kCode, "s017");
    (void)chair.finish(session(), "one.h5");
    // Half of the file came before the network went.
    const std::string hash = school::sha256Of(session());
    const std::vector<std::byte> bytes = core::readFile(session());
    const std::size_t half = bytes.size() / 2;
    {
        Books open = books();
        const auto station = open.stationByKey(enrolment.key);
        ASSERT_TRUE(station);
        (void)open.append({station->id, hash, bytes.size()}, 0, std::span(bytes).first(half), 1);
    }
    EXPECT_EQ(chair.push(enrolment).bytes, bytes.size() - half);
}

TEST_F(SchoolTest, ThirtyPushAtOnceAndNoneIsLostOrDoubled) {
    School school(data());
    std::vector<std::string> codes;
    {
        Books open = books();
        for (int i = 0; i < 30; ++i)
            open.offerCode(codes.emplace_back(school::newStationCode()), fmt::format("chair {}", i), 4'000'000'000'000,
                           {"server", 1});
    }
    (void)session();
    std::vector<std::thread> chairs;
    std::atomic<int> failed{0};
    std::mutex mutex;
    std::set<std::string> ids;
    for (int i = 0; i < 30; ++i)
        chairs.emplace_back([&, i] {
            try {
                Chair chair;
                Enrolment enrolment =
                    school_station::enrol(school.address(), codes[static_cast<std::size_t>(i)], "s017");
                for (int k = 0; k < 3; ++k) {
                    const std::string id = chair.finish(session(), fmt::format("{}.h5", k));
                    const std::lock_guard lock(mutex);
                    ids.insert(id);
                }
                (void)chair.push(enrolment);
            } catch (const std::exception& e) {
                ++failed;
                ADD_FAILURE() << e.what();
            }
        });
    for (std::thread& chair : chairs)
        chair.join();
    EXPECT_EQ(failed, 0);
    std::set<std::string> there;
    for (const school::PushedAttempt& one : books().attemptsOf("s017"))
        EXPECT_TRUE(there.insert(one.attempt.id).second);
    EXPECT_EQ(there, ids);
    EXPECT_THAT(books().files().all(), SizeIs(2)) << "the exercise and the one recording";
    EXPECT_EQ(books().progress("arrival").waiting, 90);
}

TEST_F(SchoolTest, AFileWhoseServerWasKilledBeforeItProvedItIsProvenThen) {
    School school(data());
    Chair chair;
    const std::string attempt = chair.finish(session(), "one.h5");
    Enrolment enrolment = school_station::enrol(school.address(), kCode, "s017");
    const std::string hash = school::sha256Of(session());
    // All bytes had come, and nothing more happened.
    fs::copy_file(session(), data() / "uploads" / (enrolment.station + "-" + hash));
    EXPECT_EQ(chair.push(enrolment).attempts, 1u);
    EXPECT_TRUE(books().files().has(hash));
    EXPECT_EQ(books().progress("arrival").waiting, 1);
}

TEST_F(SchoolTest, StrangersGetNothing) {
    School school(data());
    httplib::Client http(school.address());
    for (const Route& route : Server::routes()) {
        if (route.caller != Caller::station && route.caller != Caller::worker) continue;
        const std::string path = pathOf(route.pattern) + "?bytes=1&offset=0";
        for (const httplib::Headers& headers :
             {httplib::Headers{{"Handpiece-Protocol", "1"}},
              httplib::Headers{{"Handpiece-Protocol", "1"}, {"Authorization", "Bearer "}},
              httplib::Headers{{"Handpiece-Protocol", "1"}, {"Authorization", "Bearer ' OR 1=1 --"}},
              httplib::Headers{{"Handpiece-Protocol", "1"}, {"Authorization", "Basic " + std::string(64, 'a')}}}) {
            const httplib::Result result = route.method == "GET"    ? http.Get(path, headers)
                                           : route.method == "POST" ? http.Post(path, headers, "{}", "application/json")
                                                                    : http.Put(path, headers, "x", "text/plain");
            ASSERT_TRUE(result) << route.method << " " << path;
            EXPECT_EQ(result->status, 401) << route.method << " " << path;
        }
        // Of another version: told, before anything else.
        const auto other = http.Get(path, {{"Handpiece-Protocol", std::to_string(school_wire::kProtocol + 1)}});
        if (route.method == "GET") {
            EXPECT_EQ(other->status, 426);
        }
    }
    for (const char* path : {"/api/v1/files/../../books.db", "/api/v1/files/%2e%2e%2fbooks.db", "/books.db",
                             "/api/v1/files/AAAA", "/api/v2/status"}) {
        const auto result = http.Get(path);
        ASSERT_TRUE(result) << path;
        EXPECT_EQ(result->status, 404) << path;
    }
    const auto wrong = http.Post("/api/v1/enrol", R"({"code": "nobody's"})", "application/json");
    EXPECT_EQ(wrong->status, 403);
    const Enrolment once = school_station::enrol(school.address(), kCode, "s017");
    EXPECT_THAT(test::errorOf([&] { (void)school_station::enrol(school.address(), kCode, "s017"); }),
                HasSubstr("was used"));
    // A key that was taken back.
    {
        Books open = books();
        open.revoke(once.station, {"server", 2});
    }
    EXPECT_THAT(test::errorOf([&] { (void)school_station::status(once); }), HasSubstr("does not know this station"));
}

TEST_F(SchoolTest, DamagedMessagesAreOneClearErrorEach) {
    School school(data());
    const Enrolment enrolment = school_station::enrol(school.address(), kCode, "s017");
    httplib::Client http(school.address());
    const httplib::Headers headers{{"Handpiece-Protocol", "1"}, {"Authorization", "Bearer " + enrolment.key}};
    for (const std::string& body :
         {std::string(), std::string("["), std::string("{}"), std::string("[]"), std::string(R"({"id": 7})"),
          std::string(R"({"id": "x", "person": "s017"})"), std::string(100'000, '['), std::string("\xff\xfe\0", 3)}) {
        const auto result = http.Post("/api/v1/attempts", headers, body, "application/json");
        ASSERT_TRUE(result);
        EXPECT_EQ(result->status, 400) << body.substr(0, 40);
        EXPECT_THAT(result->body, HasSubstr("message-damaged"));
    }
    const auto huge =
        http.Post("/api/v1/attempts", headers, std::string(school_wire::kMostMessage + 1, ' '), "application/json");
    EXPECT_TRUE(!huge || huge->status == 413) << huge->status;
    const std::string file = "/api/v1/files/" + std::string(64, 'a');
    httplib::Client again(school.address());
    for (const char* query : {"", "?bytes=", "?bytes=-1", "?bytes=1e9", "?bytes=99999999999999999999", "?bytes=x"})
        EXPECT_EQ(again.Get(file + query, headers)->status, 400) << query;
    EXPECT_EQ(again.Put(file + "?bytes=3&offset=2", headers, "x", "text/plain")->status, 409);
    EXPECT_EQ(again.Put(file + "?bytes=1&offset=0", headers, "x", "text/plain")->status, 422)
        << "not what was promised";
    EXPECT_TRUE(again.Get("/healthz"));
}

/// As another program that answers at the address.
TEST(Station, ANonsenseServerIsToldAndChangesNothing) {
    httplib::Server nonsense;
    std::string body = "<html>hello</html>";
    int status = 200;
    const auto reply = [&](const httplib::Request&, httplib::Response& response) {
        response.status = status;
        response.set_content(body, "text/html");
    };
    nonsense.Post(".*", reply).Get(".*", reply);
    const int port = nonsense.bind_to_any_port("127.0.0.1");
    std::thread thread([&] { nonsense.listen_after_bind(); });
    const std::string address = fmt::format("http://127.0.0.1:{}", port);
    for (const auto& [answer, code] : std::vector<std::pair<std::string, int>>{{"<html>", 200},
                                                                               {"", 500},
                                                                               {"{}", 200},
                                                                               {R"({"station": 1})", 201},
                                                                               {"{\"what\": 3}", 404},
                                                                               {std::string(1 << 16, '{'), 200}}) {
        body = answer, status = code;
        EXPECT_NE(test::errorOf([&] { (void)school_station::enrol(address, kCode, "s017"); }), "") << answer;
    }
    Chair chair;
    (void)chair.finish(session(), "one.h5");
    Enrolment enrolment{address, std::string(32, 'a'), std::string(64, 'b'), "s017", 0};
    body = "<html>", status = 500;
    EXPECT_NE(test::errorOf([&] { (void)chair.push(enrolment); }), "");
    EXPECT_EQ(enrolment.sent, 0);
    nonsense.stop();
    thread.join();
    EXPECT_NE(test::errorOf([] { (void)school_station::enrol("school.example", "C", "s"); }), "");
    EXPECT_NE(test::errorOf([] { (void)school_station::enrol("http://127.0.0.1:1", "C", "s"); }), "");
}

}  // namespace
}  // namespace handpiece::school_server::server_test
