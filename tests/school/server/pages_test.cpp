// SPDX-License-Identifier: Apache-2.0
// What each person sees of a school in a browser, and what not.
#include <regex>

#include "handpiece/school/people/secret.h"
#include "school/server/browser.h"
#include "school/worker.h"

namespace handpiece::school_server {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class PagesTest : public SchoolTest {
  protected:
    void SetUp() override {
        SchoolTest::SetUp();
        Books open(data());
        const Act act{"server", 1};
        const std::string hash = school::hashOfPassword(kPassword);
        const auto person = [&](const char* code, const char* name, const char* role) {
            return school::Person{code, name, code, "", hash, {role}, 1, 0};
        };
        const std::vector<school::Person> people{
            person("t1", "Dr. Sato", "teacher"), person("t2", "Dr. Other", "teacher"),
            person("e1", "Examiner", "examiner"), person("a1", "Admin", "administrator"),
            person("s018", "Jun <b>", "student")};
        open.add(people, act);
        open.setPassword("s017", hash, act);
        open.add(school::SchoolClass{"c1", "Operative <1>", "", 0, 1, 0}, act);
        open.add(school::SchoolClass{"c2", "Others", "", 0, 1, 0}, act);
        const std::vector<school::Enrolment> enrolments{{"c1", "s017", "student"},
                                                        {"c1", "s018", "student"},
                                                        {"c1", "t1", "teacher"},
                                                        {"c1", "e1", "examiner"},
                                                        {"c2", "t2", "teacher"}};
        open.enrol(enrolments, act);
        const std::string exercise = rubric::hashText(tasks::contentHash(blockTask()));
        const rubric::Rubric rubric = rubric::parseRubric(kRubric, "rubric.toml");
        open.add(school::Assignment{"as1", "c1", exercise, rubric::hashText(rubric::hashOf(rubric)), "Block & hole",
                                    "practice", "", 1, 4'000'000'000'000},
                 act);
        chair_ = std::make_unique<Chair>();
        assigned_ = push("as1", 0);
        practice_ = push("", 1);
        Worker worker({data()}, systemClock());
        while (worker.workOnce()) {
        }
    }
    std::string push(const std::string& assignment, int number) {
        school::PushedAttempt p;
        p.attempt = *chair_->store().attempt(chair_->finish(session(), fmt::format("{}.h5", number)));
        p.station = std::string(32, 'c'), p.person = "s017", p.assignment = assignment;
        p.files = {school::sha256Of(session())};
        p.received = 10;
        Books open(data());
        if (number == 0) {
            (void)open.enrolStation(kCode, p.station, std::string(64, 'd'), 2);
            const std::vector<std::byte> bytes = core::readFile(session());
            (void)open.append({p.station, p.files.front(), bytes.size()}, 0, bytes, 3);
        }
        EXPECT_TRUE(open.push(p));
        return p.attempt.id;
    }
    std::unique_ptr<Chair> chair_;
    std::string assigned_, practice_;
};

TEST_F(PagesTest, EachSeesWhatIsTheirs) {
    School school(data());
    const std::vector<std::string> pages{"/classes",
                                         "/classes/c1",
                                         "/classes/c2",
                                         "/people/s017",
                                         "/people/s018",
                                         "/attempts/" + assigned_,
                                         "/attempts/" + assigned_ + "/result",
                                         "/attempts/" + practice_,
                                         "/attempts/" + std::string(32, '0')};
    // 2: seen, 3: not theirs. Practice is its student's own.
    const std::map<std::string, std::string> expected{{"t1",
                                                       "2232"
                                                       "3"
                                                       "2233"},
                                                      {"t2", "232333333"},
                                                      {"e1",
                                                       "2332"
                                                       "3"
                                                       "2233"},
                                                      {"a1", "233333333"},
                                                      {"s017",
                                                       "2332"
                                                       "3"
                                                       "2223"},
                                                      {"s018",
                                                       "233"
                                                       "323333"}};
    for (const auto& [who, sees] : expected) {
        Browser browser(school.address());
        ASSERT_EQ(browser.logIn(who == "s017" ? "ida" : who), 303) << who;
        for (std::size_t i = 0; i < pages.size(); ++i) {
            const auto result = browser.get(pages[i]);
            ASSERT_TRUE(result);
            EXPECT_EQ(result->status, sees[i] == '2' ? 200 : 403) << who << " " << pages[i];
        }
    }
    // Nobody, or with a token of their own making.
    for (const std::string& cookie :
         {std::string(), std::string(64, 'a'), std::string("' OR 1=1"), std::string(5000, 'x')}) {
        httplib::Client http(school.address());
        for (const Route& route : Server::routes()) {
            if (route.caller != Caller::person) continue;
            const std::string path = pathOf(route.pattern);
            const httplib::Headers headers{{"Cookie", "other=1; handpiece=" + cookie}};
            const auto result =
                route.method == "GET" ? http.Get(path, headers) : http.Post(path, headers, "", "text/plain");
            ASSERT_TRUE(result) << path;
            EXPECT_EQ(result->status, 303) << path;
            EXPECT_EQ(result->get_header_value("Location"), "/login") << path;
        }
    }
}

TEST_F(PagesTest, SayWhatTheServerFoundAndWhoseItIs) {
    School school(data());
    Browser teacher(school.address());
    ASSERT_EQ(teacher.logIn("t1"), 303);
    const std::string table = teacher.get("/classes/c1")->body;
    EXPECT_THAT(table, AllOf(HasSubstr("Operative &lt;1&gt;"), HasSubstr("Block &amp; hole"), HasSubstr("Ida"),
                             HasSubstr("Jun &lt;b&gt;"), HasSubstr("(proven)"), HasSubstr("/attempts/" + assigned_)));
    EXPECT_THAT(teacher.get("/attempts/" + assigned_)->body,
                AllOf(HasSubstr("proven"), HasSubstr("its station said 100 of 100")));
    EXPECT_THAT(teacher.get("/attempts/" + assigned_ + "/result")->body, HasSubstr("All criteria"));
    // An examiner is not told whose it is.
    Browser examiner(school.address());
    ASSERT_EQ(examiner.logIn("e1"), 303);
    EXPECT_THAT(examiner.get("/attempts/" + assigned_)->body, AllOf(Not(HasSubstr("Ida")), HasSubstr("s017")));
    // Practice that is shared is seen by the class's teacher.
    Books open(data());
    open.share(practice_, true, {"s017", 20});
    EXPECT_EQ(teacher.get("/attempts/" + practice_)->status, 200);
    Browser stranger(school.address());
    ASSERT_EQ(stranger.logIn("t2"), 303);
    EXPECT_EQ(stranger.get("/attempts/" + practice_)->status, 403);
    // Every look at another's work stands in the audit.
    std::size_t looks = 0;
    for (const school::AuditLine& line : open.audit(0, 1000, "s017"))
        looks += line.what == "attempt seen" || line.what == "result seen" ? 1 : 0;
    EXPECT_EQ(looks, 4u);
}

TEST_F(PagesTest, PasswordsCannotBeGuessedAtSpeed) {
    School school(data());
    Browser browser(school.address());
    int tried = 0;
    while (browser.logIn("t1", "wrong password") == 401)
        ++tried;
    EXPECT_EQ(tried, 5);
    EXPECT_EQ(browser.logIn("t1"), 429) << "the right one waits too";
    EXPECT_THAT(browser.post("/login", httplib::Params{{"login", "t1"}, {"password", "x"}})->body,
                HasSubstr("Try again in"));
    EXPECT_TRUE(browser.cookie().empty());
}

TEST_F(PagesTest, ALogInEnds) {
    School school(data());
    Browser browser(school.address());
    ASSERT_EQ(browser.logIn("t1"), 303);
    const std::string old = browser.cookie();
    // From another page than one of this log-in: nothing happens.
    EXPECT_EQ(browser.post("/logout", httplib::Params{{"token", "guess"}})->status, 403);
    EXPECT_EQ(browser.get("/classes")->status, 200);
    const std::string page = browser.get("/classes")->body;
    std::smatch token;
    ASSERT_TRUE(std::regex_search(page, token, std::regex("name=\"token\" value=\"([0-9a-f]+)\"")));
    EXPECT_EQ(browser.post("/logout", httplib::Params{{"token", token[1].str()}})->status, 303);
    httplib::Client http(school.address());
    EXPECT_EQ(http.Get("/classes", {{"Cookie", "handpiece=" + old}})->status, 303);
    // Whoever is erased is nobody from then on.
    Browser student(school.address());
    ASSERT_EQ(student.logIn("s018"), 303);
    Books(data()).erase("s018", {"server", 5});
    EXPECT_EQ(student.get("/classes")->get_header_value("Location"), "/login");
    for (const char* header : {"Content-Security-Policy", "X-Content-Type-Options", "Referrer-Policy", "Cache-Control"})
        EXPECT_NE(http.Get("/login")->get_header_value(header), "") << header;
    EXPECT_THAT(http.Get("/login")->get_header_value("Content-Security-Policy"), HasSubstr("form-action 'self'"));
}

}  // namespace
}  // namespace handpiece::school_server
