// SPDX-License-Identifier: Apache-2.0
// What each person sees of a school in a browser, and what not.
#include "handpiece/school/store/lti_books.h"
#include "school/routes.h"
#include "school/server/pages_fixture.h"

namespace handpiece::school_server::pages_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

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
    Books open = books();
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

TEST_F(PagesTest, TheLogInPageLeadsToWhatTheSchoolHasBesidesPasswords) {
    const auto page = [&](const School::Odd& odd) {
        const School school(data(), odd);
        return httplib::Client(school.address()).Get("/login")->body;
    };
    School::Odd odd;
    odd.database = databaseOf(data());
    EXPECT_THAT(page(odd), AllOf(Not(HasSubstr("/sign-on")), Not(HasSubstr("learning platform"))));
    odd.address = "https://school.example";
    EXPECT_THAT(page(odd), Not(HasSubstr("learning platform"))) << "no platform is known yet";
    {
        Books open = books();
        school::LtiPlatform platform;
        platform.issuer = "https://platform.example", platform.client = "c";
        platform.authAddress = platform.issuer + "/login", platform.tokenAddress = platform.issuer + "/token";
        platform.keysAddress = platform.issuer + "/keys", platform.deployments = {"1"};
        (void)school::LtiBooks(open).set(platform, {"server", 1});
    }
    EXPECT_THAT(page(odd), HasSubstr("From a learning platform"));
    odd.signOn = {{"127.0.0.1"}, "X-Handpiece-User", std::string(32, 's')};
    EXPECT_THAT(page(odd), HasSubstr("href=\"/sign-on\""));
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

TEST_F(PagesTest, AClassBehindOneAddressIsNotLockedOutAndNoOwnLogInForgivesGuesses) {
    School school(data());
    int wrong = 0;
    // Each at another login: after every tenth the guesser logs in as themselves, which was to forget it all.
    for (int status = 401; status == 401 && wrong < 100;) {
        Browser browser(school.address());
        status = browser.logIn(fmt::format("somebody{}", wrong).c_str(), "wrong password");
        if (status == 401 && ++wrong % 10 == 0) {
            EXPECT_EQ(Browser(school.address()).logIn("t1"), wrong < 60 ? 303 : 429);
        }
    }
    EXPECT_EQ(wrong, school::kFreeOfAddress);
}

TEST_F(PagesTest, OnlyAProxyOfOursSaysWhoAsks) {
    const auto client = [](const std::vector<std::string>& proxies, const std::vector<std::string>& said) {
        httplib::Request request;
        request.remote_addr = "10.0.0.1";
        for (const std::string& one : said)
            request.headers.emplace("X-Forwarded-For", one);
        Settings settings;
        settings.proxies = proxies;
        return clientOf(request, settings);
    };
    EXPECT_EQ(client({}, {"1.2.3.4"}), "10.0.0.1");
    EXPECT_EQ(client({"10.0.0.2"}, {"1.2.3.4"}), "10.0.0.1");
    EXPECT_EQ(client({"10.0.0.1"}, {}), "10.0.0.1");
    EXPECT_EQ(client({"10.0.0.1"}, {"1.2.3.4"}), "1.2.3.4");
    EXPECT_EQ(client({"10.0.0.1"}, {"6.6.6.6, 1.2.3.4"}), "1.2.3.4") << "what stands before anybody may have written";
    EXPECT_EQ(client({"10.0.0.1", "10.0.0.2"}, {"6.6.6.6,2001:db8::7 , 10.0.0.2"}), "2001:db8::7");
    for (const char* nonsense : {"unknown", "", "1.2.3.4 or so", "<script>"})
        EXPECT_EQ(client({"10.0.0.1"}, {nonsense}), "10.0.0.1") << nonsense;
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
    books().erase("s018", {"server", 5});
    EXPECT_EQ(student.get("/classes")->get_header_value("Location"), "/login");
    for (const char* header : {"Content-Security-Policy", "X-Content-Type-Options", "Referrer-Policy", "Cache-Control"})
        EXPECT_NE(http.Get("/login")->get_header_value(header), "") << header;
    EXPECT_THAT(http.Get("/login")->get_header_value("Content-Security-Policy"), HasSubstr("form-action 'self'"));
}

}  // namespace
}  // namespace handpiece::school_server::pages_test
