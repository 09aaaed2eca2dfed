// SPDX-License-Identifier: Apache-2.0
// An exam from its making to the appeal, over real HTTP, and what was tried against it: each attack that
// docs/school-exams.md says is stopped.
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <map>

#include "handpiece/app/proving/exam_check.h"
#include "handpiece/app/report/exam_pages.h"
#include "handpiece/base/config/words.h"
#include "handpiece/record/session/recorder.h"
#include "handpiece/school/people/secret.h"
#include "handpiece/school/store/books_accounts.h"
#include "school/exam_arrival.h"
#include "school/exam_desk.h"
#include "school/exam_service.h"
#include "school/exam_station.h"
#include "school/server/browser.h"
#include "school/server/school_fixture.h"
#include "school/worker.h"
#include "support/error_of.h"

namespace handpiece::school_exam::exam_server_test {
namespace {

using school_server::School;
using school_server::session;
using test::errorIdOf;
using test::errorOf;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
namespace fs = std::filesystem;
using school::Act;
using school::Books;
using school::ExamBooks;

const std::string kPins[] = {"PPP-QQQ-RRR-SSS", "PPP-QQQ-RRR-SST", "PPP-QQQ-RRR-SSV"}, &kPin = kPins[0];
const std::string kCandidate = "123-456-789-ABC", kOther = "ABC-456-789-ABC";
using school_server::kPassword;
constexpr const char* kExamCode = "ABC-DEF-GHJ-KMR";

/// A station's service in a thread.
class Service {
  public:
    explicit Service(const fs::path& folder, std::chrono::milliseconds every = std::chrono::milliseconds(50))
        : socket_(folder.string() + ".sock"), service_({folder, socket_, every}) {
        thread_ = std::thread([this] { service_.run(); });
        while (!errorIdOf([&] { (void)client().desk(); }).empty())
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    ~Service() { stop(); }
    void stop() {
        service_.stop();
        if (thread_.joinable()) thread_.join();
    }
    [[nodiscard]] ExamClient client() const { return ExamClient(socket_); }

  private:
    fs::path socket_;
    ExamService service_;
    std::thread thread_;
};

template <class Condition>
bool soon(Condition isSo) {
    for (int i = 0; i < 4000; ++i) {
        if (isSo()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
}

class ExamTest : public school_server::SchoolTest {
  protected:
    void SetUp() override {
        SchoolTest::SetUp();
        Books open(data());
        const Act act{"server", 1};
        const std::string hash = school::hashOfPassword(kPassword);
        const auto person = [&](const char* code, const char* name, const char* role) {
            return school::Person{code, name, code, "", hash, {role}, 1, 0};
        };
        const std::vector<school::Person> people{
            person("t1", "Dr. Sato", "teacher"), person("t2", "Dr. Abe", "teacher"),
            person("e1", "Dr. Mori", "examiner"), person("s018", "Jun", "student")};
        open.add(people, act);
        open.setPassword("s017", hash, act);
        open.add(school::SchoolClass{"c1", "Operative", "", 0, 1, 0}, act);
        const std::vector<school::Enrolment> in{
            {"c1", "s017", "student"}, {"c1", "s018", "student"}, {"c1", "t1", "teacher"}, {"c1", "e1", "examiner"}};
        open.enrol(in, act);
        const std::string exercise = rubric::hashText(tasks::contentHash(school_server::blockTask()));
        now_ = school_server::systemClock()();
        open.add(school::Assignment{"ex1", "c1", exercise, open.pack(exercise)->rubric, "Block exam", "exam", "",
                                    now_ - 3'600'000, now_ + 3'600'000},
                 act);
        ExamBooks exams(open);
        exams.set(school::ExamSettings{"ex1", 30, "undo reset"}, act);
        exams.set(school::ExamCandidate{"ex1", "s017", exam::candidateHash("ex1", kCandidate), 25, 0, ""}, act);
        exams.set(school::ExamCandidate{"ex1", "s018", exam::candidateHash("ex1", kOther), 0, 0, ""}, act);
        exams.set(school::ExamInvigilator{"ex1", "t1", "-"}, act);
        for (const char* candidate : {"s017", "s018"})
            for (const std::string& pin : kPins)
                exams.add(school::ExamConfirmation{"ex1", candidate, 0, hashOf(pin)}, act);
        (void)school_server::signExam(open, "ex1", school_server::examKey(data()), act);
        open.offerCode(kExamCode, "exam room, 1", 4'000'000'000'000, act, "exam");
    }
    static const std::string& hashOf(const std::string& pin) {
        static std::map<std::string, std::string> hashes;
        std::string& hash = hashes[pin];
        if (hash.empty()) hash = school::hashOfPassword(pin);
        return hash;
    }
    [[nodiscard]] fs::path service() const { return folder_.path() / "exam"; }
    /// As an administrator does, of what is enrolled by now.
    void release() const {
        Books open(data());
        for (const school::Station& one : school::BooksAccounts(open).stations())
            if (one.kind == "exam") open.releaseForExams(one.id, {"server", 1});
    }
    void setUpStation(const School& school) const {
        enrolForExams(school.address(), kExamCode, service());
        release();
        EXPECT_THAT(fetchExams(service()).packs, SizeIs(1));
        openExams(service(), now_);
    }
    /// From the beginning to what the server made of it.
    std::string sit(const Service& at, const fs::path& recording, const std::string& code = kCandidate,
                    const std::string& pin = kPin) {
        const std::string sitting = at.client().begin(code, "t1", pin).sitting;
        (void)at.client().finish(sitting, {recording});
        return sitting;
    }
    [[nodiscard]] bool hasArrived(const std::string& sitting) const {
        Books open(data());
        const auto attempt = open.attempt(sitting);
        return attempt && open.missingFiles(attempt->station).empty();
    }
    void prove() const {
        school_server::Worker worker(school_server::worksOf({data()}, school_server::systemClock()));
        while (worker.workOnce()) {
        }
    }
    [[nodiscard]] std::vector<std::string> doubts(const std::string& sitting) const {
        Books open(data());
        std::vector<std::string> all = school_server::doubtsOf(open, *ExamBooks(open).sitting(sitting));
        const config::LanguageHere japanese("ja");
        for (const std::string& one : all)
            EXPECT_NE(report::doubtWords(one), one) << "it has no words of another language";
        return all;
    }
    /// A hand that was made up, at 1 kHz.
    static fs::path madeUp(const fs::path& file, int seconds, int seed, bool undoes = false) {
        session::Recorder recorder(file, {1000, "child", "test", "{}", {}});
        for (int i = 0; i < 1000 * seconds; ++i) {
            session::Record record;
            record.tick = static_cast<std::uint64_t>(i);
            record.position = {seed * i, i, -i};
            recorder.pushWaiting(record);
        }
        if (undoes) recorder.event(1500, session::EventName::undo);
        recorder.close();
        return file;
    }

    school::Milliseconds now_ = 0;
};

TEST_F(ExamTest, IsFetchedSatWithoutTheNetworkToldAndProven) {
    std::string sitting;
    int port = 0;
    {
        School school(data());
        port = school.port();
        setUpStation(school);
        EXPECT_THAT(fetchExams(service()).packs, IsEmpty()) << "it is here already";
    }
    // The network is gone.
    {
        const Service at(service());
        EXPECT_THAT(at.client().look(kCandidate),
                    AllOf(HasSubstr("\"title\":\"Block exam\""), HasSubstr("\"time_ms\":2250000"),
                          HasSubstr("\"locked\":[\"undo\",\"reset\"]")));
        EXPECT_TRUE(at.client().desk().sitting.empty()) << "who looks begins nothing";
        const Desk desk = at.client().begin(kCandidate, "t1", kPin);
        EXPECT_EQ(desk.title, "Block exam");
        EXPECT_EQ(desk.deadline - desk.began, 37 * 60'000 + 30'000) << "with a quarter more time";
        EXPECT_THAT(desk.locked, ElementsAre("undo", "reset"));
        const fs::path exercise = folder_.path() / "exercise.handpiece";
        at.client().keepExercise(exercise);
        EXPECT_EQ(tasks::contentHash(tasks::readTask(exercise)), tasks::contentHash(school_server::blockTask()));
        sitting = desk.sitting;
        const exam::Signed entry = exam::parted(at.client().finish(sitting, {session()}), "");
        EXPECT_EQ(exam::entryFrom(entry.text, "").files.front().file, school::sha256Of(session()));
        EXPECT_TRUE(soon([&] { return !at.client().desk().trouble.empty(); }));
        EXPECT_THAT(at.client().desk().trouble, HasSubstr("nobody answers there"));
        EXPECT_TRUE(at.client().desk().sitting.empty());
        EXPECT_EQ(at.client().ending(sitting), exam::joined(entry));
        EXPECT_EQ(at.client().receipt(sitting), "") << "the school has not heard of it";
        EXPECT_EQ(errorIdOf([&] { (void)at.client().ending(std::string(32, '0')); }), "exam-none");
        EXPECT_EQ(at.client().receipt("../../station"), "");
    }
    School school(data(), 0, port);
    const Service at(service());
    ASSERT_TRUE(soon([&] { return hasArrived(sitting); })) << at.client().desk().trouble;
    // The station has the school's receipt by then, and no other station gets it.
    ASSERT_TRUE(soon([&] { return !at.client().receipt(sitting).empty(); })) << at.client().desk().trouble;
    const exam::Receipt fetched =
        exam::openedReceipt(at.client().receipt(sitting), exam::stationIn(service()).serverKey, "");
    EXPECT_EQ(fetched.sitting, sitting);
    EXPECT_THAT(fetched.files, ElementsAre(school::sha256Of(session())));
    {
        Books(data()).offerCode("ABC-DEF-GHJ-KMT", "exam room, 2", 4'000'000'000'000, {"server", 1}, "exam");
        const school_station::Enrolment other = school_station::enrol(school.address(), "ABC-DEF-GHJ-KMT", "", "exam");
        release();
        httplib::Client http(school.address());
        const httplib::Headers headers{{"Handpiece-Protocol", "1"}, {"Authorization", "Bearer " + other.key}};
        EXPECT_EQ(http.Get("/api/v1/exams/sittings/" + sitting + "/receipt", headers)->status, 404);
    }
    prove();
    EXPECT_EQ(scoresOf(sitting).back().state, "proven") << scoresOf(sitting).back().reason;
    EXPECT_EQ(scoresOf(sitting).back().reason, "") << "a station that says no score says no other one";
    EXPECT_EQ(books().attempt(sitting)->person, "s017");
    EXPECT_THAT(doubts(sitting), IsEmpty());
    // The receipt, checked by the key that the server tells everybody.
    Books open(data());
    const std::string receipt = exam::joined(
        school_server::receiptOf(open, *ExamBooks(open).sitting(sitting), school_server::examKey(data()), now_));
    httplib::Client http(school.address());
    std::string key = http.Get("/exam-key")->body;
    key.pop_back();
    const exam::Receipt read = exam::openedReceipt(receipt, key, "");
    EXPECT_EQ(read.state, "proven");
    EXPECT_THAT(read.files, ElementsAre(school::sha256Of(session())));
    EXPECT_EQ(read.verdict, "to be confirmed");
    EXPECT_THAT(receipt, AllOf(Not(HasSubstr("s017")), Not(HasSubstr("Ida"))));
    EXPECT_EQ(fs::status(data() / "exam.key").permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST(ExamDoubts, AreToldInThePagesLanguage) {
    const auto in = [](const char* language, const char* said) {
        const config::LanguageHere here(language);
        return report::doubtWords(said);
    };
    for (const char* said :
         {"it was handed over 125 s late", "nothing was heard of the work before it was handed over",
          "nothing was heard of the work for 130 s", "recording 1: undo was used 2 times, and it was locked",
          "recording 1 is another than the one that was noted during the work (at tick 2000)",
          "recording 2 went back from 3000 to 2000 ticks", "it was begun before the exam opened, 2026-11-26 15:08 UTC"})
        EXPECT_EQ(in("en", said), said);
    EXPECT_EQ(in("ja", "it was handed over 125 s late"), "125 s 遅れて提出されました");
    EXPECT_EQ(in("ja", "nothing was heard of the work before it was handed over"),
              "提出されるまで、作業の知らせがありませんでした");
    EXPECT_EQ(in("ja", "nothing was heard of the work for 130 s"), "作業の知らせが 130 s ありませんでした");
    EXPECT_EQ(in("ja", "recording 1: undo was used 2 times, and it was locked"),
              "記録 1：使えないはずの undo が 2 回使われました");
    EXPECT_EQ(in("ja", "recording 2 went back from 3000 to 2000 ticks"),
              "記録 2 が 3000 から 2000 ティックに戻りました");
    EXPECT_EQ(in("ja", "something of a newer server"), "something of a newer server");
}

TEST_F(ExamTest, ARecordingThatWasSwappedIsFound) {
    const fs::path shown = madeUp(folder_.path() / "shown.h5", 4, 1), other = madeUp(folder_.path() / "other.h5", 4, 2);
    exam::Entry begun, noted, finished;
    begun.kind = "begun", begun.at = 1'000'000;
    noted.kind = "checkpoint", noted.at = begun.at + 4'000, noted.part = 1;
    proving::RecordedInputs inputs(shown);
    inputs.goOn(2000);
    EXPECT_EQ(inputs.ticks(), 2000);
    noted.ticks = inputs.ticks(), noted.inputs = inputs.hash();
    finished.kind = "finished", finished.at = begun.at + 5'000;
    const std::vector<exam::Entry> entries{begun, noted, finished};
    EXPECT_THAT(proving::recordingDoubts({}, entries, std::vector<fs::path>{shown}), IsEmpty());
    EXPECT_THAT(proving::recordingDoubts({}, entries, std::vector<fs::path>{other}),
                ElementsAre(HasSubstr("another than the one that was noted during the work (at tick 2000)")));
    // Cut short, and in two pieces of which one was kept back.
    const fs::path brief = madeUp(folder_.path() / "brief.h5", 1, 1);
    EXPECT_THAT(proving::recordingDoubts({}, entries, std::vector<fs::path>{brief}), SizeIs(1));
    std::vector<exam::Entry> two = entries;
    two[1].part = 2;
    EXPECT_THAT(proving::recordingDoubts({}, two, std::vector<fs::path>{shown}),
                ElementsAre(HasSubstr("recording 2 was noted during the work and not handed over")));
}

TEST_F(ExamTest, ARecordingOfBeforeRunsFasterThanTheTime) {
    const fs::path made = madeUp(folder_.path() / "made.h5", 60, 1);
    proving::RecordedInputs inputs(made);
    inputs.goOn();
    exam::Entry begun, noted, finished;
    begun.kind = "begun", begun.at = 1'000'000;
    noted.kind = "checkpoint", noted.at = begun.at + 5'000, noted.part = 1;
    noted.ticks = inputs.ticks(), noted.inputs = inputs.hash();
    finished.kind = "finished", finished.at = begun.at + 6'000;
    EXPECT_THAT(proving::recordingDoubts({}, std::vector{begun, noted, finished}, std::vector<fs::path>{made}),
                ElementsAre("recording 1 ran 55 s faster than the time"));
    // Nothing said of it until the end is as fast.
    EXPECT_THAT(proving::recordingDoubts({}, std::vector{begun, finished}, std::vector<fs::path>{made}),
                ElementsAre("recording 1 ran 54 s faster than the time"));
    noted.at = begun.at + 58'000, finished.at = begun.at + 59'000;
    EXPECT_THAT(proving::recordingDoubts({}, std::vector{begun, noted, finished}, std::vector<fs::path>{made}),
                IsEmpty());
}

TEST_F(ExamTest, WhatWasLockedAndUsedIsFound) {
    const fs::path made = madeUp(folder_.path() / "made.h5", 2, 1, true);
    exam::Entry begun;
    begun.kind = "begun";
    EXPECT_THAT(proving::recordingDoubts({"undo"}, std::vector{begun}, std::vector<fs::path>{made}),
                ElementsAre("recording 1: undo was used 1 times, and it was locked"));
    EXPECT_THAT(proving::recordingDoubts({"guide"}, std::vector{begun}, std::vector<fs::path>{made}), IsEmpty());
}

TEST_F(ExamTest, BeginningAgainAndAtAnotherStationShow) {
    School school(data());
    setUpStation(school);
    {
        Books open(data());
        open.offerCode("ABC-DEF-GHJ-KMT", "exam room, 2", 4'000'000'000'000, {"server", 1}, "exam");
    }
    const fs::path second = folder_.path() / "exam2";
    enrolForExams(school.address(), "ABC-DEF-GHJ-KMT", second);
    release();
    EXPECT_THAT(fetchExams(second).packs, SizeIs(1));
    openExams(second, now_);
    const Service here(service()), there(second);
    const std::string first = sit(here, session()), again = sit(here, session(), kCandidate, kPins[1]);
    ASSERT_TRUE(soon([&] { return hasArrived(first) && hasArrived(again); }));
    // A code that was typed here is typed there: that station cannot know.
    const std::string elsewhere = sit(there, session());
    ASSERT_TRUE(soon([&] { return hasArrived(first) && hasArrived(again) && hasArrived(elsewhere); }));
    EXPECT_THAT(doubts(first), ElementsAre("this candidate has begun 1 times at other stations, too"));
    EXPECT_THAT(doubts(again), testing::Contains("this candidate had begun 1 times here before"));
    EXPECT_THAT(doubts(elsewhere),
                ElementsAre("the code that confirmed the identity had been used for another beginning",
                            "this candidate has begun 2 times at other stations, too"));
    // Another person's session is not this one's work.
    const std::string borrowed = sit(here, session(), kOther);
    ASSERT_TRUE(soon([&] { return hasArrived(borrowed); }));
    prove();
    EXPECT_THAT(scoresOf(borrowed).back().reason, HasSubstr("another person's work"));
}

TEST_F(ExamTest, OnlyTheServiceOfAStationTellsOfAnExam) {
    School school(data());
    setUpStation(school);
    std::string sitting;
    {
        const Service at(service());
        sitting = sit(at, session());
        ASSERT_TRUE(soon([&] { return hasArrived(sitting); }));
    }
    // A student's own enrolment: not as work on the exam, and with no entries.
    school_server::Chair chair;
    school_station::Enrolment own = school_station::enrol(school.address(), school_server::kCode, "s017");
    school::PushedAttempt p;
    p.attempt = *chair.store().attempt(chair.finish(session(), "one.h5"));
    p.person = "s017", p.assignment = "ex1";
    const httplib::Headers headers{{"Handpiece-Protocol", "1"}, {"Authorization", "Bearer " + own.key}};
    httplib::Client http(school.address());
    auto answer = http.Post("/api/v1/attempts", headers, school_wire::toJson(p), "application/json");
    EXPECT_EQ(answer->status, 400);
    EXPECT_THAT(answer->body, HasSubstr("service of its station alone"));
    EXPECT_THAT(http.Get("/api/v1/tasks/s017", headers)->body, Not(HasSubstr("ex1")));
    // Nor does it count as work of a class for somebody who is no student there.
    const std::string exercise = rubric::hashText(tasks::contentHash(school_server::blockTask()));
    Books(data()).add(school::Assignment{"as9", "c1", exercise, Books(data()).pack(exercise)->rubric, "Block",
                                         "practice", "", 1, 4'000'000'000'000},
                      {"server", 1});
    p.assignment = "as9", p.person = "t1", p.files = {school::sha256Of(session())};
    answer = http.Post("/api/v1/attempts", headers, school_wire::toJson(p), "application/json");
    EXPECT_EQ(answer->status, 400);
    EXPECT_THAT(answer->body, HasSubstr("no student of the class"));
    p.person = "s017";
    EXPECT_EQ(http.Post("/api/v1/attempts", headers, school_wire::toJson(p), "application/json")->status, 201);
    exam::Entry e;
    e.station = own.station, e.number = 1, e.previous = exam::kNoEntry, e.at = now_, e.kind = "started";
    const exam::SigningKey key = exam::newSigningKey();
    const std::string text = exam::toText(e);
    const std::string entry = exam::joined({text, exam::signatureOf(text, key)});
    EXPECT_EQ(http.Post("/api/v1/exams/chain", headers, entry, "text/plain")->status, 403) << "no station for exams";
    // With the exam station's own way to the server and another key, and what is no entry.
    const exam::StationIdentity station = exam::stationIn(service());
    const httplib::Headers its{{"Handpiece-Protocol", "1"}, {"Authorization", "Bearer " + station.key}};
    EXPECT_EQ(http.Post("/api/v1/exams/chain", its, entry, "text/plain")->status, 403);
    for (const std::string& nonsense : {std::string(), std::string("x"), std::string(5000, 'x'), entry.substr(3)})
        EXPECT_THAT(http.Post("/api/v1/exams/chain", its, nonsense, "text/plain")->status, testing::AnyOf(400, 403))
            << nonsense;
    EXPECT_EQ(http.Post("/api/v1/exams/station", its, key.open, "text/plain")->status, 409) << "another key";
    EXPECT_EQ(http.Post("/api/v1/exams/chain", entry, "text/plain")->status, 426) << "nobody";
    // What was noted is told once; put back from a copy and gone on otherwise it is another chain.
    const std::string chain = http.Get("/api/v1/exams/chain", its)->body;
    const fs::path last = service() / "chain" / "0000000004.txt";
    ASSERT_TRUE(core::isThere(last)) << chain;
    fs::remove(last);
    {
        const Service at(service());
        EXPECT_TRUE(soon([&] { return at.client().desk().trouble.find("another content") != std::string::npos; }))
            << at.client().desk().trouble;
    }
    EXPECT_THAT(doubts(sitting), testing::Contains(HasSubstr("changed or put back from a copy")));
    EXPECT_EQ(http.Get("/api/v1/exams/chain", its)->body, chain) << "what is there stays";
    // The key of the server is pinned: a pack of another school that says it is this one is refused.
    const school::ExamPack pack = *ExamBooks(*std::make_unique<Books>(data())).newestPack("ex1");
    exam::Pack easier = exam::packFrom(pack.text, "");
    easier.version = 9, easier.minutes = 1440;
    const std::string forged = exam::toText(easier);
    EXPECT_EQ(errorIdOf([&] {
                  (void)exam::installPack(service(), {forged, exam::signatureOf(forged, key)}, {});
              }),
              "exam-other-key");
    EXPECT_EQ(errorIdOf([&] {
                  (void)exam::installPack(service(), {forged, {pack.key, pack.signature}}, {});
              }),
              "exam-changed");
}

TEST_F(ExamTest, APracticeStationsKeyOpensNothingOfAnExam) {
    School school(data());
    // The key lies in the student's own account. With it a whole exam was made: a key of one's own, then a chain.
    const school_station::Enrolment own = school_station::enrol(school.address(), school_server::kCode, "s017");
    const exam::SigningKey key = exam::newSigningKey();
    httplib::Client http(school.address());
    const auto refused = [&](const std::string& stationKey) {
        const httplib::Headers headers{{"Handpiece-Protocol", "1"}, {"Authorization", "Bearer " + stationKey}};
        exam::Entry e;
        e.station = own.station, e.number = 1, e.previous = exam::kNoEntry, e.at = now_, e.kind = "started";
        const std::string text = exam::toText(e);
        int count = 0;
        const auto look = [&](const httplib::Result& answer) {
            count += answer && answer->status == 403 && answer->body.find("may hold no exams") != std::string::npos;
        };
        look(http.Get("/api/v1/exams", headers));
        look(http.Get("/api/v1/exams/ex1/pack", headers));
        look(http.Get("/api/v1/exams/ex1/exercise", headers));
        look(http.Get("/api/v1/exams/ex1/opening", headers));
        look(http.Get("/api/v1/exams/chain", headers));
        look(http.Post("/api/v1/exams/chain", headers, exam::joined({text, exam::signatureOf(text, key)}),
                       "text/plain"));
        look(http.Get("/api/v1/exams/sittings/" + std::string(32, 'a') + "/receipt", headers));
        return count;
    };
    const httplib::Headers its{{"Handpiece-Protocol", "1"}, {"Authorization", "Bearer " + own.key}};
    EXPECT_EQ(http.Post("/api/v1/exams/station", its, key.open, "text/plain")->status, 403);
    EXPECT_EQ(refused(own.key), 7);
    // Nor does a code for exams by itself, until an administrator has looked at the station.
    enrolForExams(school.address(), kExamCode, service());
    const std::string stations = exam::stationIn(service()).key;
    EXPECT_EQ(refused(stations), 7);
    EXPECT_EQ(errorIdOf([&] { (void)fetchExams(service()); }), "exam-station");
    Books open(data());
    EXPECT_EQ(errorIdOf([&] { open.releaseForExams(own.station, {"server", 1}); }), "books-unknown");
    release();
    EXPECT_EQ(refused(stations), 0);
    EXPECT_THAT(fetchExams(service()).packs, SizeIs(1));
}

// With an exam station's key, wherever it came from, a whole exam was told: "identity confirmed".
TEST_F(ExamTest, WhoHasNoInvigilatorsCodeTellsOfNoBeginning) {
    School school(data());
    setUpStation(school);
    const exam::StationIdentity station = exam::stationIn(service());
    const exam::SigningKey key = exam::keptSigningKey(service() / "station.key");
    Books open(data());
    exam::ChainEnd end{0, exam::kNoEntry};
    const auto tell = [&](exam::Entry e) {
        e.station = station.station, e.number = end.number + 1, e.previous = end.hash, e.at = now_;
        const std::string text = exam::toText(e);
        (void)school_server::takeEntry(open, station.station, exam::joined({text, exam::signatureOf(text, key)}), now_);
        end = {e.number, exam::hashOfEntry(text)};
    };
    exam::Entry started, begun;
    started.kind = "started";
    tell(started);
    begun.kind = "begun", begun.sitting = school::newId(), begun.exam = "ex1", begun.invigilator = "t1";
    begun.pack = ExamBooks(open).newestPack("ex1")->hash, begun.candidate = exam::candidateHash("ex1", kCandidate);
    for (const std::string& code : {std::string(), std::string("PPP-QQQ-RRR-SSW"), hashOf(kPin).substr(0, 20)}) {
        begun.confirmation = code.find('$') == code.npos ? code : "x";
        EXPECT_EQ(errorIdOf([&] { tell(begun); }), "exam-invigilator") << code;
    }
    EXPECT_FALSE(ExamBooks(open).sitting(begun.sitting));
    begun.confirmation = kPins[2];
    tell(begun);
    EXPECT_EQ(ExamBooks(open).sitting(begun.sitting)->confirmation, 3);
    // A pack of before the sheets says on the station's word alone, which shows.
    const exam::Pack newest = exam::packFrom(ExamBooks(open).newestPack("ex1")->text, "");
    exam::Pack before = newest;
    before.format = 1, before.version = newest.version + 1, before.invigilators = {{"t1", hashOf(kPin)}};
    school::ExamPack kept;
    kept.exam = "ex1", kept.version = before.version, kept.text = exam::toText(before);
    kept.hash = school::sha256(kept.text), kept.made = now_;
    const exam::Signature signature = exam::signatureOf(kept.text, school_server::examKey(data()));
    kept.key = signature.key, kept.signature = signature.value;
    (void)ExamBooks(open).add(kept, {"server", 1});
    exam::Entry given = begun;
    given.kind = "given-up", given.confirmation = "PPP-QQQ-RRR-SSW";
    EXPECT_EQ(errorIdOf([&] { tell(given); }), "exam-invigilator");
    given.confirmation = kPins[1];
    tell(given);
    // Spent, each of them, also by who has the station's keys.
    exam::Entry again = begun;
    again.sitting = school::newId();
    for (const int spent : {1, 2}) {
        again.confirmation = kPins[spent];
        EXPECT_EQ(errorIdOf([&] { tell(again); }), "exam-invigilator") << spent;
    }
    begun.pack = kept.hash, begun.sitting = school::newId(), begun.format = 1, begun.confirmation.clear();
    tell(begun);
    EXPECT_THAT(doubts(begun.sitting), testing::Contains(HasSubstr("is its station's word")));
}

TEST_F(ExamTest, ItsExerciseIsSealedUntilItOpens) {
    {
        Books open(data());
        const Act act{"server", 1};
        const std::string known = rubric::hashText(tasks::contentHash(school_server::blockTask()));
        tasks::Task other = school_server::blockTask();
        other.voxelMm = 0.09;
        const std::vector<std::byte> bytes = tasks::packedTask(other);
        const std::string file = school::sha256({reinterpret_cast<const char*>(bytes.data()), bytes.size()}),
                          exercise = rubric::hashText(tasks::contentHash(other));
        (void)open.append({std::string(32, '0'), file, bytes.size()}, 0, bytes, 1);
        open.add(school::Pack{exercise, file, "block", "Block", open.pack(known)->rubric, 1}, act);
        open.add(school::Assignment{"ex2", "c1", exercise, open.pack(known)->rubric, "Tomorrow's", "exam", "",
                                    now_ + 86'400'000, now_ + 90'000'000},
                 act);
        ExamBooks exams(open);
        exams.set(school::ExamSettings{"ex2", 30, ""}, act);
        exams.set(school::ExamCandidate{"ex2", "s017", exam::candidateHash("ex2", kCandidate), 0, 0, ""}, act);
        exams.set(school::ExamInvigilator{"ex2", "t1", "-"}, act);
        EXPECT_EQ(errorIdOf([&] { (void)school_server::signExam(open, "ex2", school_server::examKey(data()), act); }),
                  "exam-empty")
            << "without the sheet nobody could begin";
        exams.add(school::ExamConfirmation{"ex2", "s017", 0, hashOf(kPin)}, act);
        (void)school_server::signExam(open, "ex2", school_server::examKey(data()), act);
        const auto again = school_server::signExam(open, "ex2", school_server::examKey(data()), act);
        EXPECT_EQ(again.version, 1) << "the same again is the same pack";
    }
    School school(data());
    enrolForExams(school.address(), kExamCode, service());
    release();
    EXPECT_THAT(fetchExams(service()).packs, SizeIs(2));
    openExams(service(), now_ + 86'400'000);  // by a clock that is a day ahead
    std::vector<std::string> problems;
    for (const exam::Installed& one : exam::packsIn(service(), problems))
        EXPECT_EQ(one.isSealed, one.pack.exam == "ex2") << "the server's clock decides";
    EXPECT_THAT(problems, IsEmpty());
    httplib::Client http(school.address());
    const httplib::Headers its{{"Handpiece-Protocol", "1"},
                               {"Authorization", "Bearer " + exam::stationIn(service()).key}};
    EXPECT_NE(http.Get("/api/v1/exams/ex2/opening", its)->status, 200);
    EXPECT_EQ(http.Get("/api/v1/exams/ex1/opening", its)->status, 200);
    const std::string bytes = http.Get("/api/v1/exams/ex2/exercise", its)->body;
    EXPECT_EQ(bytes.rfind("handpiece sealed exercise 1\n", 0), 0u);
    // Where the network is not, by the sheet.
    std::string code;
    {
        Books open(data());
        code = *ExamBooks(open).openingCode("ex2");
    }
    const Service at(service());
    EXPECT_EQ(errorIdOf([&] { at.client().open("AAA-AAA-AAA-AAA"); }), "exam-seal");
    at.client().open(code);
    for (const exam::Installed& one : exam::packsIn(service(), problems))
        EXPECT_FALSE(one.isSealed);
}

// Any account of a station may speak to its service's socket.
TEST_F(ExamTest, AnotherAccountOfTheStationHasNoHandInAnExam) {
    if (::geteuid() != 0) GTEST_SKIP() << "only root can ask as another account";
    School school(data());
    setUpStation(school);
    const Service at(service());
    fs::permissions(folder_.path(), fs::perms::all);
    // The child is one account, this process another: the exam is begun by 4001, and 4002 comes to it.
    const auto as = [&](uid_t account, const std::function<std::string()>& what) {
        int lines[2];
        EXPECT_EQ(::pipe(lines), 0);
        const pid_t child = ::fork();
        if (child == 0) {
            ::close(lines[0]);
            std::string said = "cannot be that account";
            if (::setgid(account) == 0 && ::setuid(account) == 0) said = what();
            (void)!::write(lines[1], said.data(), said.size());
            ::_exit(0);
        }
        ::close(lines[1]);
        std::string said;
        char some[256];
        for (ssize_t n = 0; (n = ::read(lines[0], some, sizeof some)) > 0;)
            said.append(some, static_cast<std::size_t>(n));
        ::close(lines[0]);
        ::waitpid(child, nullptr, 0);
        return said;
    };
    const ExamClient client = at.client();
    const std::string sitting = as(4001, [&] { return client.begin(kCandidate, "t1", kPin).sitting; });
    ASSERT_EQ(sitting.size(), 32u) << sitting;
    const fs::path copy = folder_.path() / "copy.h5";
    fs::copy_file(session(), copy);
    fs::permissions(copy, fs::perms::all);
    const auto id = [](const auto& what) { return errorIdOf(what); };
    EXPECT_EQ(as(4002, [&] { return id([&] { client.checkpoint(sitting, 1, 5, std::string(64, '1')); }); }),
              "exam-account");
    EXPECT_EQ(as(4002, [&] { return id([&] { (void)client.finish(sitting, {copy}); }); }), "exam-account");
    EXPECT_EQ(as(4002, [&] { return id([&] { client.keepExercise(folder_.path() / "x.handpiece"); }); }),
              "exam-account");
    EXPECT_EQ(as(4002,
                 [&] {
                     std::string last;
                     for (int i = 0; i < 8; ++i)
                         last = id([&] { client.giveUp(sitting, "t1", "AAA-AAA-AAA-AAA"); });
                     return last;
                 }),
              "exam-account");
    EXPECT_EQ(as(4001, [&] { return id([&] { client.giveUp(sitting, "t1", kPins[1]); }); }), "")
        << "nobody else's guesses make the invigilator wait";
}

TEST_F(ExamTest, AnotherAccountThatHoldsOnHoldsNobodyElse) {
    if (::geteuid() != 0) GTEST_SKIP() << "only root can ask as another account";
    School school(data());
    setUpStation(school);
    const Service at(service());
    fs::permissions(folder_.path(), fs::perms::all);
    const std::string socketFile = service().string() + ".sock";
    int lines[2];
    ASSERT_EQ(::pipe(lines), 0);
    const pid_t holder = ::fork();
    if (holder == 0) {
        if (::setgid(4003) != 0 || ::setuid(4003) != 0) ::_exit(1);
        sockaddr_un to{};
        to.sun_family = AF_UNIX;
        socketFile.copy(to.sun_path, sizeof to.sun_path - 1);
        std::vector<int> held;
        for (bool isTold = false;;) {
            for (const int one : held)
                if (::send(one, "a", 1, MSG_NOSIGNAL) < 0) ::close(one);
            for (int i = 0; i < 30; ++i) {
                const int one = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
                if (::connect(one, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0 &&
                    ::send(one, "GET /desk HTTP/1.1\r\nX: ", 23, MSG_NOSIGNAL) == 23)
                    held.push_back(one);
                else
                    ::close(one);
            }
            if (!isTold) isTold = ::write(lines[1], "h", 1) == 1;
            ::usleep(200'000);
        }
    }
    char one = 0;
    ASSERT_EQ(::read(lines[0], &one, 1), 1);
    for (int i = 0; i < 10; ++i)
        EXPECT_EQ(errorIdOf([&] { (void)at.client().desk(); }), "");
    EXPECT_EQ(at.client().begin(kCandidate, "t1", kPin).title, "Block exam");
    ::kill(holder, SIGKILL);
    ::waitpid(holder, nullptr, 0);
    ::close(lines[0]), ::close(lines[1]);
}

TEST_F(ExamTest, AServiceThatIsKilledLosesNothing) {
    School school(data());
    setUpStation(school);
    std::string sitting;
    {
        const Service at(service(), std::chrono::hours(1));
        sitting = at.client().begin(kCandidate, "t1", kPin).sitting;
        EXPECT_EQ(errorIdOf([&] { Service other(service()); }), "exam-busy");
    }
    {
        const Service at(service());
        EXPECT_EQ(at.client().desk().sitting, sitting);
        (void)at.client().finish(sitting, {session()});
        ASSERT_TRUE(soon([&] { return hasArrived(sitting); }));
    }
    EXPECT_THAT(doubts(sitting), ElementsAre("the station's service was started again 1 times"));
}

TEST_F(ExamTest, ATeacherDecidesAndAnExaminerMarksAgainBlind) {
    School school(data());
    setUpStation(school);
    const Service at(service());
    const std::string sitting = sit(at, session());
    ASSERT_TRUE(soon([&] { return hasArrived(sitting); }));
    prove();
    const auto as = [&](const char* login) {
        auto browser = std::make_unique<school_server::Browser>(school.address());
        EXPECT_EQ(browser->logIn(login, kPassword), 303) << login;
        return browser;
    };
    const auto teacher = as("t1"), stranger = as("t2"), examiner = as("e1"), student = as("ida"), fellow = as("s018");
    const std::string page = "/sittings/" + sitting;
    // A hand that is recorded in real time cuts a little more or less.
    const std::string points =
        fmt::format("{:.1f} / {:.1f}", scoresOf(sitting).back().score, scoresOf(sitting).back().maxScore);
    const auto status = [&](const auto& who, const std::string& path) { return who->get(path)->status; };
    const auto says = [&](const auto& who, const char* what, const char* verdict, const char* words) {
        return who->send(page + "/" + what, httplib::Params{{"verdict", verdict}, {"words", words}})->status;
    };
    EXPECT_EQ(status(teacher, "/exams/ex1"), 200);
    EXPECT_EQ(status(examiner, "/exams/ex1"), 200);
    for (const auto* who : {&stranger, &student, &fellow})
        EXPECT_EQ(status(*who, "/exams/ex1"), 403);
    EXPECT_EQ(status(fellow, page), 403);
    EXPECT_EQ(status(stranger, page), 403);
    EXPECT_THAT(teacher->get("/exams/ex1")->body, AllOf(HasSubstr("Ida"), HasSubstr("To be confirmed"),
                                                        HasSubstr("25 % more time"), HasSubstr("(proven)")));
    EXPECT_THAT(teacher->get("/classes/c1")->body, HasSubstr("/exams/ex1"));
    EXPECT_THAT(examiner->get("/exams/ex1")->body, AllOf(Not(HasSubstr("Ida")), HasSubstr("nothing to mark")));
    EXPECT_EQ(teacher->get("/attempts/" + sitting)->get_header_value("Location"), page);
    // Before a teacher has decided a student sees that it came, and not what it is worth.
    EXPECT_THAT(student->get(page)->body, AllOf(HasSubstr("To be confirmed by a teacher"),
                                                Not(HasSubstr("whole result")), Not(HasSubstr("proven"))));
    EXPECT_EQ(status(student, "/attempts/" + sitting + "/result"), 403);
    EXPECT_THAT(student->get("/people/s017")->body, AllOf(HasSubstr("/attempts/" + sitting), Not(HasSubstr(points))));
    const auto ways = [&](const auto& who) {
        std::string all;
        for (const char* one : {"curves", "export/attempts.csv", "export/criteria.csv",
                                "export/statements.json?home=https%3A%2F%2Fschool.example"}) {
            const auto answer = who->get(std::string("/people/s017/") + one);
            EXPECT_EQ(answer->status, 200) << one;
            all += answer->body;
        }
        return all;
    };
    EXPECT_THAT(ways(student), AllOf(Not(HasSubstr(sitting)), HasSubstr("No results.")));
    EXPECT_THAT(ways(teacher), HasSubstr(sitting));
    EXPECT_EQ(says(student, "confirm", "pass", "me"), 403);
    EXPECT_EQ(says(student, "appeal", "", "unfair"), 409) << "nothing was decided yet";
    EXPECT_EQ(says(examiner, "confirm", "pass", "x"), 403);
    EXPECT_EQ(says(stranger, "confirm", "fail", "x"), 403);
    EXPECT_EQ(says(teacher, "remark", "fail", "x"), 409);
    EXPECT_EQ(says(teacher, "confirm", "perhaps", "x"), 409);
    EXPECT_EQ(says(teacher, "confirm", "fail", "floor too deep <b>"), 303);
    EXPECT_THAT(student->get(page)->body,
                AllOf(HasSubstr("Not passed"), HasSubstr("floor too deep &lt;b&gt;"), HasSubstr("proven " + points)));
    EXPECT_THAT(ways(student), HasSubstr(sitting));
    EXPECT_EQ(says(student, "appeal", "", ""), 409) << "say why";
    EXPECT_EQ(says(student, "appeal", "", "it is within the range"), 303);
    EXPECT_EQ(says(student, "appeal", "", "again"), 409);
    EXPECT_THAT(student->get(page)->body, HasSubstr("To be confirmed by a teacher"));
    EXPECT_EQ(says(teacher, "decide", "pass", "well"), 409) << "nobody has marked it again yet";
    EXPECT_EQ(says(teacher, "remark", "pass", "I did"), 409) << "who judged it before does not";
    EXPECT_EQ(says(teacher, "confirm", "pass", "x"), 409) << "an appeal is open";
    EXPECT_THAT(examiner->get("/exams/ex1")->body, HasSubstr("appealed"));
    const std::string blind = examiner->get(page)->body;
    EXPECT_THAT(blind, AllOf(HasSubstr("Mark again"), Not(HasSubstr("floor too deep")), Not(HasSubstr("Ida")),
                             Not(HasSubstr("Not passed\n"))));
    EXPECT_EQ(says(examiner, "remark", "pass", "within the range"), 303);
    EXPECT_EQ(says(examiner, "remark", "fail", "no"), 409) << "once";
    EXPECT_EQ(says(teacher, "decide", "pass", "the examiner is right"), 303);
    EXPECT_THAT(student->get(page)->body, AllOf(HasSubstr("Passed"), HasSubstr("the examiner is right")));
    // The trail: in the books for good, in the audit, and in what the receipt says.
    Books open(data());
    std::vector<std::string> kinds;
    for (const school::ExamDecision& d : ExamBooks(open).decisionsOf(sitting))
        kinds.push_back(d.kind + " " + d.person);
    EXPECT_THAT(kinds, ElementsAre("confirm t1", "appeal s017", "remark e1", "decide t1"));
    std::size_t audited = 0;
    for (const school::AuditLine& line : open.audit(0, 1000, sitting))
        audited += line.what == "exam confirm" || line.what == "exam appeal" || line.what == "exam remark" ||
                           line.what == "exam decide"
                       ? 1
                       : 0;
    EXPECT_EQ(audited, 4u);
    const auto receipt = student->get(page + "/receipt");
    EXPECT_EQ(receipt->status, 200);
    EXPECT_THAT(receipt->get_header_value("Content-Disposition"), HasSubstr("receipt-"));
    EXPECT_EQ(exam::openedReceipt(receipt->body, school_server::examKey(data()).open, "").verdict, "pass");
    EXPECT_EQ(status(examiner, page + "/receipt"), 403) << "which says what was decided";
    EXPECT_EQ(status(fellow, page + "/receipt"), 403);
}

}  // namespace
}  // namespace handpiece::school_exam::exam_server_test
