// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/statements/statements.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <time.h>

#include <cstdlib>
#include <fstream>
#include <limits>
#include <regex>
#include <set>

#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::statements::statements_test {
namespace {

using testing::HasSubstr;
using testing::Not;

const Actor kActor{"https://school.example/", "s017"};

Work work() {
    Work w;
    school::Attempt& a = w.attempt;
    a.id = "0123456789abcdeffedcba9876543210";
    a.exercise = "33-class-v", a.exerciseHash = "00112233aabbccdd", a.rubricHash = "1122334455667788";
    a.sessionHashes = {"a0a0a0a0a0a0a0a0", "b0b0b0b0b0b0b0b0"};
    a.began = 1'795'000'000'000, a.finished = 1'795'000'754'321;
    a.device = "simulated";
    a.score = 81.5, a.maxScore = 90.0, a.wholeScore = 100.0, a.passed = "yes";
    a.workedS = 612.25;
    w.title = "Class \"V\"";
    return w;
}
std::string one(const Work& w) {
    return statementsOf(std::vector<Work>{w}, kActor);
}

TEST(Statements, TellAnAttempt) {
    const std::string text = one(work());
    for (const char* part :
         {"\"id\": \"01234567-89ab-4def-bedc-ba9876543210\"", "\"http://adlnet.gov/expapi/verbs/completed\"",
          "\"homePage\": \"https://school.example/\"", "\"name\": \"s017\"", "\"raw\": 81.5", "\"max\": 90.0",
          "\"success\": true", "\"duration\": \"PT612.25S\"", "\"timestamp\": \"2026-11-18T11:19:14.321Z\"",
          "\"https://school.example/handpiece/exercises/33-class-v/00112233aabbccdd/rubrics/1122334455667788\"",
          "\"und\": \"Class \\\"V\\\"\"", "\"https://school.example/handpiece/terms/whole\": false",
          "\"b0b0b0b0b0b0b0b0\"", "\"version\": \"1.0.3\""})
        EXPECT_THAT(text, HasSubstr(part));
    EXPECT_EQ(text, one(work()));
    EXPECT_EQ(statementsOf({}, kActor), "[]\n");
}

TEST(Statements, SayOfNobodyThatTheyFailedBeforeATeacherDoes) {
    for (const char* passed : {"no", "teacher"}) {
        Work w = work();
        w.attempt.passed = passed;
        EXPECT_THAT(one(w), Not(HasSubstr("success")));
        w.returned.push_back({w.attempt.id, "Dr. Ito", R"({"score": 40, "max_score": 90, "passed": "no"})", 1});
        const std::string marked = one(w);
        EXPECT_THAT(marked, HasSubstr("\"success\": false"));
        EXPECT_THAT(marked, HasSubstr("http://adlnet.gov/expapi/verbs/scored"));
        EXPECT_THAT(marked, HasSubstr("\"raw\": 40.0"));
    }
}

TEST(Statements, LeaveOutAScoreThatCannotBeOne) {
    Work w = work();
    for (const double most :
         {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        w.attempt.maxScore = most;
        EXPECT_THAT(one(w), Not(HasSubstr("scaled"))) << most;
    }
    w = work();
    w.attempt.score = 95.0;  // more than the most: damaged
    EXPECT_THAT(one(w), HasSubstr("\"scaled\": 1.0"));
    w.title = "\xff broken";
    EXPECT_THAT(one(w), HasSubstr("\xef\xbf\xbd broken"));
}

TEST(Statements, HaveIdsOfTheirOwn) {
    const std::regex uuid("\"id\": \"[0-9a-f]{8}-[0-9a-f]{4}-4[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}\"");
    std::vector<Work> works;
    for (int i = 0; i < 200; ++i) {
        works.push_back(work());
        works.back().attempt.id = school::newId();
        for (const char* marker : {"a", "b"})
            works.back().returned.push_back(
                {works.back().attempt.id, marker, R"({"score": 1, "max_score": 2, "passed": "yes"})", 5});
    }
    // Marks that have changed are another statement.
    works.front().returned.push_back(
        {works.front().attempt.id, "a", R"({"score": 2, "max_score": 2, "passed": "yes"})", 6});
    const std::string text = statementsOf(works, kActor);
    std::set<std::string> ids;
    for (std::sregex_iterator at(text.begin(), text.end(), uuid), end; at != end; ++at)
        EXPECT_TRUE(ids.insert(at->str()).second);
    EXPECT_EQ(ids.size(), 601u);
}

/// tests/school/xapi/check.cjs reads what this leaves.
TEST(Statements, AreLeftForAValidator) {
    const char* file = std::getenv("HANDPIECE_STATEMENTS");
    if (file == nullptr) GTEST_SKIP() << "no HANDPIECE_STATEMENTS=FILE to write to";
    std::mt19937_64 random(test::seed(2));
    std::vector<Work> works;
    for (int i = 0; i < 300; ++i) {
        Work w = work();
        w.attempt.id = school::newId();
        w.attempt.maxScore = test::uniform(random, -10.0, 100.0);
        w.attempt.score = test::uniform(random, -5.0, 110.0);
        w.attempt.passed = std::vector<std::string>{"yes", "no", "teacher"}[random() % 3];
        w.attempt.workedS = test::uniform(random, -10.0, 4000.0);
        w.attempt.finished = static_cast<school::Milliseconds>(test::uniform(random, 0.0, 4e12));
        if (random() % 2) w.attempt.rubricHash.clear(), w.title.clear();
        if (random() % 2)
            w.returned.push_back({w.attempt.id, "m", R"({"score": 3, "max_score": 7.5, "passed": "no"})", 1000 * i});
        works.push_back(std::move(w));
    }
    std::ofstream(file) << statementsOf(works, kActor);
}

TEST(Statements, DatesAreThoseOfTheSystem) {
    std::mt19937_64 random(test::seed(1));
    for (int i = 0; i < 20000; ++i) {
        const auto at = static_cast<school::Milliseconds>(test::uniform(random, 0.0, 4.1e12));
        const time_t seconds = at / 1000;
        struct tm parts {};
        ASSERT_NE(gmtime_r(&seconds, &parts), nullptr);
        char text[64];
        strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &parts);
        char whole[80];
        std::snprintf(whole, sizeof whole, "%s.%03dZ", text, static_cast<int>(at % 1000));
        ASSERT_EQ(timestamp(at), whole);
    }
    EXPECT_EQ(timestamp(951'782'400'000), "2000-02-29T00:00:00.000Z");
    EXPECT_EQ(timestamp(-5), "1970-01-01T00:00:00.000Z");
}

TEST(Statements, RefuseWhatCannotBe) {
    const auto refused = [](const Actor& actor, const Work& w = work()) {
        return test::errorOf([&] { (void)statementsOf(std::vector<Work>{w}, actor); });
    };
    for (const char* page : {"", "school.example", "ftp://school.example", "https://", "https://a b", "https://a\"b"})
        EXPECT_THAT(refused({page, "s017"}), HasSubstr("--home-page")) << page;
    for (const std::string& code : {std::string(), std::string("a\nb"), std::string(201, 'x'), std::string("a@b.c")})
        EXPECT_THAT(refused({"https://school.example", code}), HasSubstr("--person")) << code;
    for (const char* id : {"", "0123", "0123456789abcdeffedcba987654321x", "0123456789abcdeffedcba98765432100"}) {
        Work w = work();
        w.attempt.id = id;
        EXPECT_THAT(refused(kActor, w), HasSubstr("its id is none")) << id;
    }
    for (const char* marks : {"", "[]", "{", "{}", R"({"score": "x", "max_score": 2})", R"({"score": 1})",
                              R"({"score": 1, "max_score": 2, "passed": 7})"}) {
        Work w = work();
        w.returned.push_back({w.attempt.id, "m", marks, 1});
        EXPECT_THAT(refused(kActor, w), HasSubstr("marks of attempt")) << marks;
    }
}

}  // namespace
}  // namespace handpiece::statements::statements_test
