// SPDX-License-Identifier: Apache-2.0
// The store under what befalls files: kill -9, two programs, a full disk, other versions, damage. What it holds is read
// back with SQLite itself where that tells more.
#include "handpiece/school/store/store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <set>
#include <thread>

#include "handpiece/base/core/file.h"
#include "support/at_once.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::school::store_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using namespace std::chrono_literals;

/// With SQLite alone, as another program has it.
void sql(const fs::path& file, const std::string& statements) {
    sqlite3* handle = nullptr;
    ASSERT_EQ(sqlite3_open(file.c_str(), &handle), SQLITE_OK);
    char* why = nullptr;
    EXPECT_EQ(sqlite3_exec(handle, statements.c_str(), nullptr, nullptr, &why), SQLITE_OK) << (why ? why : "");
    sqlite3_free(why);
    sqlite3_close(handle);
}
std::string answer(const fs::path& file, const std::string& query) {
    sqlite3* handle = nullptr;
    std::string text;
    EXPECT_EQ(sqlite3_open_v2(file.c_str(), &handle, SQLITE_OPEN_READWRITE, nullptr), SQLITE_OK);
    sqlite3_stmt* statement = nullptr;
    EXPECT_EQ(sqlite3_prepare_v2(handle, query.c_str(), -1, &statement, nullptr), SQLITE_OK) << query;
    if (sqlite3_step(statement) == SQLITE_ROW) text = reinterpret_cast<const char*>(sqlite3_column_text(statement, 0));
    sqlite3_finalize(statement);
    sqlite3_close(handle);
    return text;
}

int integer(std::mt19937_64& random, int least, int most) {
    return std::uniform_int_distribution(least, most)(random);
}

class StoreTest : public testing::Test {
  protected:
    core::PrivateFolder folder_;
    fs::path file_ = folder_.path() / "deeper" / "results.db";

    static Attempt attempt(std::size_t resultBytes = 2000) {
        Attempt a;
        a.id = newId();
        a.exercise = "class-one-46";
        a.exerciseHash = "0123456789abcdef";
        a.rubricHash = "fedcba9876543210";
        a.sessionHashes = {"1111111111111111", "2222222222222222"};
        a.recordings = {"one.h5", "two.h5"};
        a.began = 1'700'000'000'000;
        a.finished = a.began + 60'000;
        a.device = "pointer";
        a.score = 7.25;
        a.maxScore = 10.0;
        a.wholeScore = 12.5;
        a.passed = "teacher";
        a.borderline = true;
        a.proven = true;
        a.result = std::string(resultBytes, 'r');
        return a;
    }
};

TEST_F(StoreTest, GivesBackAllThatWasPutInAlsoToAnotherProgram) {
    const Attempt first = attempt();
    Attempt other = attempt();
    other.exercise = "block";
    other.finished -= 1;
    other.result = "\xe6\x84\x9b 'quoted' \"\n\x01";
    const Comment pinned{newId(), first.id, "teacher", "here", core::Vec3(1.5, -2.0, 0.25), 12.5, 5};
    const Comment loose{newId(), first.id, "teacher", "well done", {}, {}, 6};
    {
        Store store(file_);
        store.see({"block", 1, "aa", "Block", 10, 10});
        store.see({"block", 2, "aa", "Block, again", 20, 20});
        store.see({"block", 3, "bb", "Another block", 30, 30});
        store.add(first);
        store.add(Judgement{first.id, 80.0, "even", 4});
        store.add(other);
        store.add(pinned);
        store.add(loose);
    }
    {
        Store store(file_);
        store.see({"place", 1, "cc", "Placed", 1, 1, "/school/placed"});
        store.see({"place", 1, "cc", "Placed", 2, 2, ""});
        EXPECT_EQ(store.exercises().back().place, "/school/placed") << "where it was known to be";
        store.see({"place", 1, "cc", "Placed", 3, 3, "/elsewhere"});
        EXPECT_EQ(store.exercises().back().place, "/elsewhere");
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(file_.parent_path()), {}), 1) << "one file";
    EXPECT_EQ(fs::status(file_).permissions(), fs::perms::owner_read | fs::perms::owner_write);
    const Store store(file_);
    const std::vector<Exercise> seen = store.exercises();
    ASSERT_EQ(seen.size(), 3u);
    EXPECT_EQ(seen[0].title, "Block, again");
    EXPECT_EQ(seen[0].version, 2);
    EXPECT_EQ(seen[0].firstSeen, 10);
    EXPECT_EQ(seen[0].lastSeen, 20);
    ASSERT_EQ(store.attempts().size(), 2u);
    EXPECT_EQ(store.attempts()[0].id, other.id) << "in the order in which they were finished";
    ASSERT_EQ(store.attempts("class-one-46").size(), 1u);
    const Attempt back = *store.attempt(first.id);
    EXPECT_EQ(back.exerciseHash, first.exerciseHash);
    EXPECT_EQ(back.rubricHash, first.rubricHash);
    EXPECT_EQ(back.sessionHashes, first.sessionHashes);
    EXPECT_EQ(back.recordings, first.recordings);
    EXPECT_EQ(back.began, first.began);
    EXPECT_EQ(back.finished, first.finished);
    EXPECT_EQ(back.device, "pointer");
    EXPECT_EQ(back.motionScale, 1.0);
    EXPECT_EQ(back.percent(), 72.5);
    EXPECT_EQ(back.wholeScore, 12.5);
    EXPECT_FALSE(back.isWhole());
    EXPECT_EQ(back.passed, "teacher");
    EXPECT_TRUE(back.borderline);
    EXPECT_TRUE(back.proven);
    EXPECT_EQ(back.result, first.result);
    EXPECT_EQ(store.attempt(other.id)->result, other.result);
    EXPECT_FALSE(store.attempt("nobody"));
    EXPECT_EQ(store.judgementOf(first.id)->percent, 80.0);
    EXPECT_EQ(store.judgementOf(first.id)->words, "even");
    EXPECT_FALSE(store.judgementOf(other.id));
    const std::vector<Comment> comments = store.commentsOn(first.id);
    ASSERT_EQ(comments.size(), 2u);
    EXPECT_EQ(*comments[0].placeMm, core::Vec3(1.5, -2.0, 0.25));
    EXPECT_EQ(comments[0].timeS, 12.5);
    EXPECT_FALSE(comments[1].placeMm);
    EXPECT_FALSE(comments[1].timeS);
    std::vector<std::string> kinds;
    for (const Outgoing& item : store.outbox(0))
        kinds.push_back(item.kind);
    EXPECT_THAT(kinds, ElementsAre("attempt", "judgement", "attempt", "comment", "comment"));
    EXPECT_EQ(store.outbox(store.outbox(0, 2).back().sequence).size(), 3u);
    EXPECT_EQ(store.outbox(0)[0].id, first.id);
}

TEST_F(StoreTest, RetestsComeWithTheAttemptThatAsksForThemOrNotAtAll) {
    Store store(file_);
    Attempt first = attempt(), second = attempt(), other = attempt();
    first.workedS = 605.5;
    first.limitS = 600.0;
    other.exercise = "block";
    store.add(first, {{"", "depth", first.id, 0, 70}, {"", "width", first.id, 1, 50}});
    store.add(other, {{"", "width", other.id, 0, 60}});
    EXPECT_EQ(store.attempt(first.id)->workedS, 605.5);
    EXPECT_EQ(store.attempt(first.id)->lateS(), 5.5);
    EXPECT_EQ(store.attempt(other.id)->lateS(), 0.0) << "no limit";
    std::vector<std::string> due;
    for (const Retest& one : store.retests())
        due.push_back(one.exercise + "/" + one.criterion + "/" + std::to_string(one.step));
    EXPECT_THAT(due, ElementsAre("class-one-46/width/1", "block/width/0", "class-one-46/depth/0"));
    // Twice the same criterion: nothing of it is stored, nor what was there lost.
    EXPECT_NE(test::errorOf([&] {
                  store.add(second, {{"", "depth", second.id, 0, 1}, {"", "depth", second.id, 0, 2}});
              }),
              "");
    EXPECT_FALSE(store.attempt(second.id));
    EXPECT_EQ(store.retests("class-one-46").size(), 2u);
    store.add(second, {});
    EXPECT_TRUE(store.retests("class-one-46").empty());
    EXPECT_EQ(store.retests().size(), 1u);
}

TEST_F(StoreTest, MarksThatComeBackAreKeptOneAMarker) {
    const Attempt first = attempt();
    {
        Store store(file_);
        store.add(first);
        store.add(Returned{first.id, "Sato", "{1}", 10});
        store.add(Returned{first.id, "Mori", "{2}", 20});
        store.add(Returned{first.id, "Sato", "{3}", 30});
        EXPECT_NE(test::errorOf([&] { store.add(Returned{"nobody", "Sato", "{}", 40}); }), "");
    }
    const Store store(file_);
    const std::vector<Returned> all = store.returnedOf(first.id);
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(all[0].marker, "Mori");
    EXPECT_EQ(all[1].marks, "{3}") << "the newest in the place of the one before";
    EXPECT_EQ(all[1].made, 30);
    EXPECT_TRUE(store.returnedOf("nobody").empty());
    EXPECT_EQ(store.outbox(0).back().kind, "returned");
    EXPECT_EQ(store.outbox(0).size(), 4u);
}

TEST_F(StoreTest, IdsAreOnesOwnAndNothingOfAnAttemptIsHalfStored) {
    std::set<std::string> ids;
    for (int i = 0; i < 10000; ++i)
        ids.insert(newId());
    EXPECT_EQ(ids.size(), 10000u);
    EXPECT_EQ(ids.begin()->size(), 32u);
    Store store(file_);
    const Attempt a = attempt();
    store.add(a);
    EXPECT_THROW(store.add(a), core::Error) << "twice";
    store.add(Judgement{a.id, 1.0, "", 0});
    EXPECT_THROW(store.add(Judgement{a.id, 2.0, "", 0}), core::Error) << "said once";
    EXPECT_EQ(store.judgementOf(a.id)->percent, 1.0);
    const Attempt b = attempt();
    EXPECT_THROW(store.add(Judgement{"nobody", 1.0, "", 0}), core::Error);
    EXPECT_THROW(store.add(Comment{newId(), "nobody", "", "", {}, {}, 0}), core::Error);
    EXPECT_FALSE(store.attempt(b.id));
    EXPECT_EQ(store.outbox(0).size(), 2u) << "nothing was posted of what was refused";
    store.add(b);
    EXPECT_EQ(store.attempts().size(), 2u);
}

TEST_F(StoreTest, AttemptsAndOutboxAreNotChangedByAnybody) {
    {
        Store store(file_);
        store.add(attempt());
    }
    sqlite3* handle = nullptr;
    ASSERT_EQ(sqlite3_open(file_.c_str(), &handle), SQLITE_OK);
    for (const char* change : {"UPDATE attempts SET score = 10", "UPDATE outbox SET kind = 'x'", "DELETE FROM outbox"})
        EXPECT_EQ(sqlite3_exec(handle, change, nullptr, nullptr, nullptr), SQLITE_CONSTRAINT) << change;
    sqlite3_close(handle);
}

// What version 1 was, as it was written; copied here, so that no later change can move it.
constexpr const char* kVersionOne = R"sql(
CREATE TABLE exercises (
  id TEXT NOT NULL, version INTEGER NOT NULL, hash TEXT NOT NULL, title TEXT NOT NULL,
  first_seen INTEGER NOT NULL, last_seen INTEGER NOT NULL, PRIMARY KEY (id, hash)) STRICT;
CREATE TABLE attempts (
  id TEXT PRIMARY KEY, exercise TEXT NOT NULL, exercise_hash TEXT NOT NULL, rubric_hash TEXT NOT NULL,
  session_hashes TEXT NOT NULL, recordings TEXT NOT NULL, began INTEGER NOT NULL, finished INTEGER NOT NULL,
  device TEXT NOT NULL, motion_scale REAL NOT NULL, score REAL NOT NULL, max_score REAL NOT NULL,
  passed TEXT NOT NULL CHECK (passed IN ('yes', 'no', 'teacher')), borderline INTEGER NOT NULL,
  proven INTEGER NOT NULL, result TEXT NOT NULL) STRICT;
CREATE INDEX attempts_by_exercise ON attempts (exercise, finished);
CREATE TABLE outbox (
  sequence INTEGER PRIMARY KEY AUTOINCREMENT, kind TEXT NOT NULL, id TEXT NOT NULL, made INTEGER NOT NULL) STRICT;
PRAGMA application_id = 1213231988;
PRAGMA user_version = 1;
INSERT INTO attempts VALUES ('old', 'block', 'aa', 'bb', 'cc', 'old.h5', 1, 2, 'pointer', 1.0, 5, 10, 'no', 0, 1, '{}');
INSERT INTO outbox (kind, id, made) VALUES ('attempt', 'old', 2);
)sql";

TEST_F(StoreTest, ComesUpFromVersionOneWithAllThatItHolds) {
    fs::create_directories(file_.parent_path());
    sql(file_, kVersionOne);
    {
        Store store(file_);
        ASSERT_TRUE(store.attempt("old"));
        EXPECT_EQ(store.attempt("old")->percent(), 50.0);
        EXPECT_TRUE(store.attempt("old")->isWhole());
        store.add(Comment{newId(), "old", "teacher", "before", {}, {}, 3});
        EXPECT_EQ(store.commentsOn("old").size(), 1u);
        EXPECT_EQ(store.outbox(0).size(), 2u);
    }
    EXPECT_EQ(answer(file_, "PRAGMA user_version"), std::to_string(Store::kVersion));
    // The same as one made anew.
    const fs::path fresh = folder_.path() / "fresh.db";
    { Store store(fresh); }
    const char* tables =
        "SELECT group_concat(sql, ';') FROM (SELECT sql FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE "
        "'sqlite_%' ORDER BY name)";
    EXPECT_EQ(answer(file_, tables), answer(fresh, tables));
}

TEST_F(StoreTest, AMigrationThatIsKilledLeavesTheOldStore) {
    fs::create_directories(file_.parent_path());
    sql(file_, kVersionOne);
    std::mt19937_64 random(test::seed());
    for (int round = 0; round < 40; ++round) {
        const fs::path copy = folder_.path() / "copy.db";
        fs::remove(copy);
        fs::remove(copy.string() + "-journal");
        fs::copy_file(file_, copy);
        const pid_t child = fork();
        if (child == 0) {
            Store store(copy);
            _exit(0);
        }
        std::this_thread::sleep_for(std::chrono::microseconds(integer(random, 0, 4000)));
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        Store store(copy);
        EXPECT_TRUE(store.attempt("old"));
        EXPECT_TRUE(store.commentsOn("old").empty());
    }
}

TEST_F(StoreTest, NothingThatWasStoredIsLostByKillNineInTheMiddle) {
    std::mt19937_64 random(test::seed());
    { Store store(file_); }
    std::set<std::string> promised;
    int inTheMiddle = 0;
    for (int round = 0; round < 60; ++round) {
        int ends[2];
        ASSERT_EQ(pipe(ends), 0);
        const pid_t child = fork();
        if (child == 0) {
            // Tells of each attempt once it is stored.
            Store store(file_);
            for (;;) {
                const Attempt a = attempt(60000);
                store.add(a);
                store.add(Judgement{a.id, 50.0, "", 0});
                if (write(ends[1], a.id.data(), a.id.size()) != static_cast<ssize_t>(a.id.size())) _exit(1);
            }
        }
        close(ends[1]);
        // Once it is at it, whatever else the machine does.
        char first[32];
        ASSERT_EQ(read(ends[0], first, sizeof first), static_cast<ssize_t>(sizeof first));
        promised.insert(std::string(first, sizeof first));
        std::this_thread::sleep_for(std::chrono::microseconds(integer(random, 0, 40000)));
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        if (fs::exists(file_.string() + "-journal")) ++inTheMiddle;
        for (char id[32]; read(ends[0], id, sizeof id) == static_cast<ssize_t>(sizeof id);)
            promised.insert(std::string(id, sizeof id));
        close(ends[0]);
        Store store(file_);
        const std::vector<Attempt> all = store.attempts();
        std::set<std::string> there;
        std::size_t lines = 0;
        for (const Attempt& a : all) {
            there.insert(a.id);
            ASSERT_EQ(a.result.size(), 60000u);
            if (promised.contains(a.id)) {
                ASSERT_TRUE(store.judgementOf(a.id));
            }
            lines += store.judgementOf(a.id) ? 2 : 1;
        }
        for (const std::string& id : promised)
            ASSERT_TRUE(there.contains(id)) << "round " << round;
        // At most the last of each round was stored and not yet told.
        ASSERT_LE(there.size(), promised.size() + static_cast<std::size_t>(round) + 1);
        ASSERT_EQ(store.outbox(0, 1u << 20).size(), lines) << "one line each, never one without the other";
    }
    EXPECT_GT(inTheMiddle, 5) << "the kills came where they were to come";
    EXPECT_GE(promised.size(), 60u);
    EXPECT_EQ(answer(file_, "PRAGMA integrity_check"), "ok");
}

TEST_F(StoreTest, TwoProgramsWriteAtOnce) {
    constexpr int kEach = 60;
    { Store store(file_); }
    std::vector<pid_t> children;
    for (int which = 0; which < 2; ++which) {
        children.push_back(fork());
        if (children.back() == 0) {
            try {
                Store store(file_, 60s);
                for (int i = 0; i < kEach; ++i)
                    store.add(attempt());
            } catch (const std::exception& error) {
                std::fprintf(stderr, "%s\n", error.what());
                _exit(1);
            }
            _exit(0);
        }
    }
    // And a third reads meanwhile.
    Store reader(file_, 60s);
    std::size_t last = 0;
    for (int i = 0; i < 20; ++i) {
        const std::size_t now = reader.attempts().size();
        EXPECT_GE(now, last);
        last = now;
    }
    for (const pid_t child : children) {
        int status = 0;
        waitpid(child, &status, 0);
        EXPECT_EQ(status, 0);
    }
    EXPECT_EQ(reader.attempts().size(), 2u * kEach);
    const std::vector<Outgoing> outbox = reader.outbox(0, 1000);
    ASSERT_EQ(outbox.size(), 2u * kEach);
    for (std::size_t i = 1; i < outbox.size(); ++i)
        EXPECT_GT(outbox[i].sequence, outbox[i - 1].sequence);
}

TEST_F(StoreTest, IsMadeOnceWhenManyComeToItFirst) {
    for (int round = 0; round < 20; ++round) {
        const fs::path file = file_.parent_path() / ("first" + std::to_string(round));
        test::atOnce(6, [&] { EXPECT_EQ(test::errorOf([&] { Store(file).add(attempt()); }), ""); });
        EXPECT_EQ(Store(file).attempts().size(), 6u);
    }
}

TEST_F(StoreTest, SaysWhenAnotherProgramHoldsIt) {
    Store store(file_, 50ms);
    sqlite3* other = nullptr;
    ASSERT_EQ(sqlite3_open(file_.c_str(), &other), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(other, "BEGIN EXCLUSIVE", nullptr, nullptr, nullptr), SQLITE_OK);
    const Attempt a = attempt();
    EXPECT_EQ(test::errorIdOf([&] { store.add(a); }), "store-locked");
    EXPECT_EQ(test::errorIdOf([&] { static_cast<void>(store.attempts()); }), "store-locked");
    EXPECT_EQ(test::errorIdOf([&] { Store second(file_, 50ms); }), "store-locked");
    sqlite3_close(other);
    store.add(a);
    EXPECT_EQ(store.attempts().size(), 1u);
}

TEST_F(StoreTest, RefusesANewerOneAnothersAndWhatIsNone) {
    { Store store(file_); }
    sql(file_, "PRAGMA user_version = 9");
    const core::Error newer = test::errorFrom([&] { Store store(file_); }).value();
    EXPECT_EQ(newer.id(), "store-newer");
    EXPECT_THAT(newer.arguments(), ElementsAre("9", std::to_string(Store::kVersion)));
    EXPECT_EQ(answer(file_, "PRAGMA user_version"), "9") << "left as it is";
    sql(file_, "PRAGMA user_version = -1");
    EXPECT_EQ(test::errorIdOf([&] { Store store(file_); }), "store-damaged") << "no version comes before the first";
    const fs::path others = folder_.path() / "others.db";
    sql(others, "CREATE TABLE t (x); PRAGMA user_version = 1");
    EXPECT_EQ(test::errorIdOf([&] { Store store(others); }), "store-damaged");
    EXPECT_EQ(answer(others, "SELECT count(*) FROM sqlite_schema"), "1") << "nothing was put into it";
    const fs::path text = folder_.path() / "text.db";
    core::writeFile(text, std::string(5000, 'x'));
    EXPECT_EQ(test::errorIdOf([&] { Store store(text); }), "store-damaged");
    EXPECT_EQ(fs::file_size(text), 5000u);
    const core::Error folder = test::errorFrom([&] { Store store(folder_.path()); }).value();
    EXPECT_EQ(folder.id(), "not-writable");
    EXPECT_FALSE(folder.remedy().empty());
}

TEST_F(StoreTest, AFullDiskLosesNothing) {
    Store store(file_);
    store.add(attempt());
    struct rlimit before {};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto old = std::signal(SIGXFSZ, SIG_IGN);
    struct rlimit small = before;
    small.rlim_cur = fs::file_size(file_) + 8192;
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    const Attempt large = attempt(1 << 20);
    const core::Error full = test::errorFrom([&] { store.add(large); }).value();
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, old);
    EXPECT_EQ(full.id(), "no-space") << full.what();
    EXPECT_EQ(store.attempts().size(), 1u);
    store.add(large);
    EXPECT_EQ(store.attempts().size(), 2u);
    EXPECT_EQ(answer(file_, "PRAGMA integrity_check"), "ok");
}

TEST_F(StoreTest, WhatMayOnlyBeReadIsReadAndSaysSoWhenWritten) {
    if (geteuid() == 0) {
        // Root may write everywhere: somebody else looks.
        fs::permissions(folder_.path(), fs::perms::all);
        { Store store(file_); }
        fs::permissions(file_.parent_path(), fs::perms::owner_all | fs::perms::group_exec | fs::perms::others_exec |
                                                 fs::perms::group_read | fs::perms::others_read);
        fs::permissions(file_, fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read);
        const pid_t child = fork();
        if (child == 0) {
            if (setuid(65534) != 0) _exit(2);
            try {
                Store store(file_);
                if (!store.attempts().empty()) _exit(3);
                _exit(test::errorIdOf([&] { store.add(attempt()); }) == "not-writable" ? 0 : 4);
            } catch (const std::exception& error) {
                std::fprintf(stderr, "%s\n", error.what());
                _exit(5);
            }
        }
        int status = 0;
        waitpid(child, &status, 0);
        EXPECT_EQ(WEXITSTATUS(status), 0);
        return;
    }
    { Store store(file_); }
    fs::permissions(file_, fs::perms::owner_read);
    Store store(file_);
    EXPECT_TRUE(store.attempts().empty());
    EXPECT_EQ(test::errorIdOf([&] { store.add(attempt()); }), "not-writable");
}

TEST_F(StoreTest, DamageEndsInOneErrorAndNeverInACrash) {
    {
        Store store(file_);
        for (int i = 0; i < 5; ++i)
            store.add(attempt());
    }
    const std::vector<std::byte> whole = core::readFile(file_);
    std::mt19937_64 random(test::seed());
    int refused = 0;
    for (int round = 0; round < 300; ++round) {
        std::vector<std::byte> bytes = whole;
        if (round % 3 == 0) bytes.resize(static_cast<std::size_t>(integer(random, 1, static_cast<int>(bytes.size()))));
        for (int hits = integer(random, 1, 40); hits > 0; --hits)
            bytes[static_cast<std::size_t>(integer(random, 0, static_cast<int>(bytes.size()) - 1))] =
                static_cast<std::byte>(integer(random, 0, 255));
        const fs::path copy = folder_.path() / "damaged.db";
        fs::remove(copy.string() + "-journal");
        core::writeFile(copy, bytes, {false, false});
        try {
            Store store(copy);
            static_cast<void>(store.attempts());
            static_cast<void>(store.outbox(0));
            store.add(attempt());
        } catch (const core::Error& error) {
            ++refused;
            EXPECT_THAT(error.id(), testing::AnyOf("store-damaged", "store-newer")) << error.what();
            EXPECT_FALSE(error.remedy().empty());
        }
    }
    EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace handpiece::school::store_test
