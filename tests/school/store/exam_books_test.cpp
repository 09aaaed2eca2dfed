// SPDX-License-Identifier: Apache-2.0
// Exams in the books: on both databases the same.
#include <gmock/gmock.h>

#include <algorithm>

#include "handpiece/school/store/exam_books.h"
#include "handpiece/school/store/retention.h"
#include "school/store/books_fixture.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::school::exam_books_test {
namespace {

using test::errorIdOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

std::string hash(std::uint64_t number) {
    return sha256(std::to_string(number));
}

void makeExam(Books& books) {
    books.add(Assignment{"ex1", "c1", shortHash(0xe0), shortHash(0xab), "Exam", "exam", "", kNow, kNow + kDay}, kAdmin);
    ExamBooks exams(books);
    exams.addKey(kStation, hash(1), kNow);
    exams.set(ExamSettings{"ex1", 30, "undo"}, kAdmin);
    exams.set(ExamCandidate{"ex1", "s1", hash(11), 25, 10, "scale-bar"}, kAdmin);
    exams.set(ExamCandidate{"ex1", "s2", hash(12), 0, 0, ""}, kAdmin);
    exams.set(ExamInvigilator{"ex1", "t1", "$argon2id$pin"}, kAdmin);
    // Nobody confirms themselves.
    EXPECT_EQ(test::errorIdOf([&] { exams.set(ExamInvigilator{"ex1", "s1", "-"}, kAdmin); }), "books-invalid");
    EXPECT_EQ(test::errorIdOf([&] {
                  exams.set(ExamCandidate{"ex1", "t1", hash(13), 0, 0, ""}, kAdmin);
              }),
              "books-invalid");
    exams.add(ExamPack{"ex1", 1, hash(21), "a pack", hash(2), "signature", 0}, kAdmin);
}
ExamEntry entry(std::int64_t number, const char* kind, const std::string& sitting = {}) {
    return {kStation,
            number,
            hash(1000 + static_cast<std::uint64_t>(number)),
            kind,
            sitting,
            "text",
            hash(1),
            "sig",
            kNow + number,
            kNow + number + 5};
}
ExamSitting begins(const std::string& sitting, const char* person = "s1") {
    return {sitting, "ex1", kStation, person, hash(11), hash(21), "t1", kNow, 0, "begun", 0};
}

TEST_P(BooksTest, OfExamsTellBackAllThatWasPutIn) {
    auto books = filled();
    makeExam(*books);
    ExamBooks exams(*books);
    const std::string sitting = id(77);
    EXPECT_TRUE(exams.add(entry(1, "started"), nullptr, nullptr));
    const ExamSitting one = begins(sitting);
    EXPECT_TRUE(exams.add(entry(2, "begun", sitting), &one, nullptr));
    EXPECT_FALSE(exams.add(entry(2, "begun", sitting), &one, nullptr)) << "the same again";
    EXPECT_TRUE(exams.add(entry(3, "checkpoint", sitting), nullptr, nullptr));
    EXPECT_TRUE(exams.add(entry(4, "started"), nullptr, nullptr));
    PushedAttempt work = attempt(77, {"a session"});
    work.assignment = "ex1";
    EXPECT_TRUE(exams.add(entry(5, "finished", sitting), nullptr, &work));
    EXPECT_FALSE(exams.add(entry(5, "finished", sitting), nullptr, &work));
    EXPECT_TRUE(exams.add(entry(6, "started"), nullptr, nullptr));
    EXPECT_EQ(exams.endOf(kStation).number, 6);
    EXPECT_THAT(exams.entriesOf(sitting), SizeIs(4)) << "from its beginning to its end, with what came between";
    EXPECT_EQ(exams.sitting(sitting)->state, "finished");
    EXPECT_TRUE(books->attempt(sitting));
    EXPECT_THAT(exams.examsOpenAt(kNow), ElementsAre("ex1"));
    EXPECT_THAT(exams.examsOpenAt(kNow + kDay), IsEmpty());
    EXPECT_EQ(exams.candidates("ex1").at(0).helps, "scale-bar");
    EXPECT_EQ(exams.invigilators("ex1").at(0).pin, "$argon2id$pin");
    EXPECT_EQ(exams.newestPack("ex1")->text, "a pack");
    EXPECT_EQ(exams.packByHash(hash(21))->version, 1);
    exams.setDoubts(sitting, {"one", "two"}, kNow);
    EXPECT_THAT(exams.doubtsOf(sitting), ElementsAre("one", "two"));
    // A new code, and whose the old one was.
    exams.set(ExamCandidate{"ex1", "s1", hash(13), 50, 0, ""}, kAdmin);
    EXPECT_EQ(exams.personOfCode("ex1", hash(11)), "s1");
    EXPECT_EQ(exams.personOfCode("ex1", hash(13)), "s1");
    EXPECT_FALSE(exams.personOfCode("ex1", hash(99)));
    // What is exported of a person has no codes' and no keys' secrets.
    const std::string about = asText(books->about("s1", kAdmin));
    EXPECT_THAT(about, HasSubstr(sitting));
    EXPECT_THAT(about, Not(HasSubstr("one\\ntwo"))) << "what was doubted, before a teacher has decided";
    EXPECT_THAT(asText(books->about("t1", kAdmin)), Not(HasSubstr("argon2id")));
}

TEST_P(BooksTest, NobodyTakesARunningExamsId) {
    auto books = filled();
    makeExam(*books);
    ExamBooks exams(*books);
    books->offerCode("another code", "Room 3", kNow + kDay, kAdmin);
    ASSERT_TRUE(books->enrolStation("another code", id(2), std::string(40, 'x'), kNow));
    const auto takes = [&](std::uint64_t number) {
        PushedAttempt work = attempt(number, {"mine"});
        work.station = id(2), work.person = "s2";
        return test::errorIdOf([&] { (void)books->push(work); });
    };
    // Before the server hears of the sitting: the id can be read at the station meanwhile.
    EXPECT_EQ(takes(77), "");
    const ExamSitting one = begins(id(77));
    exams.add(entry(1, "started"), nullptr, nullptr);
    EXPECT_TRUE(exams.add(entry(2, "begun", id(77)), &one, nullptr));
    EXPECT_FALSE(books->attempt(id(77))) << "that was nobody's exam";
    // And afterwards.
    EXPECT_EQ(takes(77), "books-invalid");
    PushedAttempt work = attempt(77, {"a session"});
    work.assignment = "ex1";
    EXPECT_TRUE(exams.add(entry(3, "finished", id(77)), nullptr, &work));
    EXPECT_EQ(books->attempt(id(77))->assignment, "ex1");
    EXPECT_EQ(takes(78), "") << "any other id";
}

TEST_P(BooksTest, OfExamsRefuseWhatCannotBeAndWriteNothingOfIt) {
    auto books = filled();
    makeExam(*books);
    ExamBooks exams(*books);
    const std::string sitting = id(77);
    const ExamSitting one = begins(sitting);
    ASSERT_TRUE(exams.add(entry(1, "begun", sitting), &one, nullptr));
    const std::string before = dump();
    const auto refused = [&](auto work) { return errorIdOf(work); };
    EXPECT_EQ(refused([&] { exams.addKey(kStation, hash(3), kNow); }), "books-changed");
    EXPECT_EQ(refused([&] { exams.addKey(id(9), hash(3), kNow); }), "books-unknown");
    EXPECT_EQ(refused([&] { exams.addKey(kStation, "x", kNow); }), "books-invalid");
    EXPECT_EQ(refused([&] { (void)exams.keyOf(id(9)); }), "books-unknown");
    EXPECT_EQ(refused([&] {
                  exams.set(ExamSettings{"a1", 30, ""}, kAdmin);
              }),
              "books-unknown")
        << "practice is no exam";
    EXPECT_EQ(refused([&] { exams.set(ExamSettings{"ex1", 0, ""}, kAdmin); }), "books-invalid");
    EXPECT_EQ(refused([&] { exams.set(ExamCandidate{"ex1", "s3", hash(11), 0, 0, ""}, kAdmin); }), "books-duplicate");
    EXPECT_EQ(refused([&] { exams.set(ExamCandidate{"ex1", "nobody", hash(14), 0, 0, ""}, kAdmin); }), "books-unknown");
    EXPECT_EQ(refused([&] { exams.set(ExamCandidate{"ex1", "s3", hash(14), 301, 0, ""}, kAdmin); }), "books-invalid");
    EXPECT_EQ(refused([&] { exams.add(ExamPack{"ex1", 1, hash(22), "another", "", "", 0}, kAdmin); }), "books-changed");
    EXPECT_EQ(refused([&] { (void)exams.add(entry(3, "started"), nullptr, nullptr); }), "books-unknown") << "a gap";
    ExamEntry other = entry(1, "begun", sitting);
    other.hash = hash(5);
    EXPECT_EQ(refused([&] { (void)exams.add(other, &one, nullptr); }), "books-changed");
    EXPECT_EQ(refused([&] { (void)exams.add(entry(2, "begun", sitting), &one, nullptr); }), "books-changed");
    EXPECT_EQ(refused([&] { (void)exams.add(entry(2, "checkpoint", id(5)), nullptr, nullptr); }), "books-unknown");
    const auto decide = [&](const char* kind, const char* person, const char* verdict, const char* words = "why") {
        static std::uint64_t number = 500;
        return errorIdOf([&] {
            exams.add(ExamDecision{id(++number), sitting, person, kind, verdict, 0, 0, words, kNow}, {person, kNow});
        });
    };
    EXPECT_EQ(decide("appeal", "s1", ""), "books-invalid");
    EXPECT_EQ(decide("decide", "t1", "pass"), "books-invalid");
    EXPECT_EQ(decide("confirm", "t1", "perhaps"), "books-invalid");
    EXPECT_EQ(decide("shout", "t1", "pass"), "books-invalid");
    EXPECT_EQ(dump(), before);
    EXPECT_EQ(verdictOf(exams.decisionsOf(sitting)), kUnconfirmed);
    EXPECT_EQ(decide("confirm", "t1", "fail"), "");
    EXPECT_EQ(verdictOf(exams.decisionsOf(sitting)), "fail");
    EXPECT_EQ(decide("appeal", "s1", ""), "");
    EXPECT_EQ(verdictOf(exams.decisionsOf(sitting)), kUnconfirmed);
    EXPECT_EQ(decide("decide", "t1", "pass"), "books-invalid") << "nobody marked it again";
    EXPECT_EQ(decide("remark", "t1", "pass"), "books-invalid");
    EXPECT_EQ(decide("remark", "admin", "pass"), "");
    EXPECT_EQ(decide("decide", "t1", "pass"), "");
    EXPECT_EQ(verdictOf(exams.decisionsOf(sitting)), "pass");
    // Nobody changes it past the books.
    for (const char* what : {"UPDATE exam_decisions SET verdict = 'fail'", "UPDATE exam_entries SET at = 0",
                             "UPDATE exam_packs SET text = ''"})
        EXPECT_ANY_THROW(sql(what)) << what;
}

TEST_P(BooksTest, OfPracticeLetGoWhatNeedNotBeKeptAndTellItBefore) {
    auto books = filled();
    makeExam(*books);
    Retention retention(*books);
    const auto ids = [&](Milliseconds now) {
        std::vector<std::string> all;
        for (const Expiring& one : retention.expiring(now))
            all.push_back(one.attempt);
        return all;
    };
    const auto pushed = [&](std::uint64_t number, const char* assignment, const std::string& file, Milliseconds came) {
        PushedAttempt p = attempt(number, {file});
        p.assignment = assignment, p.received = came;
        p.attempt.finished = kNow + 9000 * kDay;  // its station's clock is wrong by decades
        EXPECT_TRUE(books->push(p));
    };
    upload(*books, "one"), upload(*books, "shared");
    pushed(1, "a1", "one", kNow), pushed(2, "a1", "shared", kNow + 5 * kDay), pushed(3, "", "shared", kNow);
    pushed(4, "ex1", "exam", kNow), pushed(5, "a1", "exemplar", kNow);
    sql("INSERT INTO exemplars (attempt, assignment, content, who, made) VALUES ('" + id(5) + "', 'a1', '', 't1', 0)");
    EXPECT_THAT(ids(kNow + 9000 * kDay), IsEmpty()) << "nobody has set anything";
    EXPECT_EQ(errorIdOf([&] { retention.setForPersonal(-1, kAdmin); }), "books-invalid");
    EXPECT_EQ(errorIdOf([&] { retention.setForClass("c9", {}, kAdmin); }), "books-unknown");
    EXPECT_EQ(errorIdOf([&] { retention.setForClass("c1", {40'000, 0}, kAdmin); }), "books-invalid");
    retention.setForClass("c1", {10, 365}, kAdmin);
    EXPECT_EQ(retention.ofClass("c1").practiceDays, 10);
    EXPECT_THAT(ids(kNow + 10 * kDay - 1), IsEmpty());
    EXPECT_THAT(ids(kNow + 10 * kDay), ElementsAre(id(1)));
    EXPECT_EQ(retention.expiring(kNow + 10 * kDay).front().bytes, 3u);
    EXPECT_THAT(ids(kNow + 15 * kDay), ElementsAre(id(1), id(2)));
    retention.setForPersonal(2, kAdmin);
    EXPECT_THAT(ids(kNow + 2 * kDay), ElementsAre(id(3)));
    const std::string before = dump();
    (void)ids(kNow + 15 * kDay);
    EXPECT_EQ(dump(), before) << "to tell it changes nothing";
    EXPECT_EQ(retention.expire({"server", kNow + 10 * kDay}), 2);
    EXPECT_FALSE(books->attempt(id(1)) || books->attempt(id(3)));
    EXPECT_FALSE(books->files().has(sha256("one")));
    EXPECT_TRUE(books->files().has(sha256("shared"))) << "another has it";
    EXPECT_EQ(retention.expire({"server", kNow + 15 * kDay}), 1);
    EXPECT_FALSE(books->files().has(sha256("shared")));
    std::size_t audited = 0;
    for (const AuditLine& line : books->audit(0, 1000))
        audited += line.what == "expire" ? 1 : 0;
    EXPECT_EQ(audited, 3u);
    // Exams and exemplars stay until the class's own time is over.
    EXPECT_TRUE(books->attempt(id(4)) && books->attempt(id(5)));
    books->close("c1", {"admin", kNow + 20 * kDay});
    EXPECT_THAT(ids(kNow + 385 * kDay - 1), IsEmpty());
    EXPECT_EQ(retention.expire({"server", kNow + 385 * kDay}), 2);
}

TEST(BooksOfBothDatabases, HaveTheSameExams) {
    if (!server()) GTEST_SKIP() << kNoServer;
    const core::PrivateFolder folder;
    const std::uint64_t seed = test::seed(20261126);
    std::vector<std::string> dumps;
    for (const std::string& address : {std::string(), server()->address(server()->newSchema())}) {
        std::mt19937_64 random(seed);
        Books books(folder.path() / (address.empty() ? "a" : "b"), address);
        fill(books);
        makeExam(books);
        ExamBooks exams(books);
        std::string told;
        for (int step = 0; step < 1500; ++step) {
            const std::string sitting = id(70 + below(random, 4));
            const auto number = exams.endOf(kStation).number + static_cast<std::int64_t>(below(random, 3));
            const std::size_t kind = below(random, 6);
            const char* const kDecisions[] = {"confirm", "appeal", "remark", "decide"};
            const char* const kVerdicts[] = {"pass", "fail", "void"};
            const char* const kWho[] = {"t1", "s1", "s2", "s3", "admin"};
            const std::string who = kWho[below(random, 5)], what = kDecisions[below(random, 4)],
                              verdict = kVerdicts[below(random, 3)];
            const ExamDecision decision{id(1000 + static_cast<std::uint64_t>(step)),
                                        sitting,
                                        who,
                                        what,
                                        what == "appeal" ? "" : verdict,
                                        0,
                                        0,
                                        "why",
                                        kNow};
            const ExamSitting one = begins(sitting);
            told += errorIdOf([&] {
                if (kind == 0) told += std::to_string(exams.add(entry(number, "started"), nullptr, nullptr));
                if (kind == 1) told += std::to_string(exams.add(entry(number, "begun", sitting), &one, nullptr));
                if (kind == 2)
                    told += std::to_string(exams.add(entry(number, "checkpoint", sitting), nullptr, nullptr));
                if (kind == 3) told += std::to_string(exams.add(entry(number, "given-up", sitting), nullptr, nullptr));
                if (kind >= 4) exams.add(decision, {who, kNow});
            });
            told += ' ';
        }
        dumps.push_back(told + asText(books.everything()));
    }
    EXPECT_EQ(dumps[0], dumps[1]);
    EXPECT_THAT(dumps[0], HasSubstr("exam decide")) << "an appeal was decided, too";
}

}  // namespace
}  // namespace handpiece::school::exam_books_test
