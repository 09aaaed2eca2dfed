// SPDX-License-Identifier: Apache-2.0
// A school's books: what is put in comes back, what comes twice or in another order makes the same books, the same from
// both databases.
#include <gmock/gmock.h>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <thread>

#include "handpiece/school/store/books_accounts.h"
#include "handpiece/school/store/retention.h"
#include "school/store/books_fixture.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::school::books_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

INSTANTIATE_TEST_SUITE_P(Both, BooksTest, testing::Values("sqlite", "postgres"),
                         [](const auto& all) { return std::string(all.param); });

TEST_P(BooksTest, TellBackAllThatWasPutIn) {
    {
        auto books = filled();
        PushedAttempt p = attempt(1, {"session one", "session two"});
        p.attempt.result = "\xe6\x84\x9b 'quoted' \"\n\t\x01\\";
        p.attempt.score = 0.1 + 0.2;
        EXPECT_TRUE(books->push(p));
        EXPECT_TRUE(books->push(Judgement{p.attempt.id, 80.0, "even", 4}));
        EXPECT_TRUE(books->push(Comment{id(7), p.attempt.id, "t1", "here", core::Vec3(1.5, -2.0, 0.25), 12.5, 5}));
        EXPECT_TRUE(books->push(Comment{id(8), p.attempt.id, "s1", "why?", {}, {}, 6}));
        EXPECT_TRUE(books->push(Mark{id(9), p.attempt.id, "t1", "teacher", "pass", 8.5, 10.0, "{}", kNow}, kAdmin));
    }
    const auto books = open();
    EXPECT_THAT(books->people(), SizeIs(5));
    const Person teacher = books->person("t1").value();
    EXPECT_EQ(teacher.name, "Sato Yuki");
    EXPECT_EQ(teacher.external, "x-1");
    EXPECT_EQ(teacher.password, "$argon2id$2");
    EXPECT_THAT(teacher.roles, ElementsAre("examiner", "teacher"));
    EXPECT_EQ(books->personByLogin("mori")->code, "s1");
    EXPECT_FALSE(books->personByLogin("")) << "who has no login has none, and not the same";
    EXPECT_FALSE(books->person("nobody"));
    EXPECT_EQ(books->classes().at(0).retentionDays, 365);
    EXPECT_THAT(books->enrolments("c1"), SizeIs(4));
    EXPECT_EQ(books->rubric(shortHash(0xac))->version, 2);
    EXPECT_EQ(books->pack(shortHash(0xe0))->file, sha256(kPackFile));
    EXPECT_EQ(books->assignment("a1")->helps, "glass");
    EXPECT_EQ(books->stationByKey(std::string(40, 'k'))->name, "Room 2, 14");
    EXPECT_FALSE(books->stationByKey(std::string(40, 'x')));
    const PushedAttempt back = books->attempt(id(1)).value();
    EXPECT_EQ(back.attempt.result, "\xe6\x84\x9b 'quoted' \"\n\t\x01\\");
    EXPECT_EQ(back.attempt.score, 0.1 + 0.2) << "the same bits";
    EXPECT_EQ(back.attempt.workedS, 540.1);
    EXPECT_TRUE(back.attempt.borderline);
    EXPECT_EQ(back.attempt.passed, "teacher");
    EXPECT_EQ(back.person, "s1");
    EXPECT_THAT(back.files, ElementsAre(sha256("session one"), sha256("session two")));
    EXPECT_THAT(back.attempt.sessionHashes, ElementsAre(shortHash(1), shortHash(2)));
    EXPECT_THAT(books->missingFiles(kStation), SizeIs(2));
    const std::vector<Comment> comments = books->commentsOn(id(1));
    ASSERT_THAT(comments, SizeIs(2));
    EXPECT_EQ(*comments[0].placeMm, core::Vec3(1.5, -2.0, 0.25));
    EXPECT_FALSE(comments[1].placeMm);
    EXPECT_EQ(books->marksOf(id(1)).at(0).points, 8.5);
    const ClassPage page = books->classPage("c1");
    EXPECT_THAT(page.students, SizeIs(3)) << "no teacher among them";
    EXPECT_EQ(page.students[0].name, "Mori Aiko");
    ASSERT_THAT(page.cells, SizeIs(1));
    EXPECT_EQ(page.cells[0].state, "provisional");
    EXPECT_EQ(page.cells[0].marks, 1);
    if (!isPostgres()) {
        const auto onlyOwner = fs::perms::owner_read | fs::perms::owner_write;
        EXPECT_EQ(fs::status(data_ / "books.db").permissions(), onlyOwner);
        EXPECT_EQ(fs::status(data_ / "books.db-wal").permissions(), onlyOwner);
    }
    EXPECT_EQ(fs::status(data_).permissions(), fs::perms::owner_all);
}

TEST_P(BooksTest, APushThatComesAgainIsNoErrorAndAnotherContentIsToldAndChangesNothing) {
    auto books = filled();
    const PushedAttempt first = attempt(1, {"a", "b"});
    EXPECT_TRUE(books->push(first));
    EXPECT_FALSE(books->push(first));
    PushedAttempt later = first;
    later.received += 1000;
    EXPECT_FALSE(books->push(later)) << "when it came is the server's affair";
    const Comment comment{id(5), id(1), "t1", "here", core::Vec3(1, 2, 3), {}, 5};
    const Judgement judgement{id(1), 70.0, "", 3};
    const Mark mark{id(6), id(1), "t1", "blind", "pass", 1.0, 2.0, "{}", kNow};
    EXPECT_TRUE(books->push(comment) && books->push(judgement) && books->push(mark, kAdmin));
    EXPECT_FALSE(books->push(comment) || books->push(judgement) || books->push(mark, kAdmin));
    const std::string before = dump();

    const std::vector<std::function<void(PushedAttempt&)>> changes = {
        [](PushedAttempt& p) { p.person = "s2"; },
        [](PushedAttempt& p) { p.assignment = ""; },
        [](PushedAttempt& p) { p.files[0] = sha256("c"); },
        [](PushedAttempt& p) { std::swap(p.files[0], p.files[1]); },
        [](PushedAttempt& p) { p.attempt.exercise += "x"; },
        [](PushedAttempt& p) { p.attempt.exerciseHash = shortHash(1); },
        [](PushedAttempt& p) { p.attempt.rubricHash = shortHash(1); },
        [](PushedAttempt& p) { p.attempt.sessionHashes[1] = shortHash(9); },
        [](PushedAttempt& p) { p.attempt.began -= 1; },
        [](PushedAttempt& p) { p.attempt.finished += 1; },
        [](PushedAttempt& p) { p.attempt.device = "arm"; },
        [](PushedAttempt& p) { p.attempt.motionScale = 2.0; },
        [](PushedAttempt& p) { p.attempt.score = std::nextafter(p.attempt.score, 10.0); },
        [](PushedAttempt& p) { p.attempt.maxScore = 11.0; },
        [](PushedAttempt& p) { p.attempt.wholeScore = 13.0; },
        [](PushedAttempt& p) { p.attempt.passed = "yes"; },
        [](PushedAttempt& p) { p.attempt.borderline = false; },
        [](PushedAttempt& p) { p.attempt.workedS = 1.0; },
        [](PushedAttempt& p) { p.attempt.limitS = 1.0; },
        [](PushedAttempt& p) { p.attempt.result[17] = 'x'; },
    };
    for (std::size_t i = 0; i < changes.size(); ++i) {
        PushedAttempt other = first;
        changes[i](other);
        const core::Error refused = test::errorFrom([&] { books->push(other); }).value();
        EXPECT_EQ(refused.id(), "books-changed") << i;
        EXPECT_THAT(refused.arguments(), ElementsAre("attempt", id(1)));
        EXPECT_FALSE(refused.remedy().empty());
    }
    Comment otherComment = comment;
    otherComment.placeMm.reset();
    EXPECT_EQ(test::errorIdOf([&] { books->push(otherComment); }), "books-changed");
    EXPECT_EQ(test::errorIdOf([&] { books->push(Judgement{id(1), 71.0, "", 3}); }), "books-changed");
    Mark otherMark = mark;
    otherMark.points = 2.0;
    EXPECT_EQ(test::errorIdOf([&] { books->push(otherMark, kAdmin); }), "books-changed");
    EXPECT_EQ(dump(), before);
}

TEST_P(BooksTest, SayWhatIsUnknownDoubleOrWrongAndWriteNothingOfIt) {
    auto books = filled();
    books->push(attempt(1));
    const std::string before = dump();
    const auto is = [&](const char* expected, const std::function<void()>& work) {
        const std::optional<core::Error> error = test::errorFrom(work);
        ASSERT_TRUE(error) << expected;
        EXPECT_EQ(error->id(), expected) << error->what();
        EXPECT_FALSE(error->remedy().empty()) << error->what();
    };
    const auto change = [](PushedAttempt p, const std::function<void(PushedAttempt&)>& how) {
        how(p);
        return p;
    };
    const PushedAttempt p = attempt(2);
    is("books-unknown", [&] { books->push(change(p, [](auto& x) { x.person = "s9"; })); });
    is("books-unknown", [&] { books->push(change(p, [](auto& x) { x.station = id(1); })); });
    is("books-unknown", [&] { books->push(change(p, [](auto& x) { x.assignment = "a9"; })); });
    is("books-invalid", [&] { books->push(change(p, [](auto& x) { x.attempt.id = "../../etc/passwd"; })); });
    is("books-invalid", [&] { books->push(change(p, [](auto& x) { x.attempt.passed = "maybe"; })); });
    is("books-invalid", [&] { books->push(change(p, [](auto& x) { x.attempt.score = std::nan(""); })); });
    is("books-invalid", [&] { books->push(change(p, [](auto& x) { x.attempt.maxScore = HUGE_VAL; })); });
    is("books-invalid", [&] { books->push(change(p, [](auto& x) { x.files = {sha256("a")}; })); });
    for (const std::string& bad :
         {std::string("a\0b", 3), std::string("\xff"), std::string("\xc0\x80"), std::string("\xed\xa0\x80"),
          std::string("\xf4\x90\x80\x80"), std::string("\xe6\x84"), std::string("\xe0\x80\xaf"),
          std::string("\xf0\x80\x80\x80"), std::string("\x80")})
        is("books-invalid", [&] { books->push(change(p, [&](auto& x) { x.attempt.result = bad; })); });
    is("books-unknown", [&] { books->push(Judgement{id(77), 1.0, "", 0}); });
    is("books-unknown", [&] { books->push(Comment{id(7), id(77), "t1", "", {}, {}, 0}); });
    is("books-unknown", [&] { books->push(Comment{id(7), id(1), "t9", "", {}, {}, 0}); });
    is("books-unknown", [&] { books->push(Mark{id(7), id(77), "t1", "blind"}, kAdmin); });
    is("books-invalid", [&] { books->push(Mark{id(7), id(1), "t1", "loud"}, kAdmin); });
    // A list of people: all or none.
    is("books-duplicate", [&] { books->add(std::vector<Person>{{"n1", "N", "n"}, {"s1", "Again", "z"}}, kAdmin); });
    is("books-duplicate", [&] { books->add(std::vector<Person>{{"n1", "N", "n"}, {"n2", "N", "n"}}, kAdmin); });
    is("books-duplicate", [&] { books->add(std::vector<Person>{{"n1", "N", "", "x-1"}}, kAdmin); });
    is("books-invalid", [&] { books->add(std::vector<Person>{{"n1", "N", "", "", "", {"king"}}}, kAdmin); });
    for (const char* code : {"", "a b", "../x", "a/b", "\xe6\x84\x9b"})
        is("books-invalid", [&] { books->add(std::vector<Person>{{code, "N"}}, kAdmin); });
    is("books-duplicate", [&] { books->rename("s1", "N", "sato", kAdmin); });
    is("books-unknown", [&] { books->rename("s9", "N", "n", kAdmin); });
    is("books-unknown", [&] { books->setPassword("s9", "x", kAdmin); });
    is("books-invalid", [&] { books->setRoles("s1", {"teacher", "king"}, kAdmin); });
    is("books-unknown", [&] { books->erase("s9", kAdmin); });
    is("books-duplicate", [&] { books->add(SchoolClass{"c1", "Again"}, kAdmin); });
    is("books-invalid", [&] { books->add(SchoolClass{"c2", "Long", "", -1}, kAdmin); });
    is("books-unknown", [&] {
        books->enrol(std::vector<Enrolment>{{"c1", "s1", "student"}, {"c9", "s1", "student"}}, kAdmin);
    });
    is("books-unknown", [&] {
        books->enrol(std::vector<Enrolment>{{"c1", "s1", "teacher"}, {"c1", "s9", "student"}}, kAdmin);
    });
    is("books-unknown", [&] { static_cast<void>(books->classPage("c9")); });
    is("books-changed", [&] { books->add(RubricVersion{shortHash(0xab), "46-class-one", "other", 1}, kAdmin); });
    is("books-unknown", [&] {
        books->add(Pack{shortHash(0xe1), sha256("nowhere"), "x", "x", shortHash(0xab)}, kAdmin);
    });
    is("books-unknown", [&] {
        books->add(Pack{shortHash(0xe1), sha256(kPackFile), "x", "x", shortHash(0xad)}, kAdmin);
    });
    Assignment a = books->assignment("a1").value();
    a.closes += 1;
    is("books-changed", [&] { books->add(a, kAdmin); });
    a.id = "a2";
    a.closes = a.opens - 1;
    is("books-invalid", [&] { books->add(a, kAdmin); });
    is("books-unknown", [&] { books->rescore("again", "a9", shortHash(0xab), kAdmin); });
    is("books-unknown", [&] { books->rescore("again", "a1", shortHash(0xad), kAdmin); });
    is("books-invalid", [&] { books->rescore("arrival", "a1", shortHash(0xab), kAdmin); });
    is("books-invalid", [&] { books->note(Act{"", kNow}, "look", "s1"); });
    is("books-unknown", [&] { books->share(id(77), true, kAdmin); });
    EXPECT_EQ(dump(), before);
    // The same again is no error.
    books->add(RubricVersion{shortHash(0xab), "46-class-one", "[rubric]\n", 1}, kAdmin);
    books->add(books->assignment("a1").value(), kAdmin);
    books->add(books->pack(shortHash(0xe0)).value(), kAdmin);
    EXPECT_EQ(dump(), before);
}

TEST_P(BooksTest, WhatIsWrittenOnceIsChangedByNobody) {
    auto books = filled();
    books->push(attempt(1));
    books->push(Mark{id(9), id(1), "t1", "teacher", "pass", 8.5, 10.0, "{}", kNow}, kAdmin);
    books->finish(books->takeJob("w", kNow, 1000).value(), scoreOf({1, 1, "arrival", id(1), ""}, "w"));
    const std::string before = dump();
    for (const char* change :
         {"UPDATE attempts SET score = 10", "UPDATE marks SET points = 10", "DELETE FROM audit",
          "UPDATE scores SET score = 10", "UPDATE audit SET who = 'x'", "UPDATE rubrics SET text = ''"})
        EXPECT_THROW(sql(change), std::runtime_error) << change;
    EXPECT_EQ(dump(), before);
}

// What a station has to tell, told once in order or repeated and shuffled: the same books.
TEST_P(BooksTest, RepetitionAndAnotherOrderMakeTheSameBooks) {
    std::mt19937_64 random(test::seed());
    std::vector<std::function<bool(Books&)>> all;
    for (std::uint64_t n = 1; n <= 25; ++n) {
        std::vector<std::string> files;
        for (std::size_t k = below(random, 3); k > 0; --k)
            files.push_back(randomBytes(random, 50 + below(random, 500)));
        const PushedAttempt p = attempt(n, files);
        all.push_back([p](Books& books) { return books.push(p), true; });
        for (const std::string& file : files)
            all.push_back([file, step = 1 + below(random, 300)](Books& books) {
                // One piece each time, from where the server is.
                const Upload up = uploadOf(file);
                const std::uint64_t there = books.received(up, kNow);
                const std::string piece = file.substr(there, step);
                return books.append(up, there, bytesOf(piece), kNow);
            });
        all.push_back([n](Books& books) { return books.push(Judgement{id(n), 50.0, "so", 9}), true; });
        all.push_back([n](Books& books) {
            return books.push(Comment{id(1000 + n), id(n), "s1", "word", core::Vec3(1, 2, 3), 4.0, 9}), true;
        });
    }
    // As text without what the order may decide: numbers of jobs, and when they were made does not differ.
    const auto content = [this] {
        std::vector<BookTable> tables = open()->everything();
        for (BookTable& table : tables) {
            if (table.name == "jobs")
                for (std::vector<std::string>& row : table.rows)
                    row[0] = "";
            std::sort(table.rows.begin(), table.rows.end());
        }
        return asText(tables);
    };
    {
        auto books = filled();
        for (const auto& one : all)
            while (!one(*books)) {
            }
    }
    const std::string inOrder = content();
    EXPECT_EQ(open()->progress("arrival").waiting, 25);
    for (int round = 0; round < 3; ++round) {
        data_ = folder_.path() / fmt::format("again{}", round);
        if (isPostgres()) address_ = server()->address(schema_ = server()->newSchema());
        auto books = filled();
        std::vector<std::size_t> left;
        for (std::size_t i = 0; i < all.size(); ++i)
            left.insert(left.end(), 1 + below(random, 3), i);
        int refused = 0;
        for (std::shuffle(left.begin(), left.end(), random); !left.empty();) {
            std::vector<std::size_t> again;
            for (const std::size_t i : left) {
                if (below(random, 20) == 0) books = open();
                bool done = false;
                // What is said of an attempt that did not come yet is refused, and comes again.
                const std::string error = test::errorIdOf([&] { done = all[i](*books); });
                ASSERT_THAT(error, testing::AnyOf("", "books-unknown"));
                refused += error.empty() ? 0 : 1;
                if (!done) again.push_back(i);
            }
            std::shuffle(again.begin(), again.end(), random);
            left = again;
        }
        EXPECT_GT(refused, 0) << "the order was another";
        EXPECT_EQ(content(), inOrder) << "round " << round;
    }
}

TEST_P(BooksTest, AnUploadGoesOnFromEveryPlaceAndLiesThereWholeOrNotAtAll) {
    auto books = filled();
    std::mt19937_64 random(test::seed());
    const std::string bytes = randomBytes(random, 31);
    const fs::path whole = books->files().path(sha256(bytes));
    for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
        const Upload up = uploadOf(bytes, id(0x100 + cut));
        EXPECT_EQ(books->received(up, kNow), 0u);
        if (cut < bytes.size()) {
            ASSERT_FALSE(books->append(up, 0, bytesOf(bytes.substr(0, cut)), kNow));
            ASSERT_FALSE(fs::exists(whole));
            books = open();
            ASSERT_EQ(books->received(up, kNow), cut);
            // From anywhere else it is refused, and the place told.
            for (const std::uint64_t wrong : {cut + 1, cut + 1000, cut - 1})
                EXPECT_EQ(
                    test::errorFrom([&] { books->append(up, wrong, bytesOf(bytes.substr(cut)), kNow); })->arguments(),
                    std::vector{std::to_string(cut)});
            EXPECT_EQ(test::errorIdOf([&] { books->append(up, cut, bytesOf(bytes), kNow); }),
                      cut == 0 ? "" : "upload-offset")
                << "more than was promised";
            if (cut > 0) {
                ASSERT_TRUE(books->append(up, cut, bytesOf(bytes.substr(cut)), kNow));
            }
        } else {
            // All pieces had come, and then the server was killed: an empty piece ends it.
            core::writeFile(data_ / "uploads" / (up.station + "-" + up.hash), bytes);
            EXPECT_EQ(books->received(up, kNow), bytes.size());
            ASSERT_TRUE(books->append(up, bytes.size(), {}, kNow));
        }
        ASSERT_EQ(books->received(up, kNow), bytes.size());
        ASSERT_EQ(sha256Of(whole), sha256(bytes));
        ASSERT_TRUE(books->append(up, bytes.size(), {}, kNow)) << "again";
        fs::remove(whole);
        sql("DELETE FROM files WHERE hash = '" + sha256(bytes) + "'");
    }
    EXPECT_TRUE(fs::is_empty(data_ / "uploads"));
}

TEST_P(BooksTest, WhatIsNotAsPromisedIsThrownAwayAndNamesCannotLeaveTheFolder) {
    auto books = filled();
    const std::string bytes = "what was promised", others = "something else!!!";
    const Upload up = uploadOf(bytes);
    EXPECT_EQ(test::errorIdOf([&] { books->append(up, 0, bytesOf(others), kNow); }), "upload-mismatch");
    EXPECT_FALSE(books->files().has(up.hash));
    EXPECT_TRUE(fs::is_empty(data_ / "uploads"));
    EXPECT_EQ(books->received(up, kNow), 0u) << "from the beginning";
    EXPECT_TRUE(books->append(up, 0, bytesOf(bytes), kNow));
    EXPECT_EQ(test::errorIdOf([&] {
                  static_cast<void>(books->received({kStation, up.hash, 5}, kNow));
              }),
              "books-invalid");
    EXPECT_EQ(test::errorIdOf([&] {
                  static_cast<void>(books->received({kStation, sha256("x"), 0}, kNow));
              }),
              "books-invalid");
    const std::string hash = sha256("y");
    for (const std::string& bad : {std::string("../../../../etc/passwd"), std::string(64, '.'), std::string(64, '/'),
                                   hash.substr(1), hash + "0", std::string(63, 'a') + "/",
                                   std::string(63, 'a') + std::string(1, '\0'), std::string(64, 'A'), std::string()}) {
        EXPECT_EQ(test::errorIdOf([&] {
                      books->append({kStation, bad, 3}, 0, bytesOf("abc"), kNow);
                  }),
                  "books-invalid");
        EXPECT_EQ(test::errorIdOf([&] { books->append({bad, hash, 3}, 0, bytesOf("abc"), kNow); }), "books-invalid");
        EXPECT_EQ(test::errorIdOf([&] { static_cast<void>(books->files().path(bad)); }), "books-invalid");
    }
    // A link that lies where a piece is to go is not followed.
    const std::string third = "third";
    const fs::path victim = folder_.path() / "victim";
    core::writeFile(victim, std::string("mine"));
    fs::create_symlink(victim, data_ / "uploads" / (id(3) + "-" + sha256(third)));
    static_cast<void>(test::errorOf([&] { books->append(uploadOf(third, id(3)), 0, bytesOf(third), kNow); }));
    EXPECT_EQ(sha256Of(victim), sha256("mine"));
}

TEST_P(BooksTest, ManyUploadsAtOnceAlsoOfOneFileByTwoStations) {
    { auto books = filled(); }
    std::mt19937_64 random(test::seed());
    std::vector<std::string> files;
    for (int i = 0; i < 12; ++i)
        files.push_back(randomBytes(random, 20000 + below(random, 20000)));
    std::atomic<int> whole = 0;
    std::vector<std::thread> stations;
    for (std::uint64_t s = 0; s < 4; ++s)
        stations.emplace_back([&, s] {
            auto books = open();
            std::mt19937_64 own(s);
            std::vector<std::string> mine = files;
            std::shuffle(mine.begin(), mine.end(), own);
            for (const std::string& file : mine) {
                const Upload up = uploadOf(file, id(0x100 + s));
                for (bool done = false; !done;) {
                    const std::uint64_t there = books->received(up, kNow);
                    const std::string piece = file.substr(there, 1 + below(own, 9000));
                    done = books->append(up, there, bytesOf(piece), kNow);
                }
                ++whole;
            }
        });
    for (std::thread& station : stations)
        station.join();
    EXPECT_EQ(whole, 48);
    auto books = open();
    for (const std::string& file : files)
        EXPECT_EQ(sha256Of(books->files().path(sha256(file))), sha256(file));
    EXPECT_EQ(sql("SELECT count(*) FROM files"), "13") << "with the pack";
    // What another station had begun when the file came whole is swept once it is a day old.
    books->sweep(kNow + 146'000 * kDay);
    EXPECT_TRUE(fs::is_empty(data_ / "uploads"));
    EXPECT_THAT(books->files().all(), SizeIs(13)) << "and nothing that the books know";
}

TEST_P(BooksTest, ACodeEnrolsOneStationAlsoWhenTwoComeAtOnceAndBeforeItIsTooOld) {
    auto books = filled();
    EXPECT_FALSE(books->enrolStation("one-time-code", id(2), std::string(40, 'x'), kNow)) << "used";
    EXPECT_FALSE(books->enrolStation("never offered", id(2), std::string(40, 'x'), kNow));
    books->offerCode("short lived", "Room 3", kNow + 1000, kAdmin);
    EXPECT_FALSE(books->enrolStation("short lived", id(2), std::string(40, 'x'), kNow + 1000)) << "too old";
    EXPECT_EQ(test::errorIdOf([&] { books->offerCode("short lived", "Room 4", kNow, kAdmin); }), "books-duplicate");
    books->offerCode("for one of two", "Room 4", kNow + 1000, kAdmin);
    std::atomic<int> enrolled = 0;
    std::vector<std::thread> threads;
    for (std::uint64_t t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            if (open()->enrolStation("for one of two", id(0x200 + t), std::string(40, static_cast<char>('a' + t)),
                                     kNow))
                ++enrolled;
        });
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(enrolled, 1);
    EXPECT_TRUE(books->stationByKey(std::string(40, 'k')));
    books->revoke(kStation, kAdmin);
    EXPECT_FALSE(books->stationByKey(std::string(40, 'k')));
    // Neither codes nor keys are there to be read.
    const std::string everything =
        dump() + sql("SELECT min(hash) FROM station_codes") + sql("SELECT min(key_hash) FROM stations");
    EXPECT_THAT(everything, Not(HasSubstr("for one of two")));
    EXPECT_THAT(everything, Not(HasSubstr(std::string(40, 'k'))));
}

TEST_P(BooksTest, ALogInLastsUntilItIsEndedOrTooOldOrItsPersonChanges) {
    auto books = filled();
    const std::string token(64, 'a'), other(64, 'b');
    const Act self{"t1", kNow};
    const auto logIn = [&] {
        books->addLogin(token, "t1", kNow + 1000, self);
        books->addLogin(other, "t1", kNow + 2000, self);
        EXPECT_EQ(books->personByToken(token, kNow)->code, "t1");
        EXPECT_THAT(books->personByToken(other, kNow)->roles, ElementsAre("examiner", "teacher"));
    };
    logIn();
    EXPECT_FALSE(books->personByToken(std::string(64, 'c'), kNow));
    EXPECT_FALSE(books->personByToken("", kNow));
    EXPECT_TRUE(books->personByToken(token, kNow + 999));
    EXPECT_FALSE(books->personByToken(token, kNow + 1000));
    books->endLogin(token);
    books->endLogin(token);
    EXPECT_FALSE(books->personByToken(token, kNow));
    EXPECT_TRUE(books->personByToken(other, kNow));
    EXPECT_EQ(test::errorIdOf([&] { books->addLogin(other, "s1", kNow + 1000, self); }), "books-duplicate");
    EXPECT_EQ(test::errorIdOf([&] { books->addLogin(token, "s9", kNow + 1000, self); }), "books-unknown");
    EXPECT_EQ(test::errorIdOf([&] { books->addLogin("short", "s1", kNow + 1000, self); }), "books-invalid");
    const std::vector<std::function<void()>> changes = {
        [&] { books->setPassword("t1", "$argon2id$9", kAdmin); },
        [&] {
            books->setRoles("t1", {"examiner", "teacher"}, kAdmin);
        },
        [&] { books->erase("t1", kAdmin); },
    };
    for (const auto& change : changes) {
        books->endLogin(other);
        logIn();
        change();
        EXPECT_FALSE(books->personByToken(token, kNow));
        EXPECT_FALSE(books->personByToken(other, kNow));
    }
    EXPECT_EQ(test::errorIdOf([&] { books->addLogin(token, "t1", kNow + 1000, self); }), "books-unknown") << "erased";
    EXPECT_THAT(dump() + sql("SELECT max(token_hash) FROM logins"), Not(HasSubstr(token)));
}

TEST_P(BooksTest, ASessionIsOnePersonsWhateverItsBytes) {
    auto books = filled();
    books->offerCode("another code", "Room 3", kNow + kDay, kAdmin);
    ASSERT_TRUE(books->enrolStation("another code", id(2), std::string(40, 'x'), kNow));
    const auto deliver = [&](const std::string& station, const std::string& bytes, Milliseconds at) {
        const Upload upload{station, sha256(bytes), bytes.size()};
        EXPECT_TRUE(books->append(upload, 0, std::as_bytes(std::span(bytes)), at));
        books->keepContent(sha256(bytes), "these inputs");
    };
    // Somebody who only knows the hash names it first: that accuses nobody.
    PushedAttempt claimed = attempt(2, {"the work"});
    claimed.station = id(2), claimed.person = "s2", claimed.received = kNow;
    books->push(claimed);
    PushedAttempt own = attempt(1, {"the work"});
    own.received = kNow + 10;
    books->push(own);
    deliver(kStation, "the work", kNow + 11);
    EXPECT_FALSE(books->otherPersonWith(id(1)));
    EXPECT_EQ(books->otherPersonWith(id(2)), "s1");
    // A copy with a byte appended.
    PushedAttempt copied = attempt(3, {"the work, and a byte"});
    copied.station = id(2), copied.person = "s3", copied.received = kNow + 20;
    books->push(copied);
    deliver(id(2), "the work, and a byte", kNow + 21);
    EXPECT_EQ(books->otherPersonWith(id(3)), "s1");
    EXPECT_FALSE(books->otherPersonWith(id(1)));
}

TEST_P(BooksTest, AStationOfAPersonIsTheirsForATerm) {
    auto books = filled();
    EXPECT_EQ(
        test::errorIdOf([&] { books->offerCode("a code of nobody", "x", kNow + kDay, kAdmin, "practice", "s99"); }),
        "books-unknown");
    books->offerCode("a code of s1", "s1's own", kNow + kDay, kAdmin, "practice", "s1");
    const std::string key(40, 'q');
    const auto own = books->enrolStation("a code of s1", id(0x77), key, kNow);
    ASSERT_TRUE(own);
    EXPECT_EQ(own->person, "s1");
    EXPECT_EQ(own->ends, kNow + Books::kTerm);
    EXPECT_TRUE(books->stationByKey(key, own->ends - 1));
    EXPECT_FALSE(books->stationByKey(key, own->ends));
    EXPECT_EQ(books->station(id(0x77))->person, "s1");
    EXPECT_THAT(books->stationsOf("s1"), SizeIs(1));
    EXPECT_THAT(books->stationsOf("s2"), SizeIs(0));
    EXPECT_EQ(books->station(kStation)->ends, 0) << "those of before go on";
    EXPECT_FALSE(books->station(id(0x78)));
    // Who may not come in sends nothing, and no code of theirs makes a station.
    books->offerCode("a second code of s1", "another", kNow + kDay, kAdmin, "practice", "s1");
    EXPECT_TRUE(books->offered("a second code of s1", kNow));
    books->erase("s1", kAdmin);
    EXPECT_FALSE(books->stationByKey(key, kNow));
    EXPECT_FALSE(books->offered("a second code of s1", kNow));
    EXPECT_FALSE(books->enrolStation("a second code of s1", id(0x79), std::string(40, 'r'), kNow));
}

TEST_P(BooksTest, OnePersonFillsNoBooksWithCodesAndNames) {
    auto books = filled();
    const auto offer = [&](int i, Milliseconds at) {
        books->offerCode("code " + id(i), "own", at + kDay, {"s1", at}, "practice", "s1");
    };
    for (int i = 0; i < 10; ++i)
        offer(i, kNow);
    EXPECT_EQ(test::errorIdOf([&] { offer(10, kNow); }), "books-invalid");
    ASSERT_TRUE(books->enrolStation("code " + id(0), id(0x77), std::string(40, 'q'), kNow));
    offer(10, kNow);
    offer(11, kNow + 2 * kDay);
    EXPECT_FALSE(books->offered("code " + id(1), kNow)) << "those that ran out are gone";
    EXPECT_EQ(test::errorIdOf([&] { books->offerCode("a long one", std::string(5000, 'x'), kNow + kDay, kAdmin); }),
              "books-invalid");
    EXPECT_EQ(test::errorIdOf([&] { books->rename("s1", std::string(5000, 'x'), "s1", kAdmin); }), "books-invalid");
}

TEST_P(BooksTest, WhatAWorkerHasInHandIsItsOwn) {
    auto books = filled();
    const std::string bytes = "a recording";
    books->push(attempt(1, {bytes}));
    EXPECT_TRUE(books->append({kStation, sha256(bytes), bytes.size()}, 0, std::as_bytes(std::span(bytes)), kNow));
    const auto job = books->takeJob("worker a", kNow, 1000);
    ASSERT_TRUE(job);
    const auto lent = books->lent("worker a", job->number, job->turn);
    ASSERT_TRUE(lent);
    EXPECT_EQ(lent->attempt, job->attempt);
    EXPECT_EQ(lent->rubric, job->rubric);
    EXPECT_EQ(lent->leaseUntil, kNow + 1000);
    EXPECT_FALSE(books->lent("worker b", job->number, job->turn));
    EXPECT_FALSE(books->lent("worker a", job->number, job->turn + 1));
    EXPECT_FALSE(books->lent("worker a", job->number + 1, job->turn));
    // Its time is over, and another has it.
    EXPECT_TRUE(books->lent("worker a", job->number, job->turn)) << "until another takes it";
    ASSERT_TRUE(books->takeJob("worker b", kNow + 1001, 1000));
    EXPECT_FALSE(books->lent("worker a", job->number, job->turn));
    EXPECT_TRUE(books->lent("worker b", job->number, job->turn + 1));
}

TEST_P(BooksTest, NamingAFilesHashDeliversNothing) {
    auto books = filled();
    books->offerCode("another code", "Room 3", kNow + kDay, kAdmin);
    ASSERT_TRUE(books->enrolStation("another code", id(2), std::string(40, 'x'), kNow));
    const std::string bytes = "another person's recording";
    const Upload own{kStation, sha256(bytes), bytes.size()}, thiefs{id(2), sha256(bytes), bytes.size()};
    books->push(attempt(1, {bytes}));
    EXPECT_TRUE(books->append(own, 0, std::as_bytes(std::span(bytes)), kNow));
    PushedAttempt named = attempt(2, {bytes});
    named.station = id(2), named.person = "s2";
    books->push(named);
    EXPECT_TRUE(books->isWhole(id(1)));
    EXPECT_FALSE(books->isWhole(id(2)));
    EXPECT_THAT(books->missingFiles(id(2)), SizeIs(1)) << "it is asked for the bytes";
    EXPECT_EQ(books->received(thiefs, kNow), 0u);
    EXPECT_FALSE(books->hasDelivered(thiefs));
    EXPECT_THAT(BooksAccounts(*books).filesOf("s2"), SizeIs(0));
    EXPECT_THAT(BooksAccounts(*books).filesOf("s1"), SizeIs(1));
    EXPECT_EQ(books->progress("arrival").waiting, 1);
    // A byte less is not it.
    EXPECT_EQ(test::errorIdOf([&] {
                  std::string wrong = bytes;
                  wrong.back() = '!';
                  (void)books->append(thiefs, 0, std::as_bytes(std::span(wrong)), kNow);
              }),
              "upload-mismatch");
    // Who has all of it has it.
    EXPECT_TRUE(books->append(thiefs, 0, std::as_bytes(std::span(bytes)), kNow));
    EXPECT_TRUE(books->isWhole(id(2)));
    EXPECT_EQ(books->received(thiefs, kNow), bytes.size());
    EXPECT_EQ(books->progress("arrival").waiting, 2);
}

TEST_P(BooksTest, WorkThatNoReaderCanStartForWaitsAndLosesNoTurn) {
    auto books = filled();
    books->push(attempt(1, {"one"}));
    const std::string bytes = "one";
    EXPECT_TRUE(books->append({kStation, sha256(bytes), bytes.size()}, 0, std::as_bytes(std::span(bytes)), kNow));
    for (int i = 0; i < 20; ++i) {
        const Milliseconds at = kNow + i * 100;
        const auto job = books->takeJob("w", at, 1000);
        ASSERT_TRUE(job) << i;
        EXPECT_TRUE(books->giveBack(*job, at + 50, false));
        EXPECT_FALSE(books->takeJob("w", at + 10, 1000)) << "not at once again";
    }
    EXPECT_EQ(books->progress("arrival").failed, 0);
}

TEST_P(BooksTest, WorkThatIsNearlyAnothersIsTold) {
    auto books = filled();
    std::vector<std::string> sketch;
    for (int i = 0; i < 64; ++i)
        sketch.push_back(fmt::format("{:016x}", 1000 + i));
    const auto work = [&](int number, const char* person, const std::string& bytes, std::vector<std::string> hashes) {
        PushedAttempt pushed = attempt(number, {bytes});
        pushed.person = person;
        books->push(pushed);
        books->keepSketch(sha256(bytes), hashes);
    };
    work(1, "s1", "one", sketch);
    EXPECT_THAT(books->alike(id(1)), SizeIs(0));
    std::vector<std::string> changed = sketch, other;
    changed[5] = std::string(16, 'f');
    for (int i = 0; i < 64; ++i)
        other.push_back(fmt::format("{:016x}", 5000 + i));
    other[0] = sketch[0];
    work(2, "s2", "two", changed);
    work(3, "s3", "three", other);
    work(4, "s1", "four", sketch);
    const auto of1 = books->alike(id(1));
    ASSERT_THAT(of1, SizeIs(1)) << "one's own next work is none, and a chance stretch neither";
    EXPECT_EQ(of1[0].attempt, id(2));
    EXPECT_EQ(of1[0].person, "s2");
    EXPECT_EQ(of1[0].percent, 98);
    EXPECT_THAT(books->alike(id(2)), SizeIs(2)) << "it does not say who was first";
    EXPECT_THAT(books->alike(id(3)), SizeIs(0));
    // A short one that is all of a long one's.
    work(5, "s3", "five", {sketch.begin(), sketch.begin() + 8});
    EXPECT_EQ(books->alike(id(5)).at(0).percent, 100);
}

TEST_P(BooksTest, APersonsDataIsExportedAndTheNameErasedAndTheCodesStay) {
    auto books = filled();
    books->push(attempt(1, {"one"}));
    PushedAttempt others = attempt(2);
    others.person = "s2";
    books->push(others);
    books->push(Comment{id(7), id(1), "t1", "of the first", {}, {}, 5});
    books->push(Comment{id(8), id(2), "t1", "of the other", {}, {}, 5});
    books->push(Mark{id(9), id(1), "t1", "teacher", "pass", 8.5, 10.0, "{}", kNow}, Act{"t1", kNow});
    books->note(Act{"t1", kNow}, "look", "s1", id(1));
    const std::string mine = asText(books->about("s1", Act{"s1", kNow}));
    for (const char* part : {"Mori Aiko", "of the first", "look", "export", "c1"})
        EXPECT_THAT(mine, HasSubstr(part));
    EXPECT_THAT(mine, HasSubstr(sha256("one"))) << "which files are theirs";
    for (const char* part : {"O'Hara", "of the other", "Sato", "argon2id"})
        EXPECT_THAT(mine, Not(HasSubstr(part)));
    EXPECT_THAT(mine, Not(HasSubstr(id(2))));

    books->erase("s1", kAdmin);
    books->erase("s1", kAdmin);
    EXPECT_FALSE(books->personByLogin("mori"));
    EXPECT_EQ(books->person("s1")->name, "");
    EXPECT_EQ(books->person("s1")->erased, kNow);
    EXPECT_THAT(dump(), Not(HasSubstr("Mori")));
    EXPECT_EQ(books->attempt(id(1))->person, "s1");
    EXPECT_THAT(books->classPage("c1").students, SizeIs(3));
    EXPECT_EQ(test::errorIdOf([&] { books->rename("s1", "Mori Aiko", "mori", kAdmin); }), "books-unknown")
        << "cannot be taken back";
    EXPECT_EQ(test::errorIdOf([&] { books->setPassword("s1", "x", kAdmin); }), "books-unknown");
    EXPECT_FALSE(books->push(attempt(1, {"one"}))) << "what its station had still to say is taken";
    EXPECT_TRUE(books->push(attempt(3)));
    int erased = 0;
    for (const AuditLine& line : books->audit(0, 1000, "s1"))
        erased += line.what == "erase" ? 1 : 0;
    EXPECT_EQ(erased, 1);
    // The lines of the audit have no gaps, and go on in pieces.
    std::int64_t last = 0;
    for (std::vector<AuditLine> piece; !(piece = books->audit(last, 3)).empty();)
        for (const AuditLine& line : piece)
            EXPECT_EQ(line.number, ++last);
    EXPECT_GT(last, 15);
    // Nor in the files of the database, also while it is open.
    if (!isPostgres()) {
        for (const auto& entry : fs::directory_iterator(data_))
            if (entry.is_regular_file()) {
                const std::vector<std::byte> bytes = core::readFile(entry.path());
                EXPECT_EQ(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()).find("Mori Aiko"),
                          std::string_view::npos)
                    << entry.path();
            }
    }
}

TEST_P(BooksTest, WhatAClosedClassNeedNotKeepGoesWithItsFiles) {
    auto books = filled();
    books->push(attempt(1, {"its own", "of two"}));
    PushedAttempt practice = attempt(2, {"of two"});
    practice.assignment = "";
    books->push(practice);
    for (const char* file : {"its own", "of two"})
        upload(*books, file);
    books->push(Mark{id(9), id(1), "t1", "teacher", "pass", 8.5, 10.0, "{}", kNow}, kAdmin);
    books->push(Comment{id(7), id(1), "t1", "word", {}, {}, 5});
    books->push(Judgement{id(1), 1.0, "", 0});
    books->share(id(1), true, Act{"s1", kNow});
    EXPECT_TRUE(books->isShared(id(1)));
    const Job job = books->takeJob("w", kNow, 1000).value();
    books->finish(job, scoreOf(job, "w"));
    EXPECT_EQ(Retention(*books).expire(Act{"server", kNow + 1000 * kDay}), 0) << "the class is open";
    books->close("c1", kAdmin);
    EXPECT_EQ(Retention(*books).expire(Act{"server", kNow + 365 * kDay - 1}), 0);
    EXPECT_EQ(Retention(*books).expire(Act{"server", kNow + 365 * kDay}), 1);
    EXPECT_FALSE(books->attempt(id(1)));
    EXPECT_TRUE(books->attempt(id(2))) << "practice is no class's";
    EXPECT_FALSE(books->files().has(sha256("its own")));
    EXPECT_TRUE(books->files().has(sha256("of two")));
    EXPECT_TRUE(books->files().has(sha256(kPackFile)));
    for (const char* table : {"scores", "marks", "comments", "judgements", "shares"})
        EXPECT_EQ(sql(fmt::format("SELECT count(*) FROM {}", table)), "0") << table;
    EXPECT_EQ(Retention(*books).expire(Act{"server", kNow + 366 * kDay}), 0);
    EXPECT_EQ(books->audit(0, 1000, id(1)).back().what, "expire");
    // A file that a killed server left is swept after a day.
    core::writeFile(books->files().path(sha256("left")), std::string("left"));
    books->sweep(books->files().madeAt(sha256("left")) + kDay);
    EXPECT_TRUE(books->files().has(sha256("left")));
    books->sweep(books->files().madeAt(sha256("left")) + kDay + 1);
    EXPECT_FALSE(books->files().has(sha256("left")));
    EXPECT_TRUE(books->files().has(sha256("of two")));
}

TEST_P(BooksTest, AFileThatCameAndWasNotWrittenDownIsFoundAgain) {
    auto books = filled();
    books->push(attempt(1, {"came"}));
    // As a server leaves it that is killed after the file and before the books.
    core::writeFile(books->files().path(sha256("came")), std::string("came"));
    EXPECT_FALSE(books->takeJob("w", kNow, 1000));
    EXPECT_EQ(books->received(uploadOf("came"), kNow), 0u) << "whose it is nobody knows: its station sends it again";
    EXPECT_FALSE(books->takeJob("w", kNow, 1000));
    const std::string bytes = "came";
    EXPECT_TRUE(books->append(uploadOf("came"), 0, std::as_bytes(std::span(bytes)), kNow));
    EXPECT_TRUE(books->takeJob("w", kNow, 1000));
}

// One script of chance on both, errors and all: the same text of everything.
TEST(BooksOfBothDatabases, AreTheSameByteForByte) {
    if (!server()) GTEST_SKIP() << kNoServer;
    core::PrivateFolder folder;
    const auto play = [&](const fs::path& data, const std::string& address) {
        std::mt19937_64 random(test::seed());
        std::string told;
        Books books(data, address, 20s);
        fill(books);
        const std::vector<std::string> texts = {
            "",  "Zoe",          "zoe",          "\xc3\xa4",         "z", "A",  "a", "_", "10",
            "9", "\xe6\x84\x9b", "O'Hara\t\\\n", "\xf0\x9f\xa6\xb7", "%", " x "};
        const auto text = [&] { return texts[below(random, texts.size())]; };
        const std::vector<double> numbers = {0.0,    -0.0,   1.0,       0.1,           1e-300,
                                             -1e300, 5e-324, 1.0 / 3.0, 123456789.123, 2.0};
        const auto number = [&] { return numbers[below(random, numbers.size())]; };
        const auto code = [&] { return fmt::format("{}{}", "sSzZ"[below(random, 4)], below(random, 12)); };
        std::vector<Job> jobs;
        for (int step = 0; step < 1500; ++step) {
            const Act act{code(), kNow + step};
            const std::optional<core::Error> error = test::errorFrom([&] {
                switch (below(random, 16)) {
                    case 0:
                        books.add(std::vector<Person>{{code(), text(), text(), text(), text(), {"student"}},
                                                      {code(), text()}},
                                  act);
                        break;
                    case 1:
                        books.rename(code(), text(), text(), act);
                        break;
                    case 2:
                        books.erase(fmt::format("{}{}", "sSzZ"[below(random, 4)], 8 + below(random, 4)), act);
                        break;
                    case 3:
                        books.enrol(std::vector<Enrolment>{{"c1", code(), "student"}}, act);
                        break;
                    case 4:
                        books.leave("c1", code(), act);
                        break;
                    case 5:
                    case 6:
                    case 7: {
                        PushedAttempt p = attempt(below(random, 60), {text() + "file"});
                        p.person = code();
                        p.assignment = below(random, 3) == 0 ? "" : "a1";
                        p.attempt.score = number();
                        p.attempt.device = text();
                        p.attempt.result = text();
                        told += books.push(p) ? "new " : "old ";
                        break;
                    }
                    case 8: {
                        const std::string bytes = text() + "file";
                        told += std::to_string(books.received(uploadOf(bytes), act.at));
                        books.append(uploadOf(bytes), below(random, 2), bytesOf(bytes), act.at);
                        break;
                    }
                    case 9:
                        books.push(Comment{
                            id(below(random, 80)), id(below(random, 60)), code(), text(),
                            below(random, 2) ? std::optional(core::Vec3(number(), number(), number())) : std::nullopt,
                            below(random, 2) ? std::optional(number()) : std::nullopt, step});
                        break;
                    case 10:
                        books.push(Judgement{id(below(random, 60)), number(), text(), 1});
                        break;
                    case 11:
                        books.push(Mark{id(below(random, 80)), id(below(random, 60)), code(), "blind", text(), number(),
                                        number(), text(), step},
                                   act);
                        break;
                    case 12:
                        if (auto job = books.takeJob(code(), act.at, 3)) jobs.push_back(*job);
                        break;
                    case 13:
                        if (!jobs.empty()) {
                            Score s = scoreOf(jobs[below(random, jobs.size())], code());
                            s.score = number();
                            s.reason = text();
                            told += books.finish(jobs[below(random, jobs.size())], s) ? "done " : "lost ";
                        }
                        break;
                    case 14:
                        told += std::to_string(
                            books.rescore(fmt::format("r{}", below(random, 9)), "a1", shortHash(0xac), act));
                        break;
                    case 15:
                        books.share(id(below(random, 60)), below(random, 2) == 0, act);
                        if (!jobs.empty()) told += books.giveBack(jobs.back()) ? "back " : "gone ";
                        break;
                }
            });
            if (error) {
                told += error->id() + error->problem() + "\n";
                EXPECT_THAT(error->id(), testing::AnyOf(HasSubstr("books-"), HasSubstr("upload-"))) << error->what();
            }
        }
        const ClassPage page = books.classPage("c1");
        for (const ClassCell& c : page.cells)
            told += fmt::format("{} {} {} {} {} {} {} {} {} {}\n", c.person, c.assignment, c.attempts, c.last,
                                c.finished, c.state, c.score, c.maxScore, c.reason, c.marks);
        for (const Person& p : page.students)
            told += p.code + p.name + "\n";
        for (const Person& p : books.people())
            told += p.code + p.name + p.login + fmt::format("{}\n", fmt::join(p.roles, ","));
        for (const PushedAttempt& p : books.attemptsOf("s1"))
            told += p.attempt.id;
        const Progress progress = books.progress("r1");
        told += fmt::format("{} {} {} {}\n", progress.waiting, progress.taken, progress.done, progress.failed);
        told += asText(books.about("s1", kAdmin));
        books.close("c1", kAdmin);
        const std::string all = asText(books.everything());
        told += std::to_string(Retention(books).expire(Act{"server", kNow + 400 * kDay}));
        return told + all + asText(books.everything());
    };
    const std::string sqlite = play(folder.path() / "sqlite", "");
    const std::string postgres = play(folder.path() / "postgres", server()->address(server()->newSchema()));
    EXPECT_GT(sqlite.size(), 50'000u);
    for (const char* part :
         {"books-changed", "books-unknown", "books-duplicate", "upload-offset", "done ", "lost ", "\tproven\t"})
        EXPECT_THAT(sqlite, HasSubstr(part)) << "the script does too little";
    ASSERT_EQ(sqlite.size(), postgres.size());
    const auto differs = std::mismatch(sqlite.begin(), sqlite.end(), postgres.begin());
    const auto at = static_cast<std::size_t>(differs.first - sqlite.begin());
    EXPECT_TRUE(sqlite == postgres) << "from " << at << ":\n"
                                    << sqlite.substr(at > 100 ? at - 100 : 0, 300) << "\n---\n"
                                    << postgres.substr(at > 100 ? at - 100 : 0, 300);
}
}  // namespace
}  // namespace handpiece::school::books_test
