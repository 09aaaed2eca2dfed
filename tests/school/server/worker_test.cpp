// SPDX-License-Identifier: Apache-2.0
// Machines that cut works again without the server's folder: over real HTTP, on both databases.
#include "school/worker.h"

#include <atomic>
#include <set>

#include <nlohmann/json.hpp>

#include "handpiece/base/core/engine_revision.h"
#include "handpiece/school/people/secret.h"
#include "school/line.h"
#include "school/remote_work.h"
#include "school/server/school_fixture.h"
#include "support/error_of.h"

namespace handpiece::school_server::worker_test {
namespace {

using school_station::Line;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class WorkersTest : public SchoolTest {
  protected:
    /// A machine with a key of its own.
    [[nodiscard]] Enrolment machine(const School& school, const std::string& name = "large machine") const {
        const std::string code = school::newStationCode();
        books().offerCode(code, name, 4'000'000'000'000, {"server", 1}, "worker");
        return school_station::enrol(school.address(), code, "", "worker");
    }
    [[nodiscard]] std::vector<std::string> pushSome(const School& school, std::size_t count) {
        std::vector<std::string> attempts;
        Enrolment enrolment = school_station::enrol(school.address(), kCode, "s017");
        for (std::size_t i = 0; i < count; ++i)
            attempts.push_back(chair_.finish(session(), fmt::format("{}.h5", i)));
        (void)chair_.push(enrolment);
        return attempts;
    }
    static school_wire::Work take(Line& line) {
        return school_wire::workFrom(line.post(fmt::format("/api/v1/works?engine={}", core::kEngineRevision), "{}"));
    }
    static std::string pathOf(const school_wire::Work& work, const std::string& rest) {
        return fmt::format("/api/v1/works/{}/{}/{}", work.number, work.turn, rest);
    }
    [[nodiscard]] fs::path works() const { return folder_.path() / "works"; }
    Chair chair_;
};

TEST_F(WorkersTest, WhatIsCutElsewhereIsWhatIsCutHere) {
    School school(data());
    const std::vector<std::string> attempts = pushSome(school, 2);
    Worker here(worksOf({data(), databaseOf(data())}, systemClock())), elsewhere(worksOf(machine(school), works()));
    EXPECT_TRUE(here.workOnce());
    EXPECT_TRUE(elsewhere.workOnce());
    EXPECT_FALSE(elsewhere.workOnce()) << "both are done";
    ASSERT_THAT(scoresOf(attempts[0]), SizeIs(1));
    ASSERT_THAT(scoresOf(attempts[1]), SizeIs(1));
    const school::Score a = scoresOf(attempts[0]).front(), b = scoresOf(attempts[1]).front();
    EXPECT_EQ(a.state, "proven") << a.reason;
    EXPECT_EQ(b.state, "proven") << b.reason;
    EXPECT_EQ(a.score, b.score) << "to the bit";
    EXPECT_EQ(a.stateHash, b.stateHash);
    EXPECT_EQ(a.result, b.result);
    EXPECT_NE(a.worker, b.worker);
}

TEST_F(WorkersTest, ItsKeyOpensTheFilesOfWhatItHasInHandAndNothingElse) {
    School school(data());
    const std::vector<std::string> attempts = pushSome(school, 1);
    const Enrolment one = machine(school, "one"), other = machine(school, "other");
    Line its(one.server, one.key), others(other.server, other.key);
    const school_wire::Work work = take(its);
    ASSERT_THAT(work.sessions, SizeIs(1));
    EXPECT_THAT(work.question, Not(HasSubstr("s017"))) << "whose it is, it needs not know";
    const std::string file = pathOf(work, "files/" + work.sessions.front().hash);
    EXPECT_EQ(its.get(file).size(), work.sessions.front().bytes);
    const auto errorOf = [](auto ask) { return test::errorOf(ask); };
    // Another machine, with the right address.
    EXPECT_THAT(errorOf([&] { (void)others.get(file); }), HasSubstr("lent to another"));
    EXPECT_THAT(errorOf([&] { (void)others.post(pathOf(work, "renew"), "{}"); }), HasSubstr("lent to another"));
    EXPECT_THAT(errorOf([&] { (void)others.post(pathOf(work, "proof"), "{}"); }), HasSubstr("lent to another"));
    EXPECT_THAT(errorOf([&] { (void)others.post(pathOf(work, "back?pause_ms=0&counts=1"), "{}"); }),
                HasSubstr("lent to another"));
    // A file of the server that is no file of this work: a whole mouth of exams lies there.
    const fs::path secret = folder_.path() / "secret";
    core::writeFile(secret, std::string("of somebody else"));
    const std::string hash = school::sha256Of(secret);
    const std::vector<std::byte> bytes = core::readFile(secret);
    (void)books().append({std::string(32, '0'), hash, bytes.size()}, 0, bytes, 1);
    EXPECT_THAT(errorOf([&] { (void)its.get(pathOf(work, "files/" + hash)); }), HasSubstr("no such file"));
    // Neither is it a station, nor is a station one of these.
    EXPECT_THAT(errorOf([&] { (void)its.get("/api/v1/status"); }), HasSubstr("no more"));
    EXPECT_THAT(errorOf([&] { (void)its.get("/api/v1/exams"); }), HasSubstr("no more"));
    const std::string chairs = school::newStationCode(), practice = school::newStationCode(),
                      machines = school::newStationCode();
    books().offerCode(chairs, "chair 2", 4'000'000'000'000, {"server", 1});
    const Enrolment chair = school_station::enrol(school.address(), chairs, "s017");
    Line station(chair.server, chair.key);
    EXPECT_THAT(errorOf([&] { (void)take(station); }), HasSubstr("no works again"));
    EXPECT_THAT(errorOf([&] { (void)station.get(file); }), HasSubstr("no works again"));
    // A practice code makes no worker, a worker's no station; neither is spent.
    books().offerCode(practice, "chair 3", 4'000'000'000'000, {"server", 1});
    books().offerCode(machines, "third", 4'000'000'000'000, {"server", 1}, "worker");
    EXPECT_THAT(errorOf([&] { (void)school_station::enrol(school.address(), practice, "", "worker"); }),
                HasSubstr("for practice"));
    EXPECT_THAT(errorOf([&] { (void)school_station::enrol(school.address(), machines, "s017"); }),
                HasSubstr("cuts works again"));
    EXPECT_THAT(books().offered(practice, 1)->kind, "practice");
    EXPECT_THAT(books().offered(machines, 1)->kind, "worker");
    // What is no proof of it enters nothing.
    for (const std::string& nonsense :
         {std::string("{}"), std::string("[]"), std::string(R"({"state":"proven"})"), std::string(100'000, '['),
          std::string(
              R"({"state":"proven","reason":"","state_hash":"","score":1e999,"max_score":1,"whole_score":1,)"
              R"("passed":"yes","borderline":false,"result":"{}","contents":[""],"sketches":[[]],"doubts":[]})")})
        EXPECT_THAT(errorOf([&] { (void)its.post(pathOf(work, "proof"), nonsense); }), HasSubstr("no proof"));
    EXPECT_THAT(scoresOf(attempts.front()), IsEmpty());
    // Given back it is another's, from then on.
    (void)its.post(pathOf(work, "back?pause_ms=0&counts=0"), "{}");
    EXPECT_THAT(errorOf([&] { (void)its.get(file); }), HasSubstr("lent to another"));
    EXPECT_EQ(take(others).turn, 1) << "and that cost it nothing";
    // A key that was taken back.
    books().revoke(other.station, {"server", 2});
    EXPECT_THAT(errorOf([&] { (void)others.get(file); }), HasSubstr("does not know this station"));
}

TEST_F(WorkersTest, AnotherProgramsScoresAreNotTaken) {
    School school(data());
    (void)pushSome(school, 1);
    const Enrolment one = machine(school);
    Line line(one.server, one.key);
    EXPECT_THAT(test::errorOf(
                    [&] { (void)line.post(fmt::format("/api/v1/works?engine={}", core::kEngineRevision + 1), "{}"); }),
                HasSubstr("bring both to the same version"));
    EXPECT_EQ(books().progress("arrival").waiting, 1);
}

TEST_F(WorkersTest, AnyNumberOfMachinesDoesEachWorkOnce) {
    School school(data());
    const std::vector<std::string> attempts = pushSome(school, 9);
    std::vector<std::unique_ptr<Worker>> workers;
    for (const char* name : {"one", "two", "three"}) {
        workers.push_back(
            std::make_unique<Worker>(worksOf(machine(school, name), works()), std::chrono::milliseconds(50)));
        workers.back()->start();
    }
    for (int i = 0; i < 1200 && books().progress("arrival").done < 9; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    workers.clear();
    std::set<std::string> by;
    for (const std::string& one : attempts) {
        ASSERT_THAT(scoresOf(one), SizeIs(1));
        EXPECT_EQ(scoresOf(one).front().state, "proven") << scoresOf(one).front().reason;
        by.insert(scoresOf(one).front().worker);
    }
    EXPECT_GE(by.size(), 2u) << "they share it";
}

TEST_F(WorkersTest, AServerThatIsGoneForAWhileHasItAllTheSame) {
    auto school = std::make_unique<School>(data());
    const int port = school->port();
    const std::vector<std::string> attempts = pushSome(*school, 1);
    const std::unique_ptr<WorkSource> source = worksOf(machine(*school), works());
    const std::unique_ptr<LentWork> work = source->take();
    ASSERT_TRUE(work);
    const sandboxed::Files files = work->files({});
    sandboxed::Proof proof = sandboxed::prove(work->question(), files);
    school.reset();
    EXPECT_TRUE(work->renew()) << "nobody said that it is another's";
    std::thread enters([&] { work->enter(std::move(proof), {}); });
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    school = std::make_unique<School>(data(), 0, port);
    enters.join();
    ASSERT_THAT(scoresOf(attempts.front()), SizeIs(1));
    EXPECT_EQ(scoresOf(attempts.front()).front().state, "proven");
    EXPECT_FALSE(work->renew()) << "it is done";
}

TEST_F(WorkersTest, AFileThatComesAsAnotherIsNotCut) {
    School school(data());
    const std::vector<std::string> attempts = pushSome(school, 1);
    Worker worker(worksOf(machine(school), works()));
    // The server's disk holds something else under this name.
    const fs::path file = books().files().path(school::sha256Of(session()));
    fs::permissions(file, fs::perms::owner_all);
    fs::resize_file(file, fs::file_size(file) - 1);
    EXPECT_THAT(test::errorOf([&] { (void)worker.workOnce(); }), HasSubstr("came as another"));
    EXPECT_THAT(scoresOf(attempts.front()), IsEmpty());
    EXPECT_EQ(books().progress("arrival").waiting, 1);
    EXPECT_TRUE(fs::is_empty(works())) << "nothing of it stays";
}

TEST_F(WorkersTest, OfItsWorkItSaysWhatItLikesAndOfNobodyElse) {
    School school(data());
    const std::vector<std::string> attempts = pushSome(school, 2);
    const Enrolment one = machine(school);
    Line liar(one.server, one.key);
    const school_wire::Work first = take(liar), second = take(liar);
    sandboxed::Proof proof = sandboxed::proofFrom(
        R"({"state":"refused","reason":"I say so","state_hash":"","score":0,"max_score":0,"whole_score":0,)"
        R"("passed":"teacher","borderline":false,"result":"","contents":[")" +
            std::string(64, 'a') + R"("],"sketches":[["0123456789abcdef"]],"doubts":[]})",
        1);
    (void)liar.post(pathOf(first, "proof"), sandboxed::toJson(proof));
    EXPECT_EQ(scoresOf(attempts[0]).back().reason, "I say so");
    const sandboxed::Contents real = sandboxed::contentsOf({session()});
    ASSERT_EQ(real.inputs.size(), 1u);
    EXPECT_EQ(real.inputs[0].size(), 64u);
    for (const school::BookTable& table : books().everything())
        if (table.name == "contents") {
            ASSERT_EQ(table.rows.size(), 1u);
            EXPECT_NE(std::find(table.rows[0].begin(), table.rows[0].end(), real.inputs[0]), table.rows[0].end());
        }
    // Numbers that no rubric gives, and results of something else.
    for (const double score : {-1.0, 1e300, 2.0}) {
        proof.score.score = score, proof.score.maxScore = score > 1.0 && score < 10.0 ? 1.0 : score;
        EXPECT_THAT(test::errorOf([&] { (void)liar.post(pathOf(second, "proof"), sandboxed::toJson(proof)); }),
                    HasSubstr("no proof"))
            << score;
    }
    // Nobody takes all there is for long.
    (void)liar.post(pathOf(second, "back?pause_ms=9223372036854775807&counts=0"), "{}");
    EXPECT_TRUE(books().takeJob("another", systemClock()() + 61'000, 1000)) << "a minute is the most";
}

/// Answers as it likes.
class FakeServer {
  public:
    explicit FakeServer(std::string work, std::function<void(httplib::Response&)> file) {
        http_.Post("/api/v1/works", [work = std::move(work)](const httplib::Request&, httplib::Response& response) {
            response.set_content(work, "application/json");
        });
        http_.Get("/api/v1/works/.*", [file](const httplib::Request&, httplib::Response& response) { file(response); });
        http_.Post("/api/v1/works/.*", [this](const httplib::Request& request, httplib::Response& response) {
            const std::lock_guard lock(mutex_);
            asked_.push_back(request.path);
            response.set_content("{}", "application/json");
        });
        port_ = http_.bind_to_any_port("127.0.0.1");
        thread_ = std::thread([this] { http_.listen_after_bind(); });
        while (!http_.is_running())
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    ~FakeServer() {
        http_.stop();
        thread_.join();
    }
    [[nodiscard]] Enrolment enrolment() const {
        return {fmt::format("http://127.0.0.1:{}", port_), std::string(32, 'a'), std::string(64, 'b'), "", 0};
    }
    [[nodiscard]] std::vector<std::string> asked() {
        const std::lock_guard lock(mutex_);
        return asked_;
    }

  private:
    httplib::Server http_;
    int port_ = 0;
    std::thread thread_;
    std::mutex mutex_;
    std::vector<std::string> asked_;
};

TEST_F(WorkersTest, AServerThatIsNoneGetsNothingOfTheMachine) {
    const fs::path victim = folder_.path() / "victim.h5", there = folder_.path() / "there";
    fs::copy_file(session(), fs::path(there.string() + ".h5"));
    const auto work = [](const std::string& hash, const std::string& bytes) {
        return R"({"number":1,"turn":1,"lease_ms":1000,"question":"{}","sessions":[{"hash":)" +
               nlohmann::json(hash).dump() + R"(,"bytes":)" + bytes + R"(}],"exercise":{"hash":")" +
               std::string(64, '0') + R"(","bytes":1}})";
    };
    const auto says = [](httplib::Response& response) { response.set_content("evil", "application/octet-stream"); };
    for (const std::string& hash :
         {victim.string() + std::string(1, '\0'), (folder_.path() / "victim").string(), "../../victim" + std::string(),
          there.string(), std::string(64, 'g'), std::string(63, 'a'), std::string()}) {
        FakeServer fake(work(hash, "4"), says);
        Worker worker(worksOf(fake.enrolment(), works()));
        EXPECT_THAT(test::errorOf([&] { (void)worker.workOnce(); }), HasSubstr("SHA-256")) << hash;
        EXPECT_FALSE(fs::exists(victim));
        EXPECT_THAT(fake.asked(), IsEmpty()) << "and nothing is told of what lies here";
    }
    // More than any work has; another file; more than it said; without end.
    FakeServer huge(work(std::string(64, 'a'), "3000000000"), says);
    EXPECT_THAT(test::errorOf([&] { (void)Worker(worksOf(huge.enrolment(), works())).workOnce(); }),
                HasSubstr("what no work has"));
    FakeServer other(work(std::string(64, 'a'), "4"), says);
    EXPECT_THAT(test::errorOf([&] { (void)Worker(worksOf(other.enrolment(), works())).workOnce(); }),
                HasSubstr("came as another"));
    const auto endless = [](httplib::Response& response) {
        response.set_chunked_content_provider("application/octet-stream", [](std::size_t, httplib::DataSink& sink) {
            static const std::string piece(1 << 16, ' ');
            return sink.write(piece.data(), piece.size());
        });
    };
    FakeServer more(work(std::string(64, 'a'), "4"), endless);
    EXPECT_THAT(test::errorOf([&] { (void)Worker(worksOf(more.enrolment(), works())).workOnce(); }),
                HasSubstr("nothing that can be read"));
    httplib::Server http;
    http.Post("/api/v1/works", [&](const httplib::Request&, httplib::Response& response) { endless(response); });
    const int port = http.bind_to_any_port("127.0.0.1");
    std::thread thread([&] { http.listen_after_bind(); });
    Enrolment enrolment = more.enrolment();
    enrolment.server = fmt::format("http://127.0.0.1:{}", port);
    EXPECT_THAT(test::errorOf([&] { (void)Worker(worksOf(enrolment, works())).workOnce(); }),
                HasSubstr("nothing that can be read"));
    http.stop();
    thread.join();
    EXPECT_TRUE(!fs::exists(works()) || fs::is_empty(works()));
}

TEST_F(WorkersTest, AMachineWithoutRoomGivesTheWorkBack) {
    School school(data());
    (void)pushSome(school, 1);
    core::writeFile(folder_.path() / "no folder", std::string("a file"));
    Worker worker(worksOf(machine(school), folder_.path() / "no folder"));
    EXPECT_NE(test::errorOf([&] { (void)worker.workOnce(); }), "");
    const auto job = books().takeJob("another", systemClock()(), 1000);
    ASSERT_TRUE(job) << "at once";
    EXPECT_EQ(job->turn, 1) << "and that cost it nothing";
}

}  // namespace
}  // namespace handpiece::school_server::worker_test
