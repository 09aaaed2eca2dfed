// SPDX-License-Identifier: Apache-2.0
// A school's books in trouble: many workers at once, kill -9, a full disk, a server that is gone, another version.
#include <gmock/gmock.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <optional>
#include <set>
#include <sstream>
#include <thread>

#include "school/store/books_fixture.h"
#include "support/at_once.h"
#include "support/error_of.h"
#include "support/random.h"
#include "support/times.h"

namespace handpiece::school::books_trouble_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

/// Of each trouble; the schedule of the machine is another each time.
int rounds(int few) {
    return test::times("HANDPIECE_KILLS", few);
}

class BooksInTroubleTest : public BooksTest {};
INSTANTIATE_TEST_SUITE_P(Both, BooksInTroubleTest, testing::Values("sqlite", "postgres"),
                         [](const auto& all) { return std::string(all.param); });

TEST_P(BooksInTroubleTest, AnAttemptWaitsToBeScoredOnceItIsWholeByItsAssignmentsRubric) {
    auto books = filled();
    PushedAttempt p = attempt(1, {"one", "two"});
    p.attempt.rubricHash = shortHash(0xdead);
    books->push(p);
    EXPECT_FALSE(books->takeJob("w", kNow, 1000));
    upload(*books, "one");
    EXPECT_FALSE(books->takeJob("w", kNow, 1000));
    upload(*books, "two");
    Job job = books->takeJob("w", kNow, 1000).value();
    EXPECT_EQ(job.attempt, id(1));
    EXPECT_EQ(job.rubric, shortHash(0xab)) << "not what the station says";
    EXPECT_FALSE(books->takeJob("v", kNow + 999, 1000));
    EXPECT_TRUE(books->renew(job, kNow + 999, 1000));
    EXPECT_FALSE(books->takeJob("v", kNow + 1000, 1000)) << "it was renewed";
    const Job again = books->takeJob("v", kNow + 1999, 1000).value();
    EXPECT_EQ(again.number, job.number);
    EXPECT_FALSE(books->renew(job, kNow + 1999, 1000)) << "another has it";
    EXPECT_FALSE(books->finish(job, scoreOf(job, "w")));
    EXPECT_FALSE(books->giveBack(job));
    EXPECT_THAT(books->scoresOf(id(1)), IsEmpty());
    EXPECT_TRUE(books->finish(again, scoreOf(again, "v")));
    EXPECT_FALSE(books->finish(again, scoreOf(again, "v"))) << "once";
    ASSERT_THAT(books->scoresOf(id(1)), SizeIs(1));
    EXPECT_EQ(books->scoresOf(id(1))[0].worker, "v");
    EXPECT_EQ(books->classPage("c1").cells.at(0).state, "proven");
    EXPECT_EQ(books->classPage("c1").cells.at(0).score, 6.5);
    EXPECT_FALSE(books->takeJob("w", kNow + kDay, 1000));

    // A worker that comes late, but before another took it, has done it.
    EXPECT_EQ(books->rescore("second", "a1", shortHash(0xac), kAdmin), 1);
    EXPECT_EQ(books->rescore("second", "a1", shortHash(0xac), kAdmin), 0) << "nothing came since";
    const Job late = books->takeJob("w", kNow, 10).value();
    EXPECT_EQ(late.rubric, shortHash(0xac));
    Score refused = scoreOf(late, "w");
    refused.state = "refused";
    refused.reason = "softer tissues than the exercise has";
    EXPECT_TRUE(books->finish(late, refused));
    EXPECT_EQ(books->classPage("c1").cells.at(0).state, "refused");
    EXPECT_EQ(books->classPage("c1").cells.at(0).reason, refused.reason);
    EXPECT_EQ(books->progress("second").done, 1);

    // One that kills its workers, or that none can do, is given up.
    books->rescore("third", "a1", shortHash(0xac), kAdmin);
    Milliseconds now = kNow;
    for (int turn = 1; turn <= Books::kMostTurns; ++turn, now += 100)
        EXPECT_EQ(books->takeJob("w", now, 100)->turn, turn);
    EXPECT_FALSE(books->takeJob("w", now, 100));
    EXPECT_EQ(books->progress("third").failed, 1);
    books->rescore("fourth", "a1", shortHash(0xac), kAdmin);
    for (int turn = 1; turn <= Books::kMostTurns; ++turn)
        EXPECT_TRUE(books->giveBack(books->takeJob("w", now, 100).value(), now));
    EXPECT_FALSE(books->takeJob("w", now, 100));
    EXPECT_EQ(books->progress("fourth").failed, 1);
    // But not for good: an hour later there is one more turn.
    EXPECT_EQ(books->retry(now), 0);
    const Milliseconds later = now + 3'600'000;
    EXPECT_EQ(books->retry(later), 2);
    EXPECT_EQ(books->progress("fourth").waiting, 1);
    const Job third = books->takeJob("w", later, 100).value(), fourth = books->takeJob("w", later, 100).value();
    EXPECT_TRUE(books->finish(fourth, scoreOf(fourth, "w")));
    EXPECT_FALSE(books->takeJob("w", later + 100, 100)) << "it is given up again";
    EXPECT_EQ(books->progress("third").failed, 1);
    EXPECT_FALSE(books->finish(third, scoreOf(third, "w")));
}

// Threads and processes, some of which die with work in hand.
TEST_P(BooksInTroubleTest, WorkersAtOnceShareTheWorkAndEachJobIsDoneOnce) {
    constexpr int kJobs = 120, kThreads = 3, kProcesses = 3;
    std::mt19937_64 random(test::seed());
    {
        auto books = filled();
        for (std::uint64_t n = 1; n <= kJobs; ++n)
            books->push(attempt(n));
    }
    std::atomic<Milliseconds> clock = kNow;
    std::vector<pid_t> children;
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    for (int c = 0; c < kProcesses; ++c) {
        const pid_t child = fork();
        if (child == 0) {
            // Takes, and does most of what it took; the test kills it in the middle.
            try {
                auto books = open();
                for (int i = 0;; ++i) {
                    const std::optional<Job> job = books->takeJob(fmt::format("p{}", c), kNow, 1000);
                    if (!job) _exit(0);
                    if (i % 4 != 3 && books->finish(*job, scoreOf(*job, fmt::format("p{}", c))))
                        if (write(ends[1], &job->number, sizeof job->number) != sizeof job->number) _exit(1);
                }
            } catch (const std::exception& error) {
                std::fprintf(stderr, "%s\n", error.what());
                _exit(3);
            }
        }
        children.push_back(child);
    }
    close(ends[1]);
    std::atomic<bool> isOver = false;
    std::vector<std::thread> threads;
    std::vector<std::vector<std::int64_t>> done(kThreads);
    for (int t = 0; t < kThreads; ++t)
        threads.emplace_back([&, t] {
            auto books = open();
            while (!isOver) {
                const std::optional<Job> job = books->takeJob(fmt::format("t{}", t), clock, 1000);
                if (!job) {
                    std::this_thread::sleep_for(2ms);
                    continue;
                }
                if (books->finish(*job, scoreOf(*job, fmt::format("t{}", t))))
                    done[static_cast<std::size_t>(t)].push_back(job->number);
            }
        });
    std::this_thread::sleep_for(std::chrono::milliseconds(30 + below(random, 100)));
    for (const pid_t child : children)
        kill(child, SIGKILL);
    for (const pid_t child : children) {
        int status = 0;
        waitpid(child, &status, 0);
        EXPECT_FALSE(WIFEXITED(status) && WEXITSTATUS(status) != 0) << "a worker failed";
    }
    clock += 1000;  // what they had in hand is free again
    auto books = open();
    for (int i = 0; i < 60000 && books->progress("arrival").done < kJobs; ++i)
        std::this_thread::sleep_for(5ms);
    isOver = true;
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(books->progress("arrival").done, kJobs);
    std::multiset<std::int64_t> finished;
    for (const auto& one : done)
        finished.insert(one.begin(), one.end());
    int byProcesses = 0;
    for (std::int64_t number = 0; read(ends[0], &number, sizeof number) == sizeof number; ++byProcesses)
        finished.insert(number);
    close(ends[0]);
    for (const std::int64_t number : finished)
        EXPECT_EQ(finished.count(number), 1u) << "told by two that they did it";
    for (std::uint64_t n = 1; n <= kJobs; ++n)
        EXPECT_THAT(books->scoresOf(id(n)), SizeIs(1));
    // Who was killed between the score and telling it told nothing.
    EXPECT_GE(finished.size() + kProcesses, static_cast<std::size_t>(kJobs));
    RecordProperty("byProcesses", byProcesses);
}

TEST_P(BooksInTroubleTest, RefuseANewerVersionAndAnothersDatabase) {
    { auto books = filled(); }
    const std::string before = dump();
    sql("UPDATE handpiece_books SET version = 99");
    const core::Error newer = test::errorFrom([&] { static_cast<void>(open()); }).value();
    EXPECT_EQ(newer.id(), "store-newer");
    EXPECT_THAT(newer.arguments(), ElementsAre("99", std::to_string(Books::kVersion)));
    EXPECT_FALSE(newer.remedy().empty());
    EXPECT_EQ(sql("SELECT version FROM handpiece_books"), "99") << "left as it is";
    sql("UPDATE handpiece_books SET version = -1");
    EXPECT_EQ(test::errorIdOf([&] { static_cast<void>(open()); }), "store-damaged");
    sql(fmt::format("UPDATE handpiece_books SET version = {}", static_cast<int>(Books::kVersion)));
    EXPECT_EQ(dump(), before);
    if (isPostgres()) {
        schema_ = server()->newSchema();
        address_ = server()->address(schema_);
    } else {
        data_ = folder_.path() / "other";
        fs::create_directories(data_);
    }
    sql("CREATE TABLE recipes (name TEXT)");
    EXPECT_EQ(test::errorIdOf([&] { static_cast<void>(open()); }), "store-damaged");
    if (isPostgres()) return;
    core::writeFile(data_ / "books.db", std::string(9000, 'x'));
    const core::Error none = test::errorFrom([&] { static_cast<void>(open()); }).value();
    EXPECT_EQ(none.id(), "store-damaged");
    EXPECT_THAT(none.problem(), HasSubstr("school's books"));
}

// What version 1 was.
TEST_P(BooksInTroubleTest, ComeUpFromVersionOneAlsoWhenThatIsKilled) {
    { filled()->push(attempt(1)); }
    // What version one did not know.
    sql("UPDATE stations SET kind = 'practice'");
    sql("DELETE FROM deliveries");
    const std::string before = dump();
    const auto schema = [&] {
        return isPostgres()
                   ? sql(fmt::format("SELECT string_agg(table_name || '.' || column_name || ' ' || data_type, ';' "
                                     "ORDER BY table_name, column_name) FROM information_schema.columns "
                                     "WHERE table_schema = '{}'",
                                     schema_))
                   : sql("SELECT group_concat(sql, ';') FROM (SELECT sql FROM sqlite_schema ORDER BY name)");
    };
    const auto dropLaterTables = [&] {
        const std::string first =
            " people identities roles classes enrolments files rubrics packs assignments stations station_codes "
            "attempts attempt_files judgements comments shares marks jobs scores audit handpiece_books ";
        std::istringstream names(
            isPostgres()
                ? sql(fmt::format("SELECT string_agg(tablename, ' ') FROM pg_tables WHERE schemaname = '{}'", schema_))
                : sql("SELECT group_concat(name, ' ') FROM sqlite_schema WHERE type = 'table'"));
        for (std::string name; names >> name;)
            if (first.find(" " + name + " ") == first.npos)
                sql(fmt::format("DROP TABLE {}{}", name, isPostgres() ? " CASCADE" : ""));
        // And what later versions added to the first ones.
        for (const auto& [table, column] : {std::pair{"stations", "kind"},
                                            {"stations", "released"},
                                            {"stations", "person"},
                                            {"stations", "ends"},
                                            {"station_codes", "kind"},
                                            {"station_codes", "person"}})
            if (isPostgres())
                sql(fmt::format("ALTER TABLE {} DROP COLUMN IF EXISTS {}", table, column));
            else if (sql(fmt::format("SELECT count(*) FROM pragma_table_info('{}') WHERE name = '{}'", table,
                                     column)) == "1")
                sql(fmt::format("ALTER TABLE {} DROP COLUMN {}", table, column));
    };
    const std::string whole = schema();
    std::mt19937_64 random(test::seed());
    for (int round = 0; round < rounds(6); ++round) {
        dropLaterTables();
        sql("UPDATE handpiece_books SET version = 1");
        ASSERT_NE(schema(), whole);
        const pid_t child = fork();
        if (child == 0) {
            static_cast<void>(open());
            _exit(0);
        }
        std::this_thread::sleep_for(std::chrono::microseconds(below(random, isPostgres() ? 40000 : 8000)));
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        EXPECT_EQ(dump(), before);
        EXPECT_EQ(schema(), whole);
        EXPECT_EQ(sql("SELECT version FROM handpiece_books"), std::to_string(Books::kVersion));
    }
}

TEST_P(BooksInTroubleTest, SayWhenAnotherHoldsThemAndGoOnReading) {
    auto books = filled();
    auto patient = open(500ms);
    std::unique_ptr<Books> holder = open();
    // Another program in the middle of writing.
    sqlite3* other = nullptr;
    std::thread inPostgres;
    // Not that of one of another test who is dying.
    const std::string itsLock = fmt::format(
        " FROM pg_locks WHERE locktype = 'advisory' AND granted AND objid::int8 = hashtext('handpiece {}')::int8 & "
        "4294967295",
        schema_);
    if (isPostgres()) {
        inPostgres = std::thread([&] {
            // Until it is cut off.
            EXPECT_THROW(server()->sql(schema_, fmt::format("BEGIN; SELECT pg_advisory_xact_lock(hashtext('handpiece "
                                                            "{}')); SELECT pg_sleep(600)",
                                                            schema_)),
                         std::runtime_error);
        });
        while (server()->sql(schema_, "SELECT count(*)" + itsLock) == "0")
            std::this_thread::sleep_for(5ms);
    } else {
        ASSERT_EQ(sqlite3_open((data_ / "books.db").c_str(), &other), SQLITE_OK);
        ASSERT_EQ(sqlite3_exec(other, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr), SQLITE_OK);
    }
    EXPECT_EQ(test::errorIdOf([&] { patient->push(attempt(1)); }), "store-locked");
    EXPECT_EQ(test::errorOf([&] { EXPECT_THAT(patient->classPage("c1").students, SizeIs(3)); }), "");
    if (isPostgres()) {
        server()->sql(schema_, "SELECT pg_terminate_backend(pid)" + itsLock);
        inPostgres.join();
    } else {
        sqlite3_close(other);
    }
    EXPECT_TRUE(patient->push(attempt(1)));
}

TEST_P(BooksInTroubleTest, WhoWritesWithoutAPauseStarvesNobody) {
    { auto books = filled(); }
    std::atomic<bool> isOver = false;
    std::vector<std::thread> busy;
    for (std::uint64_t t = 0; t < 3; ++t)
        busy.emplace_back([&, t] {
            auto books = open();
            for (std::uint64_t n = 1; !isOver; ++n)
                EXPECT_EQ(test::errorOf([&] { books->push(attempt(t << 32 | n)); }), "");
        });
    // The others never pause: who is starved waits for ever. A laden machine's disk alone may take some seconds.
    auto books = open(30s);
    for (std::uint64_t n = 1; n <= 10; ++n)
        EXPECT_EQ(test::errorOf([&] { books->push(attempt(0xf00000000 | n)); }), "");
    isOver = true;
    for (std::thread& thread : busy)
        thread.join();
}

TEST_P(BooksInTroubleTest, AreMadeOnceWhenManyComeToThemFirst) {
    for (int round = 0; round < rounds(5); ++round) {
        data_ = folder_.path() / fmt::format("first{}", round);
        if (isPostgres()) address_ = server()->address(schema_ = server()->newSchema());
        test::atOnce(6, [&] { EXPECT_EQ(test::errorOf([&] { static_cast<void>(open()); }), ""); });
        EXPECT_EQ(sql("SELECT count(*) FROM handpiece_books"), "1");
    }
}

TEST_P(BooksInTroubleTest, MakingThemIsKilledAtAnyMomentAndBegunAnew) {
    std::mt19937_64 random(test::seed());
    int unmade = 0;
    const auto start = std::chrono::steady_clock::now();
    static_cast<void>(open());
    // How long it takes is what else the machine has to do: where the kills come too late, the next come sooner.
    auto making = std::chrono::steady_clock::now() - start;
    for (int round = 0; round < rounds(10); ++round) {
        data_ = folder_.path() / fmt::format("made{}", round);
        if (isPostgres()) address_ = server()->address(schema_ = server()->newSchema());
        const pid_t child = fork();
        if (child == 0) {
            static_cast<void>(open());
            _exit(0);
        }
        std::this_thread::sleep_for(making * below(random, 1000) / 1000);
        kill(child, SIGKILL);
        int status = 0;
        waitpid(child, &status, 0);
        if (WIFSIGNALED(status))
            ++unmade;
        else
            making = making * 3 / 4;
        auto books = filled();
        EXPECT_THAT(books->people(), SizeIs(5));
    }
    EXPECT_GT(unmade, 0);
}

// The server is killed while it takes attempts and files: what it had confirmed is there, and nothing is there in part.
TEST_P(BooksInTroubleTest, NothingConfirmedIsLostAndNothingHalfThereAfterKillNine) {
    { auto books = filled(); }
    std::mt19937_64 random(test::seed());
    std::set<std::uint64_t> promised;
    std::uint64_t next = 1;
    int inUpload = 0;
    const auto file = [](std::uint64_t n) {
        std::mt19937_64 own(n);
        return randomBytes(own, 150'000);
    };
    for (int round = 0; round < rounds(15); ++round) {
        int ends[2];
        ASSERT_EQ(pipe(ends), 0);
        const pid_t child = fork();
        if (child == 0) {
            try {
                auto books = open();
                for (std::uint64_t n = next;; ++n) {
                    const std::string bytes = file(n);
                    const PushedAttempt p = attempt(n, {bytes}, 20'000);
                    books->push(p);
                    const Upload up = uploadOf(bytes);
                    for (bool done = false; !done;) {
                        const std::uint64_t there = books->received(up, kNow);
                        if (round % 3 == 0 && n > next && there >= 60'000) raise(SIGKILL);
                        const std::string piece = bytes.substr(there, 20'000);
                        done = books->append(up, there, bytesOf(piece), kNow);
                    }
                    books->push(Comment{id(0x10000 + n), p.attempt.id, "t1", "said", {}, {}, 1});
                    if (write(ends[1], &n, sizeof n) != sizeof n) _exit(1);
                }
            } catch (const std::exception& error) {
                std::fprintf(stderr, "%s\n", error.what());
                _exit(3);
            }
        }
        close(ends[1]);
        std::uint64_t n = 0;
        ASSERT_EQ(read(ends[0], &n, sizeof n), static_cast<ssize_t>(sizeof n));
        promised.insert(n);
        // Every third time in the middle of a file, else whenever.
        if (round % 3 != 0) {
            std::this_thread::sleep_for(std::chrono::microseconds(below(random, 15000)));
            kill(child, SIGKILL);
        }
        waitpid(child, nullptr, 0);
        while (read(ends[0], &n, sizeof n) == sizeof n)
            promised.insert(n);
        close(ends[0]);
        next = *promised.rbegin() + 1;
        if (!fs::is_empty(data_ / "uploads")) ++inUpload;
    }
    auto books = open();
    for (const std::uint64_t n : promised) {
        const std::string bytes = file(n);
        const PushedAttempt p = attempt(n, {bytes}, 20'000);
        EXPECT_FALSE(books->push(p)) << "it is there, the same";
        EXPECT_EQ(books->received(uploadOf(bytes), kNow), bytes.size());
        EXPECT_EQ(sha256Of(books->files().path(sha256(bytes))), sha256(bytes));
        EXPECT_THAT(books->commentsOn(p.attempt.id), SizeIs(1));
    }
    // What was not confirmed was begun again under the same number; the last may be there without its promise.
    const std::int64_t kept = static_cast<std::int64_t>(promised.size());
    EXPECT_THAT(books->progress("arrival").waiting, testing::AnyOf(kept, kept + 1));
    for (const std::string& hash : books->files().all())
        EXPECT_EQ(sha256Of(books->files().path(hash)), hash) << "nothing in part";
    EXPECT_EQ(sql("SELECT count(*) FROM attempts"), sql("SELECT count(DISTINCT attempt) FROM attempt_files"));
    EXPECT_GE(inUpload, (rounds(15) + 2) / 3) << "the kills came where they were to come";
}

TEST_P(BooksInTroubleTest, AFullDiskIsOneErrorAndLosesNothing) {
    const fs::path small = (isPostgres() ? server()->folder() : folder_.path()) / "small";
    fs::create_directories(small);
    if (mount("tmpfs", small.c_str(), "tmpfs", 0, "size=4m,mode=0777") != 0)
        GTEST_SKIP() << "a small disk can only be mounted as root: the full disk is not tested";
    struct Unmount {
        fs::path path;
        ~Unmount() { umount2(path.c_str(), MNT_DETACH); }
    } const unmount{small};
    if (isPostgres()) {
        const fs::path place = small / "place";
        fs::create_directories(place);
        server()->giveToServer(place);
        server()->sql("public", fmt::format("CREATE TABLESPACE small LOCATION '{}'", place.string()));
        address_ += "%20-cdefault_tablespace%3Dsmall";
    } else {
        data_ = small / "data";
    }
    {
        auto books = filled();
        std::uint64_t n = 1;
        std::optional<core::Error> full;
        while (!full && n < 300) {
            std::mt19937_64 own(n);
            std::string result;
            while (result.size() < 60'000)
                result += fmt::format("{:016x}", own());
            PushedAttempt p = attempt(n);
            p.attempt.result = result;
            full = test::errorFrom([&] { books->push(p); });
            if (!full) ++n;
        }
        ASSERT_TRUE(full) << "it never was full";
        EXPECT_EQ(full->id(), "no-space") << full->what();
        EXPECT_FALSE(full->remedy().empty());
        EXPECT_EQ(sql("SELECT count(*) FROM attempts"), std::to_string(n - 1));
        EXPECT_EQ(books->people().size(), 5u) << "and can be read";
        if (!isPostgres()) {
            std::mt19937_64 random(test::seed());
            const std::string bytes = randomBytes(random, 4'000'000);
            const Upload up = uploadOf(bytes);
            EXPECT_EQ(test::errorIdOf([&] { books->append(up, 0, bytesOf(bytes), kNow); }), "no-space");
            EXPECT_FALSE(books->files().has(up.hash));
            // Room is made: both go on where they were.
            const std::uint64_t there = books->received(up, kNow);
            ASSERT_EQ(mount("tmpfs", small.c_str(), "tmpfs", MS_REMOUNT, "size=32m"), 0);
            EXPECT_TRUE(books->append(up, there, bytesOf(bytes.substr(there)), kNow));
        } else {
            ASSERT_EQ(mount("tmpfs", small.c_str(), "tmpfs", MS_REMOUNT, "size=32m"), 0);
        }
        EXPECT_TRUE(books->push(attempt(n)));
        EXPECT_EQ(sql("SELECT count(*) FROM attempts"), std::to_string(n));
    }
    if (!isPostgres()) return;
    server()->sql("public", fmt::format("DROP SCHEMA {} CASCADE", schema_));
    server()->sql("public", "DROP TABLESPACE small");
}

TEST(BooksInPostgres, SayWhenTheServerIsGoneAndGoOnWhenItIsBackWithAllThatWasConfirmed) {
    if (!server()) GTEST_SKIP() << kNoServer;
    core::PrivateFolder folder;
    const std::string address = server()->address(server()->newSchema());
    Books books(folder.path() / "data", address, 5s);
    fill(books);
    std::mt19937_64 random(test::seed());
    std::uint64_t next = 1, sent = 1;
    for (int round = 0; round < rounds(4); ++round) {
        std::atomic<std::uint64_t> pushed = 0;
        const std::uint64_t most = below(random, 8);
        std::thread killer([&, wait = below(random, 3000)] {
            while (pushed < most)
                std::this_thread::sleep_for(100us);
            std::this_thread::sleep_for(std::chrono::microseconds(wait));
            server()->kill();
        });
        sent += most + 1;
        std::uint64_t confirmed = next;
        std::optional<core::Error> gone;
        while (!gone) {
            gone = test::errorFrom([&] { books.push(attempt(next)); });
            if (!gone) confirmed = ++next, ++pushed;
        }
        killer.join();
        EXPECT_EQ(gone->id(), "store-gone") << gone->what();
        EXPECT_FALSE(gone->remedy().empty());
        EXPECT_EQ(test::errorIdOf([&] { static_cast<void>(books.classPage("c1")); }), "store-gone");
        EXPECT_EQ(test::errorIdOf([&] { Books other(folder.path() / "data", address, 2s); }), "store-gone");
        server()->run();
        // The same object goes on; the last one may have been written and not confirmed: it comes again.
        for (std::uint64_t n = 1; n < confirmed; ++n)
            ASSERT_FALSE(books.push(attempt(n))) << "lost: " << n;
        books.push(attempt(next));
        ++next;
    }
    EXPECT_GE(next, sent);
    EXPECT_EQ(books.progress("arrival").waiting, static_cast<std::int64_t>(next) - 1);
}

TEST(BooksInPostgres, SayWhatIsWrongWithAnAddressAndNeverItsPassword) {
    core::PrivateFolder folder;
    const auto error = [&](const std::string& address) {
        return test::errorFrom([&] { Books books(folder.path() / "data", address, 2s); }).value();
    };
    EXPECT_EQ(error("postgresql://[bad").id(), "store-refused");
    const core::Error gone = error("postgresql://me:secret@127.0.0.1:1/school");
    EXPECT_EQ(gone.id(), "store-gone");
    EXPECT_THAT(gone.what(), HasSubstr("127.0.0.1:1/school"));
    EXPECT_THAT(gone.what(), Not(HasSubstr("secret")));
    if (!server()) GTEST_SKIP() << kNoServer;
    const std::string address = server()->address("public");
    EXPECT_EQ(error("postgresql://nobody:secret@/postgres" + address.substr(address.find('?'))).id(), "store-refused");
    EXPECT_EQ(error("postgresql://school@/nowhere" + address.substr(address.find('?'))).id(), "store-refused");
}
TEST_P(BooksInTroubleTest, TheLogStaysShortThoughSomebodyAlwaysReads) {
    if (isPostgres()) GTEST_SKIP() << "PostgreSQL keeps its own";
    auto books = filled();
    std::atomic<bool> ends{false};
    std::vector<std::thread> readers;
    // One page after the other: at any moment one of them has the books open.
    for (int i = 0; i < 4; ++i)
        readers.emplace_back([&] {
            const auto own = open();
            while (!ends)
                (void)own->everything();
        });
    std::uintmax_t longest = 0, written = 0;
    for (std::uint64_t i = 1; i <= 600; ++i) {
        books->push(attempt(i, {}, 60'000));
        written += 60'000;
        longest = std::max(longest, fs::file_size(data_ / "books.db-wal"));
    }
    ends = true;
    for (std::thread& reader : readers)
        reader.join();
    RecordProperty("longest_log_bytes", std::to_string(longest));
    std::printf("the log had %.1f MB at most, of %.1f MB written\n", 1e-6 * static_cast<double>(longest),
                1e-6 * static_cast<double>(written));
    EXPECT_LT(longest, 16u << 20);
}

}  // namespace
}  // namespace handpiece::school::books_trouble_test
