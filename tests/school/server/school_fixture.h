// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A server in a thread, a block as its exercise, a recording of work at it, and the computers of its students.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <mutex>
#include <span>
#include <thread>

#include "app/simulation/live_session_fixture.h"
#include "handpiece/app/assessment/score_work.h"
#include "handpiece/assess/task/task.h"
#include "handpiece/base/core/file.h"
#include "school/http.h"
#include "school/lent_work.h"
#include "school/server.h"
#include "school/station.h"
#include "school/store/postgres_server.h"

namespace handpiece::school_server {

namespace fs = std::filesystem;
using school::Act;
using school::Books;
using school_station::Enrolment;

/// HANDPIECE_TEST_DATABASE=postgres: on a real server of this program's own, else on SQLite.
inline bool isOnPostgres() {
    const char* const asked = std::getenv("HANDPIECE_TEST_DATABASE");
    return asked != nullptr && std::string(asked) == "postgres";
}
inline test::PostgresServer* postgres() {
    static const std::unique_ptr<test::PostgresServer> one = test::PostgresServer::start();
    return one.get();
}
/// Where the books of this folder are: a schema of its own, made when it is first asked for; empty: SQLite in it.
inline std::string databaseOf(const fs::path& data) {
    if (!isOnPostgres()) return {};
    static std::mutex mutex;
    static std::map<fs::path, std::string> schemas;
    const std::lock_guard lock(mutex);
    const auto [place, isNew] = schemas.try_emplace(data);
    if (isNew) place->second = postgres()->newSchema();
    return postgres()->address(place->second);
}
/// Skips all where that server is not installed.
class NeedsPostgres : public testing::Environment {
  public:
    void SetUp() override {
        if (isOnPostgres() && !postgres()) GTEST_SKIP() << "postgresql-15 is not installed: not tested on it";
    }
};
inline const testing::Environment* const kNeedsPostgres = testing::AddGlobalTestEnvironment(new NeedsPostgres);

inline constexpr const char* kCode = "ABC-DEF-GHJ-KMN";

inline constexpr const char* kRubric = R"(format = 1
id = "block"
version = "1"
title = { en = "Block" }
status = "proposal"
source = "a test"
[[criterion]]
id = "removed"
measure = "removed"
unit = "mm3"
weight = 1
knots = [[0, 0], [0.5, 100], [9, 100]]
title = { en = "removed" }
source = "a test"
)";

inline tasks::Task blockTask() {
    tasks::Task task;
    task.id = "block";
    task.toothCase = simulation::blockCase();
    task.toothCase.exercise.emplace();
    task.toothCase.exercise->title = {{"en", "Block"}};
    task.voxelMm = simulation::blockSettings().field.voxelMm;
    task.rubric = kRubric;
    return task;
}

/// A sitting at the block of so long [s], recorded.
inline void recordSession(const fs::path& path, double lastsS, const device::Motion& motion = simulation::twoHoles()) {
    simulation::SimulationSettings settings = simulation::blockSettings();
    const instrument::Instrument known = instrument::makeInstrument("round:1.0x0.9");
    settings.bur = known.bur, settings.cuttingParameters = known.cuttingParameters;
    const simulation::SimulationSetup station = simulation::makeSimulation(blockTask().toothCase, settings, false);
    simulation::LiveSessionSettings live;
    live.sessionFile = path;
    const auto lead = std::make_shared<simulation::Lead>();
    simulation::LiveSession sitting(station, blockTask().toothCase, simulation::handOf(motion, lead), live, nullptr);
    EXPECT_TRUE(simulation::leadTo(sitting, *lead, lastsS));
    sitting.stop();
}
/// One, recorded once for all tests.
inline const fs::path& session() {
    static const test::TemporaryFolder folder;
    static const fs::path file = [] {
        const fs::path path = folder.path() / "one.h5";
        recordSession(path, 3.1);
        return path;
    }();
    return file;
}

/// A server in a thread of its own, with one student and the block as its exercise.
class School {
  public:
    explicit School(const fs::path& data, std::size_t workers = 0, int port = 0,
                    std::chrono::milliseconds slow = std::chrono::seconds(10))
        : School(data, Odd{.port = port, .workers = workers, .slow = slow, .database = databaseOf(data)}) {}
    /// What is otherwise than usual.
    struct Odd {
        int port = 0;
        std::size_t workers = 0;
        std::chrono::milliseconds slow = std::chrono::seconds(10);
        int oldest = school_wire::kOldestProtocol, newest = school_wire::kProtocol;
        std::string database{};
        SignOn signOn{};
        std::string address{};
        std::size_t threads = Settings{}.threads;
        std::vector<std::string> proxies{};
        bool ownStationsOnly = false;
    };
    School(const fs::path& data, const Odd& odd) : data_(data) {
        Settings settings;
        settings.data = data, settings.database = odd.database;
        settings.ownStationsOnly = odd.ownStationsOnly;
        settings.port = odd.port, settings.workers = odd.workers, settings.slow = odd.slow;
        settings.oldestProtocol = odd.oldest, settings.newestProtocol = odd.newest;
        settings.signOn = odd.signOn, settings.address = odd.address;
        settings.threads = odd.threads, settings.proxies = odd.proxies;
        server_ = std::make_unique<Server>(settings);
        thread_ = std::thread([this] { server_->run(); });
        httplib::Client http(address());
        while (!http.Get("/healthz"))
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    ~School() { stop(); }
    void stop() {
        server_->stop();
        if (thread_.joinable()) thread_.join();
    }
    [[nodiscard]] std::string address() const { return fmt::format("http://127.0.0.1:{}", server_->port()); }
    [[nodiscard]] int port() const { return server_->port(); }

    static void furnish(const fs::path& data) { furnish(data, databaseOf(data)); }
    static void furnish(const fs::path& data, const std::string& database) {
        Books books(data, database);
        const Act act{"server", 1};
        const school::Person student{"s017", "Ida", "ida", "", "", {"student"}, 1, 0};
        books.add(std::span(&student, 1), act);
        const tasks::Task task = blockTask();
        const test::TemporaryFolder folder;
        const fs::path pack = folder.path() / "block.handpiece";
        tasks::writeTask(task, pack);
        const std::vector<std::byte> bytes = core::readFile(pack);
        const std::string file = school::sha256Of(pack);
        (void)books.append({std::string(32, '0'), file, bytes.size()}, 0, bytes, 1);
        const rubric::Rubric rubric = rubric::parseRubric(kRubric, "rubric.toml");
        const std::string rubricHash = rubric::hashText(rubric::hashOf(rubric));
        books.add(school::RubricVersion{rubricHash, "block", kRubric, 1, 1}, act);
        books.add(school::Pack{rubric::hashText(tasks::contentHash(task)), file, "block", "Block", rubricHash, 1}, act);
        books.offerCode(kCode, "chair 1", 4'000'000'000'000, act);
    }

  private:
    fs::path data_;
    std::unique_ptr<Server> server_;
    std::thread thread_;
};

/// A person's own computer.
class Chair {
  public:
    Chair() : store_(home_.path() / "results.db") { fs::create_directories(home_.path() / "sessions"); }
    /// Work that was finished and scored here.
    std::string finish(const fs::path& recording, const std::string& name, double score = 100.0) {
        fs::copy_file(recording, home_.path() / "sessions" / name);
        const rubric::Rubric rubric = rubric::parseRubric(kRubric, "rubric.toml");
        school::Attempt a;
        a.id = school::newId();
        a.exercise = "block", a.exerciseHash = rubric::hashText(tasks::contentHash(blockTask()));
        a.rubricHash = rubric::hashText(rubric::hashOf(rubric));
        a.sessionHashes = {assessment::workHash(recording)}, a.recordings = {name};
        a.began = 1000, a.finished = 5000;
        a.device = "simulated", a.score = score, a.maxScore = 100.0, a.wholeScore = 100.0, a.passed = "teacher";
        a.result = "{}";
        store_.add(a);
        return a.id;
    }
    school_station::Pushed push(Enrolment& enrolment) {
        return school_station::push(store_, home_.path() / "sessions", enrolment, home_.path() / "school.json");
    }
    [[nodiscard]] Enrolment kept() const { return school_station::readEnrolment(home_.path() / "school.json"); }
    school::Store& store() { return store_; }
    [[nodiscard]] fs::path home() const { return home_.path(); }

  private:
    test::TemporaryFolder home_;
    school::Store store_;
};

/// Scores all that waits, as the server's own worker does. In a fixture it is the same recording by the same rubric for
/// each test: proven once, in a process of its own, and kept in `known`. Tests of the worker ask the worker.
inline void scoreAll(const fs::path& data, std::optional<sandboxed::Proof>& known) {
    const std::unique_ptr<WorkSource> source = worksOf({data, databaseOf(data)}, systemClock());
    while (const std::unique_ptr<LentWork> work = source->take()) {
        if (!known) known = sandboxed::prove(work->question(), work->files({}));
        work->enter(*known, {});
    }
}

class SchoolTest : public testing::Test {
  protected:
    void SetUp() override { School::furnish(data()); }
    [[nodiscard]] fs::path data() const { return folder_.path() / "school"; }
    [[nodiscard]] Books books() const { return Books(data(), databaseOf(data())); }
    [[nodiscard]] std::vector<school::Score> scoresOf(const std::string& attempt) const {
        return books().scoresOf(attempt);
    }
    test::TemporaryFolder folder_;
};

}  // namespace handpiece::school_server
