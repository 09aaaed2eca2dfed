// SPDX-License-Identifier: Apache-2.0
// A school whose parts differ: versions, clocks, databases, workers, and more who ask than the database takes.
#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/assessment/score_work.h"
#include "handpiece/school/store/teaching.h"
#include "school/books_pool.h"
#include "school/exam_arrival.h"
#include "school/exam_desk.h"
#include "school/exam_service.h"
#include "school/exam_station.h"
#include "school/robust/robust_fixture.h"
#include "school/server/browser.h"
#include "support/error_of.h"

namespace handpiece::school_server::odd_school_test {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

const std::string kCandidate = "123-456-789-ABC", kPin = "PPP-QQQ-RRR-SSS";
constexpr school::Milliseconds kHourMs = 3'600'000;
constexpr std::chrono::seconds kDay = 24h;

school::Milliseconds nowMs(std::chrono::seconds ahead = 0s) {
    return systemClock()() + 1000 * ahead.count();
}

/// Until it is so, or far too long.
template <class Condition>
bool comesTo(const Condition& isSo) {
    for (int i = 0; i < 6000; ++i, std::this_thread::sleep_for(20ms))
        if (isSo()) return true;
    return false;
}

class OddSchoolTest : public RobustTest {
  protected:
    /// A server that takes these versions of the messages, in this program.
    std::unique_ptr<School> taking(int oldest, int newest) const {
        return std::make_unique<School>(
            data_, School::Odd{.port = port_, .oldest = oldest, .newest = newest, .database = database_});
    }
    /// As a station that speaks this version; why it was refused.
    std::string pushSpeaking(std::size_t chair, int protocol) {
        Enrolment own = chairs_[chair]->kept();
        own.protocol = protocol;
        return test::errorOf([&] { (void)chairs_[chair]->push(own); });
    }
    /// What all students have to do, from an hour before that moment to an hour after.
    void giveToDo(school::Milliseconds around) {
        Books open = books();
        const Act act{"server", 1};
        upload(open, "an exercise");
        open.add(school::RubricVersion{std::string(16, 'f'), "block", kRubric, 1, 1}, act);
        open.add(school::Pack{kExercise, school::sha256("an exercise"), "block", "Block", std::string(16, 'f')}, act);
        open.add(school::SchoolClass{"c1", "Class", "", 0, 1, 0}, act);
        for (std::size_t i = 0; i < chairs_.size(); ++i) {
            const school::Enrolment one{"c1", fmt::format("s{:03}", i), "student"};
            open.enrol(std::span(&one, 1), act);
        }
        open.add(school::Assignment{"as1", "c1", kExercise, std::string(16, 'f'), "Block", "practice", "",
                                    around - kHourMs, around + kHourMs},
                 act);
        besides_ = {school::sha256("an exercise")};
    }
    static void upload(Books& open, const std::string& text) {
        const school::Upload one{std::string(32, '0'), school::sha256(text), text.size()};
        (void)open.append(one, 0, std::as_bytes(std::span(text)), 1);
    }
};
INSTANTIATE_TEST_SUITE_P(OnBoth, OddSchoolTest, testing::Values("sqlite", "postgres"),
                         [](const auto& all) { return std::string(all.param); });

TEST_P(OddSchoolTest, ThirtyStationsAreUpdatedOneByOneInMidTerm) {
    constexpr std::size_t kStations = 30;
    furnish(kStations, 1, 20'000);
    // The term begins: server and stations speak version 1.
    auto server = taking(1, 1);
    for (std::size_t i = 0; i < kStations; ++i)
        EXPECT_EQ(pushSpeaking(i, 1), "");
    // Somebody was hasty: a station of the next version is told whose turn it is, and keeps what it has.
    (void)work(*chairs_[0], 20'000);
    EXPECT_THAT(pushSpeaking(0, 2), AllOf(HasSubstr("version 2"), HasSubstr("bring the server up to date")));
    EXPECT_EQ(school_station::waitingIn(chairs_[0]->store(), chairs_[0]->kept()), 1u);
    // The server is updated, and knows both; then the stations, one by one, while the class works on.
    server.reset();
    server = taking(1, 2);
    for (std::size_t updated = 0; updated < kStations; ++updated) {
        const std::size_t other = (updated + 7) % kStations;
        (void)work(*chairs_[updated], 20'000);
        (void)work(*chairs_[other], 20'000);
        EXPECT_EQ(pushSpeaking(updated, 2), "") << updated;
        EXPECT_EQ(pushSpeaking(other, other < updated ? 2 : 1), "") << other;
    }
    // A year later version 1 goes. A station that was in a cupboard is told, and loses nothing.
    server.reset();
    server = taking(2, 3);
    (void)work(*chairs_[7], 20'000);
    EXPECT_THAT(pushSpeaking(7, 1),
                AllOf(HasSubstr("version 1"), HasSubstr("2 to 3"), HasSubstr("bring the station up to date")));
    EXPECT_EQ(pushSpeaking(7, 3), "");
    for (std::size_t i = 0; i < kStations; ++i)
        EXPECT_EQ(pushSpeaking(i, 2), "") << "nothing is left";
    // What is no version is none.
    httplib::Client http(server->address());
    for (const char* odd : {"", "x", "2x", "-2", "+2", "2.0", "99999999999999999999", "0x2"}) {
        const auto told = http.Get("/api/v1/status", {{"Handpiece-Protocol", odd}});
        ASSERT_TRUE(told) << odd;
        EXPECT_EQ(told->status, 426) << odd;
        EXPECT_THAT(told->body, HasSubstr("protocol-other")) << odd;
    }
    server.reset();
    expectAllOnce();
}

/// Server, station, both: a day ahead or behind.
TEST_P(OddSchoolTest, AClockThatIsADayWrongLosesNothingAndIsTold) {
    furnish(4, 0, 0);
    const std::vector<std::pair<std::chrono::seconds, std::chrono::seconds>> pairs{
        {0s, kDay}, {0s, -kDay}, {kDay, 0s}, {-kDay, 0s}};
    giveToDo(nowMs());
    std::string cookie;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const auto [serversS, stationsS] = pairs[i];
        {  // what the class has to do is around the server's own now
            Books open = books();
            school::Teaching(open).setTimes("as1", nowMs(serversS) - kHourMs, nowMs(serversS) + kHourMs, {"server", 1});
        }
        const school::Milliseconds finished = nowMs(stationsS) - 60'000;
        const std::string attempt = work(*chairs_[i], 20'000, finished);
        const auto server = serve(serversS);
        EXPECT_EQ(push(i, stationsS)->end(), 0) << logged();
        const school::Milliseconds ahead = 1000 * (stationsS - serversS).count();
        EXPECT_THAT(logged(), HasSubstr(ahead > 0 ? "clock is 24.0 h ahead of the server's"
                                                  : "clock is 24.0 h behind the server's"));
        const auto there = books().attempt(attempt);
        ASSERT_TRUE(there);
        EXPECT_EQ(there->attempt.finished, finished) << "as its station dated it";
        EXPECT_NEAR(static_cast<double>(there->received - nowMs(serversS)), 0.0, 60'000.0) << "by the server's clock";
        EXPECT_EQ(there->assignment, "as1") << "it was done in time";
        EXPECT_EQ(server->terminate(), 0);
        // Set right, both: it goes on, and nothing comes twice.
        const auto right = serve();
        (void)work(*chairs_[i], 20'000, nowMs() - 60'000);
        EXPECT_EQ(push(i)->end(), 0) << logged();
        EXPECT_EQ(right->terminate(), 0);
    }
    expectAllOnce();
}

TEST_P(OddSchoolTest, ALogInOfAServerWhoseClockIsSetRightEndsOrGoesOn) {
    furnish(1, 0, 0);
    {
        Books open = books();
        open.rename("s000", "Ida", "ida", {"server", 1});
        open.setPassword("s000", school::hashOfPassword(kPassword), {"server", 1});
    }
    for (const std::chrono::seconds ahead : {kDay, -kDay}) {
        Browser student(address());
        {
            const auto wrong = serve(ahead);
            EXPECT_EQ(student.logIn("ida"), 303);
            EXPECT_EQ(student.get("/classes")->status, 200) << "it lasts by the same clock";
            EXPECT_EQ(wrong->terminate(), 0);
        }
        const auto right = serve();
        Browser again(address());
        const auto page = student.get("/classes");
        ASSERT_TRUE(page);
        // Half a day is the longest: a log-in of yesterday is over, and one of tomorrow goes on.
        EXPECT_EQ(page->status, ahead > 0s ? 200 : 303);
        if (page->status == 303) {
            EXPECT_EQ(page->get_header_value("Location"), "/login");
        }
        EXPECT_EQ(again.logIn("ida"), 303) << "and nobody is kept out";
        EXPECT_EQ(right->terminate(), 0);
    }
}

TEST_P(OddSchoolTest, WorkersWhoseClocksDifferByADayDoEachWorkOnce) {
    furnish(2, 10, 5'000);
    {
        const auto server = serve();
        pushAll();
        EXPECT_EQ(server->terminate(), 0);
    }
    std::vector<std::string> words{"serve", "--worker", "--data", data_.string()};
    if (!database_.empty()) words.insert(words.end(), {"--database", database_});
    // Another machine's: where books are on this one alone there is one clock.
    const std::vector<std::chrono::seconds> clocks =
        isPostgres() ? std::vector<std::chrono::seconds>{0s, kDay, -kDay} : std::vector<std::chrono::seconds>{kDay};
    std::vector<std::unique_ptr<Program>> workers;
    for (const std::chrono::seconds ahead : clocks)
        workers.push_back(std::make_unique<Program>(words, log(), ahead));
    EXPECT_TRUE(comesTo([&] { return books().progress("arrival").done == 20; }));
    for (const auto& one : workers)
        EXPECT_EQ(one->terminate(), 0);
    for (const auto& [id, file] : expected_)
        EXPECT_THAT(books().scoresOf(id), SizeIs(1));
    if (!isPostgres()) return;
    // One whose clock is a day ahead dies with a work in its hand: the next has it when its lease is over, not
    // tomorrow.
    (void)work(*chairs_[0], 5'000);
    {
        const auto server = serve();
        EXPECT_EQ(push(0)->end(), 0);
        EXPECT_EQ(server->terminate(), 0);
    }
    Books open = books();
    ASSERT_TRUE(open.takeJob("dies", open.sharedTime(nowMs(kDay)), 500));
    EXPECT_FALSE(open.takeJob("next", open.sharedTime(nowMs(-kDay)), 500)) << "still the other's";
    std::this_thread::sleep_for(600ms);
    EXPECT_TRUE(open.takeJob("next", open.sharedTime(nowMs(-kDay)), 500));
}

/// Exam `id` of class c1, signed by the key in `data`.
void signExamThere(Books& open, const fs::path& data, const std::string& id) {
    const Act act{"server", 1};
    const std::string exercise = rubric::hashText(tasks::contentHash(blockTask()));
    open.add(school::Assignment{id, "c1", exercise, open.pack(exercise)->rubric, "Exam " + id, "exam", "",
                                nowMs() - kHourMs, nowMs() + kHourMs},
             act);
    school::ExamBooks exams(open);
    exams.set(school::ExamSettings{id, 30, ""}, act);
    exams.set(school::ExamCandidate{id, "s017", exam::candidateHash(id, kCandidate), 0, 0, ""}, act);
    exams.set(school::ExamInvigilator{id, "t1", "-"}, act);
    exams.add(school::ExamConfirmation{id, "s017", 0, school::hashOfPassword(kPin)}, act);
    (void)signExam(open, id, examKey(data), act);
}

/// A school with an exam, and a station that is enrolled for exams.
class ExamSchoolTest : public OddSchoolTest {
  protected:
    void SetUp() override {
        OddSchoolTest::SetUp();
        if (IsSkipped()) return;
        School::furnish(data_, database_);
        Books open = books();
        const Act act{"server", 1};
        const school::Person teacher{"t1", "Dr. Sato", "t1", "", "", {"teacher"}, 1, 0};
        open.add(std::span(&teacher, 1), act);
        open.add(school::SchoolClass{"c1", "Class", "", 0, 1, 0}, act);
        const std::vector<school::Enrolment> in{{"c1", "s017", "student"}, {"c1", "t1", "teacher"}};
        open.enrol(in, act);
        signExamThere(open, data_, "ex1");
        open.offerCode(kForExams, "exam room", nowMs() + kHourMs, act, "exam");
    }
    /// For exams, and released.
    void enrol() {
        school_exam::enrolForExams(address(), kForExams, station_);
        Books open = books();
        open.releaseForExams(exam::stationIn(station_).station, {"server", 1});
    }
    static constexpr const char* kForExams = "ABC-DEF-GHJ-KMT";
    fs::path station_ = folder_.path() / "exam";
};
INSTANTIATE_TEST_SUITE_P(OnBoth, ExamSchoolTest, testing::Values("sqlite", "postgres"),
                         [](const auto& all) { return std::string(all.param); });

TEST_P(ExamSchoolTest, RestoredOnANewMachineItsStationsGoOnTakingPacks) {
    std::vector<std::string> place{"--data", data_.string()};
    if (isPostgres()) place.insert(place.end(), {"--database", database_});
    const auto backedUp = [&](const char* name, std::vector<std::string> words) {
        const std::string file = (folder_.path() / name).string();
        words.insert(words.begin(), {"backup", file});
        words.insert(words.end(), place.begin(), place.end());
        EXPECT_EQ(Program(words, log()).end(), 0) << logged();
        return file;
    };
    {
        const auto server = serve();
        enrol();
        EXPECT_THAT(school_exam::fetchExams(station_).packs, SizeIs(1));
        EXPECT_EQ(server->terminate(), 0);
    }
    const std::string whole = backedUp("whole.zip", {}), without = backedUp("without.zip", {"--without-keys"});
    EXPECT_EQ(fs::status(whole).permissions() & (fs::perms::group_all | fs::perms::others_all), fs::perms::none);
    for (const std::string& file : {whole, without}) {
        // That machine is gone. Another one, at the same address.
        data_ = folder_.path() / (file == whole ? "new" : "other");
        const std::string exam = file == whole ? "ex2" : "ex3";
        std::vector<std::string> restore{"restore", file, "--data", data_.string()};
        if (isPostgres()) {
            database_ = postgres()->address(postgres()->newSchema());
            restore.insert(restore.end(), {"--database", database_});
        }
        ASSERT_EQ(Program(restore, log()).end(), 0) << logged();
        {
            Books open = books();
            signExamThere(open, data_, exam);
        }
        const auto server = serve();
        const school_exam::Fetched fetched = school_exam::fetchExams(station_);
        if (file == whole) {
            EXPECT_THAT(fetched.problems, SizeIs(0));
            ASSERT_THAT(fetched.packs, SizeIs(1)) << "the new one";
            EXPECT_EQ(fetched.packs[0].exam, exam);
        } else {
            EXPECT_THAT(fetched.problems, Not(SizeIs(0))) << "of another key";
        }
        EXPECT_EQ(server->terminate(), 0);
    }
}

TEST_P(ExamSchoolTest, AnExamBeginsInItsTimeByTheStationsClockAndSaysWhatThatIs) {
    const auto server = serve();
    enrol();
    EXPECT_THAT(school_exam::fetchExams(station_).packs, SizeIs(1));
    for (const std::chrono::seconds ahead : {-kDay, kDay, 0s}) {
        const fs::path at = folder_.path() / "exam.sock";
        school_exam::ExamService service({station_, at, 50ms}, [ahead] { return nowMs(ahead); });
        std::thread running([&] { service.run(); });
        const school_exam::ExamClient desk(at);
        EXPECT_TRUE(comesTo([&] { return test::errorIdOf([&] { (void)desk.look(kCandidate); }) != "exam-sealed"; }));
        EXPECT_TRUE(comesTo([&] { return test::errorOf([&] { (void)desk.desk(); }).empty(); }));
        const auto refused = test::errorFrom([&] { (void)desk.begin(kCandidate, "t1", kPin); });
        if (ahead == 0s) {
            EXPECT_FALSE(refused) << refused->what();
        } else {
            ASSERT_TRUE(refused) << "begun on another day";
            EXPECT_EQ(refused->id(), ahead < 0s ? "exam-early" : "exam-expired");
            // With both times: whoever stands there sees that the clock is wrong.
            // Its hours may lie in the month before or after.
            const auto month = [](std::chrono::seconds from) { return exam::clockOf(nowMs(from)).substr(0, 8); };
            EXPECT_THAT(refused->what(), AllOf(HasSubstr(exam::clockOf(nowMs(ahead)).substr(0, 10)),
                                               AnyOf(HasSubstr(month(-2h)), HasSubstr(month(2h)))));
        }
        service.stop();
        running.join();
    }
    EXPECT_EQ(server->terminate(), 0);
}

TEST(SameScores, FromTheStationSQLitePostgreSQLAndWorkersElsewhere) {
    const test::TemporaryFolder folder;
    const tasks::Task task = blockTask();
    const rubric::Rubric rubric = rubric::parseRubric(kRubric, "rubric.toml");
    const assessment::Result own = assessment::scoreWork(assessment::readWork(session(), task), task, rubric);
    const std::string ownResult = assessment::resultJson(own.assessment, own.identity);
    std::vector<std::string> results;
    for (const bool onPostgres : {false, true})
        for (const bool elsewhere : {false, true}) {
            if (onPostgres && !postgres()) continue;
            const std::string name = fmt::format("{}{}", onPostgres ? "p" : "s", elsewhere ? "-worker" : "");
            SCOPED_TRACE(name);
            const fs::path data = folder.path() / name, log = folder.path() / (name + ".log");
            const std::string database = onPostgres ? postgres()->address(postgres()->newSchema()) : std::string();
            School::furnish(data, database);
            const int port = freePort();
            std::vector<std::string> place{"--data", data.string()};
            if (onPostgres) place.insert(place.end(), {"--database", database});
            std::vector<std::string> words{"serve", "--listen", fmt::format("127.0.0.1:{}", port), "--workers",
                                           elsewhere ? "0" : "1"};
            words.insert(words.end(), place.begin(), place.end());
            Program server(words, log);
            const std::string address = fmt::format("http://127.0.0.1:{}", port);
            ASSERT_TRUE(comesTo([&] { return bool(httplib::Client(address).Get("/healthz")); }));
            std::unique_ptr<Program> worker;
            if (elsewhere) {
                std::vector<std::string> its{"serve", "--worker"};
                its.insert(its.end(), place.begin(), place.end());
                worker = std::make_unique<Program>(its, log);
            }
            Chair chair;
            school_station::writeEnrolment(school_station::enrol(address, kCode, "s017"), chair.home() / "school.json");
            const std::string attempt = chair.finish(session(), "one.h5", own.assessment.score);
            ASSERT_EQ(Program({"push", "--home", chair.home().string()}, log).end(), 0);
            const Books books(data, database);
            ASSERT_TRUE(comesTo([&] { return books.scoresOf(attempt).size() == 1; }));
            const school::Score score = books.scoresOf(attempt).front();
            EXPECT_EQ(score.state, "proven") << score.reason;
            // To the bit: points, what each was made of, and the tooth that is left.
            EXPECT_EQ(score.score, own.assessment.score);
            EXPECT_EQ(score.maxScore, own.assessment.maxScore);
            EXPECT_EQ(score.wholeScore, own.assessment.wholeScore);
            EXPECT_EQ(score.stateHash, own.identity.stateHash);
            results.push_back(score.result);
            if (worker) {
                EXPECT_EQ(worker->terminate(), 0);
            }
            EXPECT_EQ(server.terminate(), 0);
        }
    ASSERT_GE(results.size(), 2u);
    EXPECT_THAT(ownResult, HasSubstr("\"removed\""));
    for (const std::string& one : results)
        EXPECT_EQ(one, ownResult);
}

/// 20 connections, three of them reserved: fewer than people who come at once.
TEST(FewConnections, WhoComesBeyondThemWaitsAndIsToldWhenItIsTooLong) {
    const std::unique_ptr<test::PostgresServer> few = test::PostgresServer::start(20);
    if (!few) GTEST_SKIP() << "postgresql-15 is not installed";
    const test::TemporaryFolder folder;
    const fs::path data = folder.path() / "school";
    const std::string database = few->address(few->newSchema());
    School::furnish(data, database);
    const School school(data, School::Odd{.database = database});
    // 200 at once: each is answered.
    std::atomic<int> well{0};
    std::vector<std::thread> all;
    for (int i = 0; i < 200; ++i)
        all.emplace_back([&] {
            httplib::Client http(school.address());
            http.set_read_timeout(60);
            for (int k = 0; k < 3; ++k)
                if (const auto page = http.Get("/healthz"); page && page->status == 200) ++well;
        });
    for (std::thread& one : all)
        one.join();
    EXPECT_EQ(well, 600);
    // Other programs have all of them. What ours has it goes on with; then no more.
    std::vector<std::unique_ptr<Books>> others;
    std::string why;
    while (why.empty() && others.size() < 25)
        why = test::errorIdOf([&] { others.push_back(std::make_unique<Books>(data, database, 1s)); });
    EXPECT_EQ(why, "store-full");
    EXPECT_EQ(httplib::Client(school.address()).Get("/healthz")->status, 200) << "by a connection of its own";
    others.resize(others.size() - 2);
    std::this_thread::sleep_for(500ms);
    few->sql("public", "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE application_name = 'handpiece'");
    others.clear();
    why.clear();
    while (why.empty() && others.size() < 25)
        why = test::errorIdOf([&] { others.push_back(std::make_unique<Books>(data, database, 1s)); });
    EXPECT_EQ(why, "store-full");
    httplib::Client http(school.address());
    http.set_read_timeout(60);
    const auto begun = std::chrono::steady_clock::now();
    const auto busy = http.Get("/healthz");
    ASSERT_TRUE(busy);
    EXPECT_EQ(busy->status, 503);
    EXPECT_NE(busy->get_header_value("Retry-After"), "");
    EXPECT_THAT(busy->body, AllOf(HasSubstr("\"store-"), Not(HasSubstr("postgresql://"))));
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 15s);
    const auto page = http.Get("/login", {{"Accept", "text/html"}, {"Accept-Language", "ja"}});
    EXPECT_EQ(page->status, 200) << "that asks no book";
    const auto shown =
        http.Get("/classes",
                 {{"Accept", "text/html"}, {"Accept-Language", "ja"}, {"Cookie", "handpiece=" + std::string(64, 'a')}});
    EXPECT_EQ(shown->status, 503);
    EXPECT_THAT(shown->body, AllOf(HasSubstr("<html lang=\"ja\""), HasSubstr("\xe6\x95\xb0\xe7\xa7\x92")));
    others.clear();
    EXPECT_TRUE(comesTo([&] { return httplib::Client(school.address()).Get("/healthz")->status == 200; }));
}

/// Fewer than ask, by the server's own bound.
TEST(FewConnections, AServersOwnBoundIsKept) {
    const test::TemporaryFolder folder;
    const fs::path data = folder.path() / "school";
    School::furnish(data, {});
    BooksPool pool(data, {}, 2, 300ms);
    auto one = std::make_unique<BooksPool::Lent>(pool.take());
    const BooksPool::Lent two = pool.take();
    const core::Error busy = test::errorFrom([&] { (void)pool.take(); }).value();
    EXPECT_EQ(busy.id(), "store-busy");
    EXPECT_THAT(busy.what(), HasSubstr("try again"));
    // Who waits has the first that comes back.
    std::thread gives([&] {
        std::this_thread::sleep_for(100ms);
        one.reset();
    });
    EXPECT_TRUE(pool.take()->person("s017"));
    gives.join();
}

TEST(WrongClock, ADayOffEndsLogInsAndCodesAndNothingElse) {
    const test::TemporaryFolder folder;
    const fs::path data = folder.path() / "school";
    School::furnish(data);
    constexpr school::Milliseconds kNow = 1'700'000'000'000, kDayMs = 86'400'000;
    Books books(data);
    const Act act{"server", kNow};
    books.offerCode("one-time-code", "chair", kNow + kDayMs / 2, act);
    books.addLogin(std::string(64, 'a'), "s017", kNow + kDayMs / 2, act);
    // A server that is a day ahead: who is logged in logs in again, codes are made anew; a station goes on.
    EXPECT_FALSE(books.personByToken(std::string(64, 'a'), kNow + kDayMs));
    EXPECT_FALSE(books.enrolStation("one-time-code", std::string(32, '1'), std::string(64, 'k'), kNow + kDayMs));
    ASSERT_TRUE(books.enrolStation(kCode, std::string(32, '2'), std::string(64, 'k'), kNow + kDayMs));
    EXPECT_TRUE(books.stationByKey(std::string(64, 'k')));
    // Set right again, a day back: nothing that was made meanwhile is in its way.
    EXPECT_TRUE(books.personByToken(std::string(64, 'a'), kNow));
    school::PushedAttempt p;
    p.attempt.id = school::newId(), p.attempt.exercise = "block", p.attempt.exerciseHash = std::string(16, 'e');
    p.attempt.rubricHash = std::string(16, 'f'), p.attempt.passed = "teacher", p.attempt.result = "{}";
    p.attempt.began = kNow + kDayMs, p.attempt.finished = kNow + kDayMs + 1000;
    p.station = std::string(32, '2'), p.person = "s017", p.received = kNow;
    EXPECT_TRUE(books.push(p)) << "a station whose clock is a day ahead";
    // A lease that was taken in the wrong day: the clock goes back, and the work is done once.
    const auto ahead = books.takeJob("w1", kNow + kDayMs, 60'000);
    if (ahead) {
        EXPECT_FALSE(books.takeJob("w2", kNow, 60'000)) << "lent until a minute into tomorrow";
        EXPECT_TRUE(books.giveBack(*ahead));
        const auto again = books.takeJob("w2", kNow, 60'000);
        ASSERT_TRUE(again);
        EXPECT_TRUE(books.takeJob("w3", kNow + kDayMs, 60'000)) << "the clock jumps: it ran out";
        school::Score score;
        score.attempt = p.attempt.id, score.state = "refused", score.passed = "teacher";
        EXPECT_FALSE(books.finish(*again, score)) << "and is finished by the other alone";
    }
}

}  // namespace
}  // namespace handpiece::school_server::odd_school_test
