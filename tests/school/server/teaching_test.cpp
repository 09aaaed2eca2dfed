// SPDX-License-Identifier: Apache-2.0
// A teacher's work in the browser, over real HTTP: marking, and what students see of it.
#include <set>

#include "school/server/teaching_fixture.h"
#include "school/sheet.h"

namespace handpiece::school_server {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

httplib::Params sheetOf(const char* points, const char* band, const char* verdict, const char* rating) {
    return {{"m.removed", points}, {"m.amount", band},   {"m.total", ""},     {"verdict", verdict},
            {"rating", rating},    {"c.removed", "<b>"}, {"comment", "even"}, {"do", "give"}};
}

TEST_F(TeachingTest, MarkersMarkBlindAndHalfMarksWait) {
    School school(data());
    Browser examiner(school.address());
    ASSERT_EQ(examiner.logIn("e1"), 303);
    EXPECT_THAT(examiner.get("/marking")->body, HasSubstr("/classes/c1/marking"));
    EXPECT_THAT(examiner.get("/classes/c1/marking")->body,
                AllOf(HasSubstr("/assignments/as1/marking"), Not(HasSubstr("/assignments/as1/marks"))));
    EXPECT_THAT(examiner.get("/assignments/as1/marking")->body, HasSubstr("Begin with 6 works"));
    EXPECT_EQ(examiner.send("/assignments/as1/marking", {})->status, 303);
    const std::vector<std::string> codes = codesOn(examiner);
    ASSERT_THAT(codes, SizeIs(7)) << "one comes twice";
    const std::string desk = examiner.get("/assignments/as1/marking")->body;
    for (std::size_t i = 0; i < kStudents; ++i) {
        EXPECT_THAT(desk, Not(HasSubstr(attempts_[i])));
        EXPECT_THAT(desk, Not(HasSubstr(fmt::format("w{}<", i))));
    }
    // No name, no code of a person, no id on a work's page; of real work its picture.
    std::size_t pictures = 0;
    for (const std::string& code : codes) {
        const std::string page = examiner.get("/assignments/as1/marking/" + code)->body;
        pictures += page.find("data:image/png") != std::string::npos ? 1 : 0;
        for (std::size_t i = 0; i < kStudents; ++i)
            EXPECT_THAT(page, AllOf(Not(HasSubstr(attempts_[i])), Not(HasSubstr(fmt::format("Name{}", i)))));
    }
    EXPECT_GE(pictures, 1u);
    // What is half typed waits, as it was typed.
    const std::string at = "/assignments/as1/marking/" + codes[0];
    EXPECT_THAT(examiner.send(at, {{"m.removed", "3,x\"<"}, {"c.amount", "why?"}, {"do", "keep"}})->body,
                HasSubstr("not given in yet"));
    EXPECT_THAT(examiner.get(at)->body, AllOf(HasSubstr("value=\"3,x&quot;&lt;\""), HasSubstr("why?")));
    // What is wrong is said beside each field, and nothing typed is lost.
    const auto wrong =
        examiner.send(at, {{"m.removed", "7"}, {"m.amount", "good"}, {"comment", "kept?"}, {"do", "give"}});
    EXPECT_EQ(wrong->status, 422);
    EXPECT_THAT(wrong->body, AllOf(HasSubstr("Give 0 to 6 points"), HasSubstr("value=\"7\""), HasSubstr("kept?"),
                                   HasSubstr("aria-invalid"), HasSubstr("Choose one.")));
    EXPECT_THAT(examiner.get(at)->body, HasSubstr("kept?")) << "also on the server";
    EXPECT_THAT(books().marksOf(attempts_[0]), SizeIs(0));
    // Given in it is fixed, and leads to the next.
    const auto given = examiner.send(at, sheetOf("4,5", "poor", "yes", "3"));
    ASSERT_EQ(given->status, 303);
    EXPECT_EQ(given->get_header_value("Location"), "/assignments/as1/marking/" + codes[1]);
    EXPECT_EQ(examiner.send(at, sheetOf("1", "good", "no", "1"))->status, 303);
    Books open(data());
    const auto sheet = school::Teaching(open).sheet("as1", "e1", codes[0]);
    ASSERT_TRUE(sheet && sheet->isIn);
    EXPECT_THAT(sheet->content, HasSubstr("4,5"));
    const std::vector<school::Mark> marks = open.marksOf(sheet->attempt);
    ASSERT_THAT(marks, SizeIs(1));
    EXPECT_EQ(marks[0].points, 4.5 + 1.0) << "25 % of 4 for the band";
    EXPECT_EQ(marks[0].maxPoints, 10.0);
    EXPECT_EQ(marks[0].verdict, "yes");
    for (std::size_t i = 1; i < codes.size(); ++i)
        EXPECT_EQ(examiner.send("/assignments/as1/marking/" + codes[i], sheetOf("6", "good", "yes", "5"))->status, 303);
    EXPECT_THAT(examiner.get("/assignments/as1/marking")->body, HasSubstr("All your marks are in."));
    std::size_t all = 0;
    for (const std::string& id : attempts_)
        all += open.marksOf(id).size();
    EXPECT_EQ(all, kStudents) << "the second mark of a work that comes twice is none of the student's";
    // Work that comes later is a batch of its own: nothing else moves.
    push(open, 3, false, 9000);
    finish(open, 8.0);
    EXPECT_EQ(examiner.send("/assignments/as1/marking", {})->status, 303);
    std::vector<std::string> more = codesOn(examiner);
    ASSERT_THAT(more, SizeIs(8));
    more.resize(codes.size());
    EXPECT_EQ(more, codes);
}

TEST_F(TeachingTest, MarkersWhoDifferAreAdjudicatedAndStudentsSeeWhatIsReleased) {
    School school(data());
    Browser examiner(school.address()), teacher(school.address()), student(school.address());
    ASSERT_EQ(examiner.logIn("e1"), 303);
    ASSERT_EQ(teacher.logIn("t1"), 303);
    ASSERT_EQ(student.logIn("w1"), 303);
    EXPECT_EQ(examiner.send("/assignments/as1/marking", {})->status, 303);
    EXPECT_EQ(teacher.send("/assignments/as1/marking", {})->status, 303);
    for (const std::string& code : codesOn(examiner))
        EXPECT_EQ(examiner.send("/assignments/as1/marking/" + code, sheetOf("5", "good", "yes", "4"))->status, 303);
    // Who has works open sees nobody's marks.
    const std::string path = "/attempts/" + attempts_[1] + "/adjudication";
    EXPECT_THAT(teacher.get("/assignments/as1/marks")->body,
                AllOf(HasSubstr("once all of yours are in"), Not(HasSubstr("9.0"))));
    EXPECT_EQ(teacher.get(path)->status, 403);
    EXPECT_THAT(teacher.get("/attempts/" + attempts_[1])->body, HasSubstr("Nobody has marked"));
    Books open(data());
    for (const std::string& code : codesOn(teacher)) {
        const auto found = teacher.get("/assignments/as1/marking/" + code);
        ASSERT_EQ(found->status, 200);
        EXPECT_EQ(teacher.send("/assignments/as1/marking/" + code, sheetOf("4", "good", "yes", "4"))->status, 303);
    }
    // 9 against 8 of 10: as far as they may; under 5 % all are to be adjudicated.
    EXPECT_THAT(teacher.get("/assignments/as1/marks")->body,
                AllOf(HasSubstr("6 of 6 works are settled"), HasSubstr("8.5 / 10.0")));
    EXPECT_EQ(teacher.send("/assignments/as1/marks", {{"do", "difference"}, {"percent", "x"}})->status, 422);
    EXPECT_EQ(teacher.send("/assignments/as1/marks", {{"do", "difference"}, {"percent", "5"}})->status, 303);
    EXPECT_THAT(teacher.get("/assignments/as1/marks")->body, HasSubstr("0 of 6 works are settled, 6 wait"));
    EXPECT_EQ(teacher.send(path, {{"m.removed", "5"}})->status, 422);
    httplib::Params word = sheetOf("5", "poor", "no", "2");
    EXPECT_EQ(teacher.send(path, word)->status, 303);
    EXPECT_THAT(teacher.get("/assignments/as1/marks")->body,
                AllOf(HasSubstr("1 of 6 works are settled"), HasSubstr("6.0 / 10.0")));
    // The student sees nothing before it is released, then the school's word and no marker's name.
    const std::string own = "/attempts/" + attempts_[1];
    EXPECT_THAT(student.get(own)->body, AllOf(HasSubstr("Nobody has marked"), Not(HasSubstr("even"))));
    EXPECT_THAT(teacher.send("/assignments/as1/marks", {{"do", "release"}})->body, HasSubstr("1 works are released"));
    EXPECT_THAT(student.get(own)->body, AllOf(HasSubstr("6.0 / 10.0"), HasSubstr("Not passed"), HasSubstr("even"),
                                              HasSubstr("&lt;b&gt;"), Not(HasSubstr("t1<")), Not(HasSubstr("e1<"))));
    EXPECT_EQ(student.get(path)->status, 403);
    EXPECT_EQ(student.get("/assignments/as1/marks")->status, 403);
    EXPECT_EQ(examiner.get("/assignments/as1/marks")->status, 403);
    EXPECT_EQ(teacher.send("/assignments/as1/marks", {{"do", "take-back"}})->status, 200);
    EXPECT_THAT(student.get(own)->body, HasSubstr("Nobody has marked"));
    // Each marker's own repeat, both markers and the machine.
    const std::string agreement = teacher.get("/assignments/as1/agreement")->body;
    EXPECT_THAT(agreement,
                AllOf(HasSubstr("machine"), HasSubstr("e1 again"), HasSubstr("ICC(2,1)"), HasSubstr("Amount")));
    // All of it in the audit.
    std::set<std::string> done;
    for (const school::AuditLine& line : open.audit(0, 2000))
        done.insert(line.what);
    for (const char* what : {"begin marking", "take works", "give in marks", "mark", "set difference", "release marks",
                             "take back marks", "marks seen", "work seen blind", "agreement seen"})
        EXPECT_TRUE(done.contains(what)) << what;
}

TEST(SettleTest, IsTheMeanOfTheNewestUnlessTheyDifferTooMuchOrOnWhoPasses) {
    const auto mark = [](const char* marker, const char* kind, const char* verdict, double points, int made) {
        return school::Mark{"", "", marker, kind, verdict, points, 20.0, "", made};
    };
    std::vector<school::Mark> marks{mark("a", "blind", "yes", 2.0, 1), mark("a", "blind", "yes", 14.0, 2)};
    EXPECT_EQ(settle(marks, 10.0).final->points, 14.0) << "the newest of a marker";
    marks.push_back(mark("b", "blind", "yes", 16.0, 1));
    EXPECT_EQ(settle(marks, 10.0).differencePercent, 10.0);
    EXPECT_EQ(settle(marks, 10.0).final->points, 15.0);
    EXPECT_TRUE(settle(marks, 9.9).needsAdjudication);
    EXPECT_FALSE(settle(marks, 9.9).final);
    marks.back().verdict = "no";
    EXPECT_TRUE(settle(marks, 100.0).needsAdjudication);
    marks.push_back(mark("c", "adjudication", "no", 11.0, 3));
    EXPECT_FALSE(settle(marks, 0.0).needsAdjudication);
    EXPECT_EQ(settle(marks, 0.0).final->points, 11.0);
    EXPECT_FALSE(settle({}, 0.0).final);
}

}  // namespace
}  // namespace handpiece::school_server
