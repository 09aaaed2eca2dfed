// SPDX-License-Identifier: Apache-2.0
// What the books hold of a teacher's work, the same on both databases.
#include <gmock/gmock.h>

#include "handpiece/school/store/retention.h"
#include "handpiece/school/store/teaching.h"
#include "school/store/books_fixture.h"
#include "support/error_of.h"

namespace handpiece::school::books_teaching_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

class TeachingBooksTest : public BooksTest {
  protected:
    /// Attempts of three students, each scored.
    void work(Books& books) const {
        for (std::uint64_t n = 1; n <= 3; ++n) {
            PushedAttempt p = attempt(n);
            p.person = fmt::format("s{}", n);
            books.push(p);
            const Job job = books.takeJob("w", kNow, 1000).value();
            ASSERT_TRUE(books.finish(job, scoreOf(job, "w")));
        }
    }
};
INSTANTIATE_TEST_SUITE_P(Both, TeachingBooksTest, testing::Values("sqlite", "postgres"),
                         [](const auto& all) { return std::string(all.param); });

TEST_P(TeachingBooksTest, ADeskKeepsItsWorksAndASheetThatIsInStays) {
    auto books = filled();
    work(*books);
    Teaching teaching(*books);
    EXPECT_THAT(teaching.worksOf("a1"), ElementsAre(id(1), id(2), id(3)));
    EXPECT_FALSE(teaching.desk("a1", "t1"));
    const MarkingDesk desk = teaching.takeWorks("a1", "t1", 0xfedcba9876543210, kAdmin);
    EXPECT_EQ(desk.seed, 0xfedcba9876543210);
    EXPECT_THAT(desk.batches, ElementsAre(SizeIs(3)));
    EXPECT_EQ(teaching.takeWorks("a1", "t1", 1, kAdmin).seed, desk.seed) << "its own for ever";
    // A later attempt of a student is another work, behind the others.
    PushedAttempt later = attempt(9);
    later.person = "s2";
    books->push(later);
    EXPECT_THAT(teaching.worksOf("a1"), ElementsAre(id(1), id(2), id(3))) << "not scored yet";
    const Job job = books->takeJob("w", kNow, 1000).value();
    books->finish(job, scoreOf(job, "w"));
    EXPECT_THAT(teaching.worksOf("a1"), ElementsAre(id(1), id(3), id(9)));
    EXPECT_THAT(teaching.takeWorks("a1", "t1", 1, kAdmin).batches, ElementsAre(SizeIs(3), ElementsAre(id(9))));
    EXPECT_THAT(teaching.takeWorks("a1", "s1", 1, kAdmin).batches, ElementsAre(SizeIs(2))) << "nobody marks their own";

    MarkingSheet sheet{"a1", "t1", "abcd", id(1), "{\"half\":1}"};
    EXPECT_TRUE(teaching.save(sheet, {}, kAdmin));
    sheet.content = "{\"more\":1}";
    EXPECT_TRUE(teaching.save(sheet, {}, kAdmin));
    EXPECT_EQ(teaching.sheet("a1", "t1", "abcd")->content, sheet.content);
    sheet.isIn = true;
    const Mark mark{id(77), id(1), "t1", "blind", "yes", 8.0, 10.0, "{}", kNow};
    EXPECT_TRUE(teaching.save(sheet, mark, kAdmin));
    EXPECT_THAT(books->marksOf(id(1)), SizeIs(1));
    sheet.content = "{\"changed\":1}";
    EXPECT_FALSE(teaching.save(sheet, Mark{id(78), id(1), "t1", "blind", "no", 1.0, 10.0, "{}", kNow}, kAdmin));
    EXPECT_EQ(teaching.sheet("a1", "t1", "abcd")->content, "{\"more\":1}");
    EXPECT_THAT(books->marksOf(id(1)), SizeIs(1));
    EXPECT_THAT(teaching.marksOn("a1"), SizeIs(1));
    const auto stranger = test::errorFrom([&] { teaching.save({"a1", "t1", "efgh", id(4), "{}"}, {}, kAdmin); });
    EXPECT_EQ(stranger->id(), "books-unknown");

    EXPECT_EQ(teaching.differenceAllowed("a1"), Teaching::kUsualDifference);
    teaching.setDifferenceAllowed("a1", 0.1 + 0.2, kAdmin);
    teaching.setDifferenceAllowed("a1", 12.5, kAdmin);
    EXPECT_EQ(teaching.differenceAllowed("a1"), 12.5);
    EXPECT_TRUE(test::errorFrom([&] { teaching.setDifferenceAllowed("a1", 101.0, kAdmin); }));
    teaching.release(std::vector<std::string>{id(1), id(3)}, true, kAdmin);
    EXPECT_TRUE(teaching.isReleased(id(1)));
    teaching.release(std::vector<std::string>{id(1)}, false, kAdmin);
    EXPECT_THAT(teaching.released("a1"), ElementsAre(id(3)));
    // All of it is in what is held of a person; and not whose work is marked blind by whom.
    const auto of = [&](const char* code) { return asText(books->about(code, kAdmin)); };
    EXPECT_THAT(of("t1"), testing::AllOf(HasSubstr("# desks\n"), HasSubstr("# sheets\n"), HasSubstr("{\"more\":1}")));
    const std::string marker = of("t1"), student = of(books->attempt(id(1))->person.c_str());
    EXPECT_THAT(marker, Not(HasSubstr(id(1)))) << "which code is which work";
    EXPECT_THAT(student, Not(testing::AnyOf(HasSubstr("{\"more\":1}"), HasSubstr(id(77))))) << "not released";
    teaching.release(std::vector<std::string>{id(1)}, true, kAdmin);
    EXPECT_THAT(of(books->attempt(id(1))->person.c_str()), HasSubstr(id(77)));
    EXPECT_THAT(of("t1"), HasSubstr(id(1)));
}

TEST_P(TeachingBooksTest, WhatCountsIsChosenAndRubricsGetNumbers) {
    auto books = filled();
    work(*books);
    Teaching teaching(*books);
    const RubricVersion third = teaching.addRubric({shortHash(0xad), "46-class-one", "# three\n", 0, 0}, kAdmin);
    EXPECT_EQ(third.version, 3);
    EXPECT_EQ(teaching.addRubric({shortHash(0xad), "46-class-one", "# three\n", 0, 0}, kAdmin).version, 3);
    EXPECT_EQ(test::errorFrom([&] {
                  (void)teaching.addRubric({shortHash(0xad), "46-class-one", "# other\n", 0, 0}, kAdmin);
              })->id(),
              "books-changed");
    EXPECT_THAT(teaching.rubrics(), SizeIs(3));
    EXPECT_THAT(teaching.packs(), SizeIs(1));
    teaching.add(Campaign{"c-one", "a1", shortHash(0xad), "t1"}, kAdmin);
    EXPECT_EQ(test::errorFrom([&] {
                  teaching.add(Campaign{"c-one", "a1", shortHash(0xad), "t1"}, kAdmin);
              })->id(),
              "books-duplicate");
    EXPECT_TRUE(test::errorFrom([&] { teaching.add(Campaign{"arrival", "a1", shortHash(0xad), "t1"}, kAdmin); }));
    EXPECT_EQ(books->rescore("c-one", "a1", shortHash(0xad), kAdmin), 3);
    for (int i = 0; i < 3; ++i) {
        const Job job = books->takeJob("w", kNow, 1000).value();
        Score score = scoreOf(job, "w");
        score.score = 1.0;
        books->finish(job, score);
    }
    EXPECT_EQ(books->scoresOf(id(1)).back().score, 6.5) << "what counted goes on to count";
    EXPECT_EQ(books->classPage("c1").cells.at(0).score, 6.5);
    EXPECT_EQ(teaching.counting("a1"), kArrival);
    teaching.setCounting("a1", "c-one", kAdmin);
    EXPECT_EQ(books->scoresOf(id(1)).back().score, 1.0);
    EXPECT_THAT(books->scoresOf(id(1)), SizeIs(2)) << "both stay";
    EXPECT_EQ(books->classPage("c1").cells.at(0).score, 1.0);
    EXPECT_EQ(books->assignment("a1")->rubric, shortHash(0xad));
    EXPECT_EQ(teaching.scores("a1").at(0).score, 1.0);
    EXPECT_EQ(teaching.scores("a1", kArrival).at(0).score, 6.5);
    EXPECT_EQ(teaching.outcomes("c1", true).at(0).score->score, 1.0);
    EXPECT_THAT(teaching.outcomes("c1", false), SizeIs(3));
    EXPECT_EQ(teaching.outcomes("c1", false).at(0).score->result, "");
    EXPECT_EQ(teaching.outcomesOf("s2", true).at(0).score->result, "{}");
    EXPECT_EQ(test::errorFrom([&] { teaching.setCounting("a1", "c-none", kAdmin); })->id(), "books-unknown");
    // Work that the campaign has not scored counts by what it has.
    PushedAttempt later = attempt(9);
    books->push(later);
    const Job job = books->takeJob("w", kNow, 1000).value();
    EXPECT_EQ(job.rubric, shortHash(0xad));
    books->finish(job, scoreOf(job, "w"));
    EXPECT_EQ(books->scoresOf(id(9)).back().score, 6.5);
    teaching.setCounting("a1", kArrival, kAdmin);
    EXPECT_EQ(books->assignment("a1")->rubric, shortHash(0xab)) << "as it was given out";
    EXPECT_THAT(teaching.campaigns("a1"), SizeIs(1));
    EXPECT_EQ(teaching.campaign("c-one")->rubric, shortHash(0xad));
    teaching.setTimes("a1", kNow + 1, kNow + 2, kAdmin);
    EXPECT_EQ(books->assignment("a1")->closes, kNow + 2);
    EXPECT_TRUE(test::errorFrom([&] { teaching.setTimes("a1", kNow + 3, kNow + 2, kAdmin); }));
    EXPECT_EQ(test::errorFrom([&] { teaching.setTimes("a9", 1, 2, kAdmin); })->id(), "books-unknown");
}

TEST_P(TeachingBooksTest, StandardsAndExemplarsAreKeptAndGoWithTheirAttempts) {
    auto books = filled();
    work(*books);
    Teaching teaching(*books);
    const std::vector<AngoffEstimate> first{{"t1", 1, "depth", 0.1 + 0.2}, {"t1", 1, "width", 80.0}};
    teaching.setEstimates("a1", first, kAdmin);
    teaching.setEstimates("a1", std::vector<AngoffEstimate>{{"t1", 1, "width", 70.0}, {"t1", 2, "width", 75.0}},
                          kAdmin);
    EXPECT_THAT(teaching.estimates("a1"),
                ElementsAre(first[0], AngoffEstimate{"t1", 1, "width", 70.0}, AngoffEstimate{"t1", 2, "width", 75.0}));
    EXPECT_TRUE(test::errorFrom([&] {
        teaching.setEstimates("a1", std::vector<AngoffEstimate>{{"t1", 3, "width", 1.0}}, kAdmin);
    }));
    EXPECT_TRUE(test::errorFrom([&] {
        teaching.setEstimates("a1", std::vector<AngoffEstimate>{{"t1", 1, "width", 100.5}}, kAdmin);
    }));
    teaching.add(KeptStandard{"k1", "a1", "angoff", "{}", "t1"}, kAdmin);
    EXPECT_THAT(teaching.standards("a1"), SizeIs(1));
    EXPECT_TRUE(test::errorFrom([&] { teaching.add(KeptStandard{"k2", "a1", "guess", "{}", "t1"}, kAdmin); }));

    teaching.set(Exemplar{id(2), "a1", "{}", "t1"}, kAdmin);
    teaching.set(Exemplar{id(2), "a1", "{\"a\":1}", "t1"}, kAdmin);
    EXPECT_EQ(teaching.exemplars("a1").at(0).content, "{\"a\":1}");
    EXPECT_THAT(teaching.worksOf("a1"), ElementsAre(id(1), id(3)));
    EXPECT_TRUE(teaching.add(Calibration{id(2), "t1", "{}"}, kAdmin));
    EXPECT_FALSE(teaching.add(Calibration{id(2), "t1", "{\"again\":1}"}, kAdmin)) << "the first counts";
    EXPECT_EQ(teaching.calibrations("a1").at(0).content, "{}");
    EXPECT_EQ(test::errorFrom([&] {
                  (void)teaching.add(Calibration{id(1), "t1", "{}"}, kAdmin);
              })->id(),
              "books-unknown");
    // A class that is over takes them along.
    (void)teaching.takeWorks("a1", "t1", 5, kAdmin);
    (void)teaching.save({"a1", "t1", "abcd", id(1), "{}"}, {}, kAdmin);
    teaching.release(std::vector<std::string>{id(1)}, true, kAdmin);
    books->close("c1", kAdmin);
    EXPECT_EQ(Retention(*books).expire({"server", kNow + 400 * kDay}), 3);
    EXPECT_THAT(teaching.exemplars("a1"), IsEmpty());
    EXPECT_THAT(teaching.sheets("a1"), IsEmpty());
    EXPECT_THAT(teaching.calibrations("a1"), IsEmpty());
    EXPECT_THAT(teaching.desk("a1", "t1")->batches, ElementsAre(SizeIs(2))) << "so that codes stay";
}

}  // namespace
}  // namespace handpiece::school::books_teaching_test
