// SPDX-License-Identifier: Apache-2.0
// A teacher's work in the browser, over real HTTP: marking, and what students see of it.
#include <set>

#include "school/server/teaching_fixture.h"
#include "school/sheet.h"

namespace handpiece::school_server::teaching_test {
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
        EXPECT_THAT(desk, Not(HasSubstr(fmt::format(">w{}<", i))));
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
    Books open = books();
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
    Books open = books();
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
    // One alone, out and back: each that is settled has its button.
    EXPECT_THAT(teacher.get("/assignments/as1/marks")->body,
                AllOf(HasSubstr("name=\"release-one\" value=\"" + attempts_[1] + "\""),
                      Not(HasSubstr("name=\"release-one\" value=\"" + attempts_[2] + "\""))));
    for (const std::string& odd : {attempts_[2], std::string("nobody's")})
        EXPECT_EQ(teacher.send("/assignments/as1/marks", {{"release-one", odd}})->status, 422) << "not settled";
    EXPECT_THAT(teacher.send("/assignments/as1/marks", {{"release-one", attempts_[1]}})->body,
                HasSubstr("name=\"take-back-one\" value=\"" + attempts_[1] + "\""));
    EXPECT_THAT(student.get(own)->body, HasSubstr("6.0 / 10.0"));
    EXPECT_EQ(teacher.send("/assignments/as1/marks", {{"take-back-one", attempts_[1]}})->status, 200);
    EXPECT_THAT(student.get(own)->body, HasSubstr("Nobody has marked"));
    EXPECT_EQ(student.send("/assignments/as1/marks", {{"release-one", attempts_[1]}})->status, 403);
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

TEST_F(TeachingTest, ARubricIsEditedCheckedAndKeptAsANewVersion) {
    School school(data());
    Browser teacher(school.address()), examiner(school.address());
    ASSERT_EQ(teacher.logIn("t1"), 303);
    ASSERT_EQ(examiner.logIn("e1"), 303);
    EXPECT_THAT(teacher.get("/rubrics")->body, HasSubstr("/rubrics/" + marked_));
    EXPECT_EQ(examiner.get("/rubrics")->status, 403);
    EXPECT_EQ(examiner.send("/rubrics", {{"text", kMarkedRubric}})->status, 403);
    const std::string form = teacher.get("/rubrics/" + marked_ + "/edit")->body;
    EXPECT_THAT(form, AllOf(HasSubstr("name=\"0.weight\""), HasSubstr("value=\"0 0; 0.5 100; 9 100\""),
                            HasSubstr("Good: from")));
    // Nonsense, and what makes no sense: said beside the field, nothing typed is lost, nothing kept.
    const auto nonsense =
        teacher.send("/rubrics/check", {{"of", marked_}, {"0.weight", "x<y"}, {"0.knots", "1 2 3"}, {"version", "2"}});
    EXPECT_EQ(nonsense->status, 422);
    EXPECT_THAT(nonsense->body,
                AllOf(HasSubstr("This is no number"), HasSubstr("value=\"x&lt;y\""), HasSubstr("Write pairs")));
    const auto unsound =
        teacher.send("/rubrics/check", {{"of", marked_}, {"0.knots", "5 0; 1 100"}, {"0.title", "Typed"}});
    EXPECT_EQ(unsound->status, 422);
    EXPECT_THAT(unsound->body,
                AllOf(HasSubstr("cannot be used so"), HasSubstr("value=\"Typed\""), HasSubstr("5 0; 1 100")));
    EXPECT_THAT(teacher.send("/rubrics/check", {{"of", marked_}, {"title", "Other words"}})->body,
                HasSubstr("there is nothing to save"));
    EXPECT_EQ(teacher.send("/rubrics/check", {{"text", "no = [toml"}})->status, 422);
    Books open = books();
    EXPECT_THAT(school::Teaching(open).rubrics(), SizeIs(2));
    const auto sound =
        teacher.send("/rubrics/check", {{"of", marked_}, {"0.weight", "9"}, {"pass_mark", "55,5"}, {"version", "2"}});
    ASSERT_EQ(sound->status, 200);
    EXPECT_THAT(sound->body,
                AllOf(HasSubstr("It can be used"), HasSubstr("What it changes of version 1"), HasSubstr("55.5")));
    rubric::Rubric mine = rubric::parseRubric(kMarkedRubric, "");
    mine.criteria[0].weight = 9, mine.passMark = 55.5, mine.version = "2";
    const std::string hash = rubric::hashText(rubric::hashOf(mine));
    // As a file of more than the library's eight kilobytes for a form, in a comment.
    const std::string text = rubric::rubricToml(mine) + "# " + std::string(20'000, 'x') + "\n";
    const auto saved = teacher.send("/rubrics", {{"text", text}});
    ASSERT_EQ(saved->status, 303);
    EXPECT_EQ(saved->get_header_value("Location"), "/rubrics/" + hash);
    EXPECT_EQ(open.rubric(hash)->version, 2);
    EXPECT_EQ(open.rubric(hash)->text, text);
    EXPECT_EQ(open.rubric(marked_)->text, kMarkedRubric);
    EXPECT_EQ(teacher.send("/rubrics", {{"text", text}})->status, 303) << "again: the same";
    // From a file.
    const auto file = teacher.post(
        "/rubrics/check", httplib::MultipartFormDataItems{{"token", teacher.requestToken(), "", ""},
                                                          {"file", rubric::rubricToml(mine), "r.toml", "text/plain"}});
    EXPECT_THAT(file->body, HasSubstr("there is nothing to save"));
    EXPECT_THAT(teacher.get("/rubrics/" + hash)->body, HasSubstr("What it changes of version 1"));
}

TEST_F(TeachingTest, AnAssignmentIsScoredAgainAndTheTeacherChoosesWhatCounts) {
    School school(data());
    Browser teacher(school.address());
    ASSERT_EQ(teacher.logIn("t1"), 303);
    Books open = books();
    school::Teaching teaching(open);
    rubric::Rubric harder = rubric::parseRubric(kMarkedRubric, "");
    harder.passMark = 99;
    const std::string hash = rubric::hashText(rubric::hashOf(harder));
    (void)teaching.addRubric({hash, harder.id, rubric::rubricToml(harder), 0, 0}, {"t1", 5});
    const std::string path = "/assignments/as1/rescore";
    EXPECT_EQ(teacher.send(path, {{"do", "begin"}, {"rubric", "nonsense"}})->status, 422);
    EXPECT_EQ(teacher.send(path, {{"do", "begin"}, {"rubric", hash}})->status, 303);
    EXPECT_THAT(teacher.get(path)->body, AllOf(HasSubstr("0 of 6 done"), HasSubstr("<progress max=\"6\" value=\"0\"")));
    const school::Campaign campaign = teaching.campaigns("as1").at(0);
    // While it goes on the page's script moves the bar: it asks for nothing else, and is told when it is done.
    const auto going = teacher.get(path);
    EXPECT_THAT(going->body, AllOf(HasSubstr("id=\"keep-up\" data-from=\"?progress\""), HasSubstr("src=\"/live.js\"")));
    EXPECT_THAT(going->get_header_value("Content-Security-Policy"), HasSubstr("script-src 'self'"));
    finish(open, 2.0);
    EXPECT_THAT(teacher.get(path + "?progress")->body, AllOf(HasSubstr("<progress max=\"6\" value=\"1\""),
                                                             HasSubstr("keep-up"), Not(HasSubstr("9.0 / 10.0"))));
    for (int i = 1; i < 6; ++i)
        finish(open, 2.0);
    EXPECT_THAT(teacher.get(path + "?progress")->body, AllOf(HasSubstr("6 of 6 done"), Not(HasSubstr("keep-up"))));
    EXPECT_THAT(teacher.get(path)->body, Not(HasSubstr("keep-up")));
    EXPECT_THAT(teacher.get(path)->body,
                AllOf(HasSubstr("6 of 6 done"), HasSubstr("2.0 / 10.0"), HasSubstr("9.0 / 10.0")));
    // What counts is what counted, until the teacher says otherwise.
    EXPECT_EQ(open.scoresOf(attempts_[5]).back().score, 9.0);
    EXPECT_THAT(teacher.get("/classes/c1")->body, HasSubstr("9.0 / 10.0"));
    EXPECT_EQ(teacher.send(path, {{"do", "count"}, {"campaign", "other"}})->status, 422);
    EXPECT_EQ(teacher.send(path, {{"do", "count"}, {"campaign", campaign.id}})->status, 303);
    EXPECT_EQ(open.scoresOf(attempts_[5]).back().score, 2.0);
    EXPECT_THAT(teacher.get("/classes/c1")->body, AllOf(HasSubstr("2.0 / 10.0"), Not(HasSubstr("9.0 / 10.0"))));
    EXPECT_EQ(open.assignment("as1")->rubric, hash) << "later work by the same";
    push(open, 2, false, 9000);
    EXPECT_EQ(open.takeJob("w", 30, 1)->rubric, hash);
    // And back.
    EXPECT_EQ(teacher.send(path, {{"do", "count"}, {"campaign", "arrival"}})->status, 303);
    EXPECT_EQ(open.scoresOf(attempts_[5]).back().score, 9.0);
    EXPECT_EQ(open.assignment("as1")->rubric, marked_);
    Browser stranger(school.address());
    ASSERT_EQ(stranger.logIn("t2"), 303);
    EXPECT_EQ(stranger.get(path)->status, 403);
    EXPECT_EQ(stranger.get(path + "?progress")->status, 403);
    EXPECT_EQ(stranger.send(path, {{"do", "begin"}, {"rubric", hash}})->status, 403);
}

TEST_F(TeachingTest, AnExerciseIsUploadedAndGivenToAClass) {
    School school(data());
    Browser teacher(school.address());
    ASSERT_EQ(teacher.logIn("t1"), 303);
    const auto upload = [&](Browser& by, std::string content) {
        return by.post("/exercises",
                       httplib::MultipartFormDataItems{{"token", by.requestToken(), "", ""},
                                                       {"file", std::move(content), "x.handpiece", "application/zip"}});
    };
    const auto bytesOf = [&](const tasks::Task& task) {
        const test::TemporaryFolder folder;
        tasks::writeTask(task, folder.path() / "x.handpiece");
        const std::vector<std::byte> bytes = core::readFile(folder.path() / "x.handpiece");
        return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    };
    tasks::Task other = blockTask();
    other.id = "block-two", other.voxelMm *= 2.0, other.rubric = kMarkedRubric;
    const std::string good = bytesOf(other);
    const auto bad = upload(teacher, "no zip at all");
    EXPECT_EQ(bad->status, 422);
    EXPECT_THAT(bad->body, AllOf(HasSubstr("This file was not taken"), Not(HasSubstr("/tmp"))));
    EXPECT_EQ(upload(teacher, "")->status, 422);
    EXPECT_EQ(upload(teacher, good.substr(0, good.size() / 2))->status, 422);
    tasks::Task without = other;
    without.rubric.clear();
    EXPECT_THAT(upload(teacher, bytesOf(without))->body, HasSubstr("has no rubric"));
    const auto taken = upload(teacher, good);
    ASSERT_EQ(taken->status, 303);
    const std::string hash = rubric::hashText(tasks::contentHash(other));
    EXPECT_EQ(taken->get_header_value("Location"), "/exercises/" + hash);
    EXPECT_EQ(upload(teacher, good)->status, 303) << "again: the same";
    EXPECT_THAT(teacher.get("/exercises")->body, AllOf(HasSubstr("block-two"), HasSubstr("/rubrics/" + marked_)));
    EXPECT_THAT(teacher.get("/exercises/" + hash)->body,
                AllOf(HasSubstr("block-two"), HasSubstr("/classes/c1/assignments"), Not(HasSubstr("/classes/c2/"))));
    // Larger than a message: of who is logged in; of a stranger nothing of that size is kept, and of a teacher no more
    // than the bound.
    EXPECT_EQ(upload(teacher, std::string(6u << 20, 'x'))->status, 422);
    httplib::Client nobody(school.address());
    EXPECT_EQ(nobody.Post("/exercises", std::string(6u << 20, 'x'), "text/plain")->status, 413);
    EXPECT_EQ(nobody.Post("/login", std::string(6u << 20, 'x'), "application/x-www-form-urlencoded")->status, 413);
    // Given to a class, wrongly first.
    const std::string path = "/classes/c1/assignments";
    EXPECT_EQ(teacher.get(path)->status, 200);
    const auto wrong = teacher.send(path, {{"pack", hash},
                                           {"title", "Kept <i>"},
                                           {"kind", "exam"},
                                           {"opens", "2026-02-30T10:00"},
                                           {"closes", "soon"},
                                           {"helps", "A;B"}});
    EXPECT_EQ(wrong->status, 422);
    EXPECT_THAT(wrong->body,
                AllOf(HasSubstr("Kept &lt;i&gt;"), HasSubstr("Give a day and a time."), HasSubstr("small letters")));
    EXPECT_EQ(
        teacher
            .send(path,
                  {{"pack", hash}, {"kind", "exam"}, {"opens", "2026-02-28T10:00"}, {"closes", "2026-02-28T09:59"}})
            ->status,
        422);
    const auto made = teacher.send(path, {{"pack", hash},
                                          {"title", "Mid-term"},
                                          {"kind", "exam"},
                                          {"opens", "2024-02-29T10:00"},
                                          {"closes", "2026-03-01T09:30"},
                                          {"helps", "glass"}});
    ASSERT_EQ(made->status, 303);
    const std::string at = made->get_header_value("Location");
    EXPECT_THAT(teacher.get(at)->body,
                AllOf(HasSubstr("Mid-term"), HasSubstr("2024-02-29 10:00 UTC"), HasSubstr("2026-03-01 09:30 UTC")));
    EXPECT_EQ(teacher.send(at, {{"opens", "2024-02-29T10:00"}, {"closes", "2020-01-01T00:00"}})->status, 422);
    EXPECT_THAT(teacher.send(at, {{"opens", "2024-02-29T10:00"}, {"closes", "2027-01-01T00:00"}})->body,
                HasSubstr("2027-01-01 00:00 UTC"));
    Books open = books();
    const school::Assignment kept = open.assignment(at.substr(at.rfind('/') + 1)).value();
    EXPECT_EQ(kept.opens, 1'709'200'800'000) << "2024-02-29T10:00Z by date -d";
    EXPECT_EQ(kept.helps, "glass");
    bool isNoted = false;
    for (const school::AuditLine& line : open.audit(0, 1000))
        isNoted |= line.what == "set times" && line.who == "t1" && line.about == kept.id;
    EXPECT_TRUE(isNoted);
    Browser stranger(school.address());
    ASSERT_EQ(stranger.logIn("t2"), 303);
    EXPECT_EQ(stranger.get(path)->status, 403);
    EXPECT_EQ(stranger.send(at, {{"opens", "2024-02-29T10:00"}, {"closes", "2027-01-01T00:00"}})->status, 403);
    Browser student(school.address());
    ASSERT_EQ(student.logIn("w1"), 303);
    EXPECT_EQ(upload(student, good)->status, 403);
}

TEST_F(TeachingTest, ResultsAreCurvesAndTablesWithCodesAlone) {
    School school(data());
    Books open = books();
    push(open, 1, false, 9000);
    finish(open, 9.5);
    Browser teacher(school.address());
    ASSERT_EQ(teacher.logIn("t1"), 303);
    const std::string curves = teacher.get("/classes/c1/results")->body;
    EXPECT_THAT(curves,
                AllOf(HasSubstr("<svg"), HasSubstr("Name1"), HasSubstr("/people/w1/curves"), HasSubstr("+45.0")));
    EXPECT_THAT(teacher.get("/people/w1/curves")->body, AllOf(HasSubstr("<svg"), HasSubstr("50.0"), HasSubstr("95.0")));
    const auto csv = teacher.get("/classes/c1/export/attempts.csv");
    EXPECT_EQ(csv->get_header_value("Content-Type"), "text/csv; charset=utf-8");
    EXPECT_EQ(std::count(csv->body.begin(), csv->body.end(), '\n'), 8) << "a head and seven attempts";
    EXPECT_THAT(csv->body,
                AllOf(HasSubstr("w1,as1,block"), HasSubstr("proven"), HasSubstr(",95,"), Not(HasSubstr("Name"))));
    const std::string criteria = teacher.get("/classes/c1/export/criteria.csv")->body;
    EXPECT_EQ(std::count(criteria.begin(), criteria.end(), '\n'), 1 + 7 * 2);
    EXPECT_THAT(teacher.get("/classes/c1/export/results.zip")->body, testing::StartsWith("PK"));
    EXPECT_THAT(teacher.get("/classes/c1/export/report")->body,
                AllOf(HasSubstr("Learning curves"), Not(HasSubstr("Name1"))));
    const std::string statements =
        teacher.get("/classes/c1/export/statements.json?home=https%3A%2F%2Fschool.example")->body;
    EXPECT_THAT(statements,
                AllOf(HasSubstr("https://school.example"), HasSubstr("\"name\": \"w3\""), Not(HasSubstr("Name"))));
    EXPECT_EQ(std::count(statements.begin(), statements.end(), '\n') > 50, true);
    EXPECT_EQ(teacher.get("/classes/c1/export/statements.json?home=nonsense")->status, 422);
    // A student has their own and nobody else's; others of the school nothing.
    Browser student(school.address());
    ASSERT_EQ(student.logIn("w1"), 303);
    const std::string own = student.get("/people/w1/export/attempts.csv")->body;
    EXPECT_EQ(std::count(own.begin(), own.end(), '\n'), 3);
    EXPECT_EQ(student.get("/people/w2/export/attempts.csv")->status, 403);
    EXPECT_EQ(student.get("/people/w2/curves")->status, 403);
    EXPECT_EQ(student.get("/classes/c1/export/attempts.csv")->status, 403);
    Browser examiner(school.address());
    ASSERT_EQ(examiner.logIn("e1"), 303);
    EXPECT_EQ(examiner.get("/classes/c1/results")->status, 403);
    EXPECT_EQ(examiner.get("/people/w1/curves")->status, 403) << "an examiner does not learn whose work it is";
    Browser stranger(school.address());
    ASSERT_EQ(stranger.logIn("t2"), 303);
    EXPECT_EQ(stranger.get("/classes/c1/export/results.zip")->status, 403);
}

TEST_F(TeachingTest, StandardsAreSetByJudgesAndByImpressionsAndKept) {
    School school(data());
    Browser teacher(school.address()), examiner(school.address());
    ASSERT_EQ(teacher.logIn("t1"), 303);
    ASSERT_EQ(examiner.logIn("e1"), 303);
    const std::string path = "/assignments/as1/standard";
    EXPECT_EQ(teacher.send(path, {{"do", "keep"}, {"method", "angoff"}})->status, 422) << "nobody has judged";
    const auto wrong =
        examiner.send(path, {{"do", "estimate"}, {"round", "1"}, {"e.removed", "101"}, {"e.amount", "40"}});
    EXPECT_EQ(wrong->status, 422);
    EXPECT_THAT(wrong->body,
                AllOf(HasSubstr("Give 0 to 100 %"), HasSubstr("value=\"101\""), HasSubstr("value=\"40\"")));
    EXPECT_EQ(
        examiner.send(path, {{"do", "estimate"}, {"round", "2"}, {"e.removed", "50"}, {"e.amount", "40"}})->status, 422)
        << "the first round first";
    EXPECT_EQ(
        examiner.send(path, {{"do", "estimate"}, {"round", "1"}, {"e.removed", "50"}, {"e.amount", "80"}})->status,
        303);
    // The teacher judges alone first.
    EXPECT_THAT(teacher.get(path)->body, AllOf(HasSubstr("once you have given yours"), Not(HasSubstr("62.0"))));
    EXPECT_EQ(teacher.send(path, {{"do", "estimate"}, {"round", "1"}, {"e.removed", "60"}, {"e.amount", "40"}})->status,
              303);
    // 62 and 52 of 100: by hand, in standard_test.
    EXPECT_THAT(teacher.get(path)->body, AllOf(HasSubstr("57.0 %"), HasSubstr("7.1 %"), HasSubstr("Round 2")));
    EXPECT_EQ(examiner.send(path, {{"do", "keep"}, {"method", "angoff"}})->status, 403);
    EXPECT_EQ(teacher.send(path, {{"do", "keep"}, {"method", "angoff"}})->status, 303);
    EXPECT_THAT(teacher.get("/assignments/as1")->body, AllOf(HasSubstr("60 %"), HasSubstr("57.0 % (")));
    // Impressions that go with the scores: 5 to 9 points have 1 to 5.
    EXPECT_EQ(teacher.send(path, {{"do", "keep"}, {"method", "borderline"}})->status, 422);
    EXPECT_EQ(examiner.send("/assignments/as1/marking", {})->status, 303);
    Books open = books();
    school::Teaching teaching(open);
    std::map<std::string, double> points;
    for (const school::Score& score : teaching.scores("as1"))
        points[score.attempt] = score.score;
    std::vector<std::string> codes = codesOn(examiner);
    for (const std::string& code : codes) {
        EXPECT_EQ(examiner.send("/assignments/as1/marking/" + code, {{"m.removed", "1"}, {"do", "keep"}})->status, 200);
        const std::string attempt = teaching.sheet("as1", "e1", code)->attempt;
        const int rating = std::clamp(static_cast<int>(points.at(attempt)) - 4, 1, 5);
        EXPECT_EQ(
            examiner
                .send("/assignments/as1/marking/" + code, sheetOf("5", "good", "yes", std::to_string(rating).c_str()))
                ->status,
            303);
    }
    EXPECT_THAT(teacher.get(path)->body,
                AllOf(HasSubstr("6 works: score against"), HasSubstr("<svg"), HasSubstr("seed 20261126")));
    EXPECT_EQ(teacher.send(path, {{"do", "keep"}, {"method", "borderline"}})->status, 303);
    ASSERT_THAT(teaching.standards("as1"), SizeIs(2));
    EXPECT_THAT(teaching.standards("as1")[1].content,
                AllOf(HasSubstr("\"cut_percent\""), HasSubstr("\"seed\":20261126")));
    Browser student(school.address());
    ASSERT_EQ(student.logIn("w1"), 303);
    EXPECT_EQ(student.get(path)->status, 403);
}

TEST_F(TeachingTest, ANewMarkerMarksExemplarsFirst) {
    School school(data());
    Browser teacher(school.address()), examiner(school.address());
    ASSERT_EQ(teacher.logIn("t1"), 303);
    ASSERT_EQ(examiner.logIn("e1"), 303);
    httplib::Params consensus = sheetOf("5", "good", "yes", "4");
    consensus.erase("do");
    consensus.emplace("do", "set");
    for (const std::size_t i : {std::size_t{0}, std::size_t{1}, std::size_t{2}}) {
        const std::string path = "/attempts/" + attempts_[i] + "/exemplar";
        EXPECT_EQ(examiner.get(path)->status, 403);
        EXPECT_EQ(examiner.send(path, consensus)->status, 403);
        EXPECT_EQ(teacher.send(path, {{"m.removed", "9"}, {"do", "set"}})->status, 422);
        EXPECT_EQ(teacher.send(path, consensus)->status, 303);
    }
    EXPECT_THAT(examiner.get("/assignments/as1/marking")->body,
                AllOf(HasSubstr("3 exemplars come first"), Not(HasSubstr("Begin with"))));
    EXPECT_EQ(examiner.send("/assignments/as1/marking", {})->get_header_value("Location"),
              "/assignments/as1/exemplars");
    EXPECT_FALSE(school::Teaching(*std::make_unique<Books>(data(), databaseOf(data()))).desk("as1", "e1"));
    const std::string first = "/assignments/as1/exemplars/1";
    EXPECT_THAT(examiner.get(first)->body, Not(HasSubstr(attempts_[0])));
    EXPECT_EQ(examiner.send(first, {{"m.removed", "x"}})->status, 422);
    EXPECT_EQ(examiner.send(first, sheetOf("4", "poor", "yes", "3"))->status, 303);
    EXPECT_THAT(examiner.get(first)->body,
                AllOf(HasSubstr("Your marks and the consensus"), HasSubstr(">-1<"), HasSubstr("another")));
    EXPECT_EQ(examiner.send(first, sheetOf("5", "good", "yes", "4"))->status, 303);
    EXPECT_THAT(examiner.get(first)->body, HasSubstr(">-1<")) << "the first marks count";
    EXPECT_EQ(examiner.send("/assignments/as1/exemplars/2", sheetOf("5", "good", "yes", "4"))->status, 303);
    EXPECT_EQ(examiner.send("/assignments/as1/exemplars/3", sheetOf("5", "good", "yes", "4"))->status, 303);
    EXPECT_EQ(examiner.get("/assignments/as1/exemplars/4")->status, 403);
    EXPECT_EQ(examiner.get("/assignments/as1/exemplars/999")->status, 403);
    // Points: -1, 0, 0 of three.
    EXPECT_THAT(examiner.get("/assignments/as1/exemplars")->body,
                AllOf(HasSubstr("Agreement with the consensus"), HasSubstr("-0.33")));
    EXPECT_THAT(examiner.get("/assignments/as1/marking")->body, HasSubstr("Begin with 3 works"));
    EXPECT_EQ(examiner.send("/assignments/as1/marking", {})->status, 303);
    EXPECT_THAT(codesOn(examiner), SizeIs(4)) << "three works, one of them twice; no exemplar among them";
    EXPECT_EQ(teacher.send("/attempts/" + attempts_[0] + "/exemplar", {{"do", "remove"}})->status, 303);
    EXPECT_THAT(school::Teaching(*std::make_unique<Books>(data(), databaseOf(data()))).exemplars("as1"), SizeIs(2));
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
}  // namespace handpiece::school_server::teaching_test
