// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A school with a class, two markers, an assignment and scored work of its students.

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/school/people/secret.h"
#include "handpiece/school/store/teaching.h"
#include "school/server/browser.h"

namespace handpiece::school_server {

inline constexpr const char* kMarkedRubric = R"(format = 1
id = "block-marked"
version = "1"
title = { en = "Block, marked" }
status = "proposal"
source = "a test"
pass_mark = 60
[[band]]
id = "good"
title = { en = "Good" }
[[band]]
id = "poor"
title = { en = "Poor" }
[[criterion]]
id = "removed"
measure = "removed"
unit = "mm3"
weight = 6
knots = [[0, 0], [0.5, 100], [9, 100]]
title = { en = "Removed" }
source = "a test"
[[criterion]]
id = "amount"
measure = "removed"
unit = "mm3"
weight = 4
bands = [{ id = "good", from = 0.5, points = 100 }, { id = "poor", to = 0.5, points = 25 }]
title = { en = "Amount" }
source = "a test"
)";

class TeachingTest : public SchoolTest {
  protected:
    static constexpr std::size_t kStudents = 6;
    void SetUp() override {
        SchoolTest::SetUp();
        Books open = books();
        const Act act{"server", 1};
        const std::string hash = school::hashOfPassword(kPassword);
        const auto person = [&](std::string code, const char* name, const char* role) {
            return school::Person{code, name, code, "", hash, {role}, 1, 0};
        };
        std::vector<school::Person> people{person("t1", "Dr. Sato", "teacher"), person("t2", "Dr. Other", "teacher"),
                                           person("e1", "Dr. Exa", "examiner"), person("a1", "Admin", "administrator")};
        std::vector<school::Enrolment> enrolments{
            {"c1", "t1", "teacher"}, {"c1", "e1", "examiner"}, {"c2", "t2", "teacher"}};
        for (std::size_t i = 0; i < kStudents; ++i) {
            people.push_back(person(fmt::format("w{}", i), fmt::format("Name{}", i).c_str(), "student"));
            enrolments.push_back({"c1", people.back().code, "student"});
        }
        open.add(people, act);
        open.add(school::SchoolClass{"c1", "Operative <1>", "", 0, 1, 0}, act);
        open.add(school::SchoolClass{"c2", "Others", "", 0, 1, 0}, act);
        open.enrol(enrolments, act);
        const rubric::Rubric marked = rubric::parseRubric(kMarkedRubric, "rubric.toml");
        rubric::requireSound(marked);
        marked_ = rubric::hashText(rubric::hashOf(marked));
        exercise_ = rubric::hashText(tasks::contentHash(blockTask()));
        open.add(school::RubricVersion{marked_, marked.id, kMarkedRubric, 1, 1}, act);
        open.add(
            school::Assignment{"as1", "c1", exercise_, marked_, "Block & hole", "practice", "", 1, 4'000'000'000'000},
            act);
        EXPECT_TRUE(open.enrolStation(kCode, station_, std::string(64, 'd'), 2));
        const std::vector<std::byte> bytes = core::readFile(session());
        (void)open.append({station_, school::sha256Of(session()), bytes.size()}, 0, bytes, 3);
        // The first is real work; of the others the server's score is made up here, each by the rubric.
        attempts_.push_back(push(open, 0, true));
        static std::optional<sandboxed::Proof> proof;
        scoreAll(data(), proof);
        const std::vector<school::Score> scores = open.scoresOf(attempts_.front());
        EXPECT_EQ(scores.size(), 1u);
        real_ = scores.back();
        EXPECT_EQ(real_.state, "proven") << real_.reason;
        for (std::size_t i = 1; i < kStudents; ++i) {
            attempts_.push_back(push(open, i, false));
            finish(open, 4.0 + static_cast<double>(i));
        }
    }
    std::string push(Books& open, std::size_t student, bool isReal, school::Milliseconds finished = 5000) {
        school::PushedAttempt p;
        school::Attempt& a = p.attempt;
        a.id = school::newId();
        a.exercise = "block", a.exerciseHash = exercise_, a.rubricHash = marked_;
        a.began = 1000, a.finished = finished, a.device = "simulated";
        a.score = 10, a.maxScore = 10, a.wholeScore = 10, a.passed = "yes", a.result = "{}";
        if (isReal) a.sessionHashes = {assessment::workHash(session())}, p.files = {school::sha256Of(session())};
        p.station = station_, p.person = fmt::format("w{}", student), p.assignment = "as1", p.received = 10;
        EXPECT_TRUE(open.push(p));
        return a.id;
    }
    /// The job that waits, with so many of ten points.
    void finish(Books& open, double points) {
        const auto job = open.takeJob("w", 20, 1000);
        ASSERT_TRUE(job);
        school::Score score = real_;
        score.attempt = job->attempt, score.rubric = job->rubric, score.score = points, score.made = 21;
        score.passed = points >= 6.0 ? "yes" : "no";
        score::Result result = assessment::parseResult(real_.result, "a test");
        result.assessment.score = points;
        result.assessment.passed = points >= 6.0 ? score::Passed::yes : score::Passed::no;
        score.result = assessment::resultJson(result.assessment, result.identity);
        EXPECT_TRUE(open.finish(*job, score));
    }
    /// Codes of a marker's desk, in their order.
    static std::vector<std::string> codesOn(Browser& browser) {
        const std::string page = browser.get("/assignments/as1/marking")->body;
        std::vector<std::string> codes;
        const std::regex link("/assignments/as1/marking/([0-9a-z]{4})\"");
        for (auto it = std::sregex_iterator(page.begin(), page.end(), link); it != std::sregex_iterator(); ++it)
            codes.push_back((*it)[1]);
        return codes;
    }
    std::string station_ = std::string(32, 'c'), marked_, exercise_;
    std::vector<std::string> attempts_;
    school::Score real_;
};

}  // namespace handpiece::school_server
