// SPDX-License-Identifier: Apache-2.0
// What an administrator does in a browser.
#include "handpiece/model/case/package.h"
#include "handpiece/school/store/books_accounts.h"
#include "school/server/pages_fixture.h"

namespace handpiece::school_server::office_test {
namespace {

using school::BooksAccounts;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class OfficeTest : public PagesTest {
  protected:
    void SetUp() override {
        PagesTest::SetUp();
        school_ = std::make_unique<School>(data());
        browser_ = std::make_unique<Browser>(school_->address());
        ASSERT_EQ(browser_->logIn("a1"), 303);
    }
    std::string page(const std::string& path) {
        const auto result = browser_->get(path);
        EXPECT_EQ(result->status, 200) << path;
        return result->body;
    }
    /// A form of a page of this log-in.
    httplib::Result send(const std::string& path, httplib::Params form) {
        form.emplace("token", school::requestTokenOf(browser_->cookie()));
        return browser_->post(path, form);
    }
    httplib::Result upload(const std::string& name, const std::string& bytes, const std::string& what) {
        httplib::Client http(school_->address());
        const httplib::MultipartFormDataItems items{{"token", school::requestTokenOf(browser_->cookie()), "", ""},
                                                    {"file", bytes, name, "text/csv"},
                                                    {"do", what, "", ""}};
        return http.Post("/office/people/import", {{"Cookie", "handpiece=" + browser_->cookie()}}, items);
    }
    static std::string found(const std::string& text, const std::string& pattern) {
        std::smatch match;
        return std::regex_search(text, match, std::regex(pattern)) ? match[1].str() : std::string();
    }
    std::unique_ptr<School> school_;
    std::unique_ptr<Browser> browser_;
};

TEST_F(OfficeTest, AddsAPersonWhoSetsTheirOwnPasswordByACodeThatIsShownOnce) {
    EXPECT_EQ(
        send("/office/people", {{"code", "s020"}, {"name", "Kei <i>"}, {"login", "kei"}, {"role", "student"}})->status,
        303);
    EXPECT_THAT(page("/office/people"), AllOf(HasSubstr("Kei &lt;i&gt;"), HasSubstr("no password yet")));
    EXPECT_THAT(send("/office/people", {{"code", "s020"}, {"role", "student"}})->body,
                HasSubstr("there is a person 's020' already"));
    EXPECT_THAT(send("/office/people", {{"code", "no blanks"}, {"role", "student"}})->body,
                HasSubstr("Nothing was changed"));
    EXPECT_THAT(page("/office/people?find=KEI"), AllOf(HasSubstr("s020"), Not(HasSubstr("Dr. Sato"))));
    const std::string shown = send("/office/people/s020/code", {})->body;
    const std::string code = found(shown, "code ([0-9A-Z]{3}-[0-9A-Z]{3}-[0-9A-Z]{3}-[0-9A-Z]{3})");
    ASSERT_FALSE(code.empty()) << shown;
    EXPECT_THAT(page("/office/people/s020"), Not(HasSubstr(code)));
    Browser kei(school_->address());
    const std::string password = "correct horse battery";
    const auto set = [&](const std::string& with, const std::string& one, const std::string& two) {
        return kei.post("/first", httplib::Params{{"login", "kei"}, {"code", with}, {"new", one}, {"again", two}});
    };
    EXPECT_THAT(set(code, password, "another one that is long")->body, HasSubstr("not the same"));
    EXPECT_THAT(set(code, "short", "short")->body, HasSubstr("fewer than 10"));
    EXPECT_EQ(set("AAA-AAA-AAA-AAA", password, password)->status, 401);
    std::string typed = code;
    std::transform(typed.begin(), typed.end(), typed.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    EXPECT_EQ(set(typed, password, password)->status, 200) << "as people type it";
    EXPECT_EQ(set(code, password, password)->status, 401) << "once";
    EXPECT_EQ(kei.logIn("kei", password), 303);
    // And changes it by themselves; that ends the log-in.
    httplib::Params form{{"token", school::requestTokenOf(kei.cookie())},
                         {"old", "wrong"},
                         {"new", "a whole new one"},
                         {"again", "a whole new one"}};
    EXPECT_EQ(kei.post("/account", form)->status, 400);
    form.erase("old"), form.emplace("old", password);
    EXPECT_EQ(kei.post("/account", form)->status, 303);
    EXPECT_EQ(kei.get("/account")->status, 303);
    EXPECT_EQ(kei.logIn("kei", "a whole new one"), 303);
}

TEST_F(OfficeTest, ACodeIsGuessedNoFasterThanAPassword) {
    books().rename("s018", "Jun", "jun", {"server", 2});
    int tried = 0;
    Browser stranger(school_->address());
    while (stranger
               .post("/first", httplib::Params{{"login", "jun"},
                                               {"code", "AAA-AAA-AAA-AAA"},
                                               {"new", "long enough, this"},
                                               {"again", "long enough, this"}})
               ->status == 401)
        ++tried;
    EXPECT_EQ(tried, 5);
}

TEST_F(OfficeTest, ChangesAnAccountAndNeverOnesOwnRights) {
    EXPECT_EQ(send("/office/people/t1/name", {{"name", "Dr. Sato-Ito"}, {"login", "sato"}})->status, 303);
    EXPECT_EQ(books().person("t1")->login, "sato");
    EXPECT_THAT(send("/office/people/t2/name", {{"name", "x"}, {"login", "sato"}})->body,
                HasSubstr("there is a login"));
    EXPECT_EQ(send("/office/people/t2/roles", {{"teacher", "on"}, {"examiner", "on"}})->status, 303);
    EXPECT_THAT(books().person("t2")->roles, testing::ElementsAre("examiner", "teacher"));
    EXPECT_THAT(send("/office/people/a1/roles", {{"teacher", "on"}})->body, HasSubstr("another administrator"));
    EXPECT_THAT(send("/office/people/a1/suspend", {})->body, HasSubstr("another administrator"));
    EXPECT_THAT(send("/office/people/a1/erase", {{"sure", "a1"}})->body, HasSubstr("another administrator"));
    Browser teacher(school_->address());
    ASSERT_EQ(teacher.logIn("t2"), 303);
    EXPECT_EQ(send("/office/people/t2/suspend", {})->status, 303);
    EXPECT_EQ(teacher.get("/classes")->status, 303) << "logged out at once";
    EXPECT_EQ(teacher.logIn("t2"), 403);
    EXPECT_EQ(teacher.logIn("t2", "wrong password"), 401) << "who guesses does not learn it";
    EXPECT_EQ(send("/office/people/t2/resume", {})->status, 303);
    EXPECT_EQ(teacher.logIn("t2"), 303);
    // Into a class and out of it.
    EXPECT_EQ(send("/office/people/t2/enrol", {{"class", "c1"}, {"role", "teacher"}})->status, 303);
    EXPECT_THAT(page("/office/people/t2"), AllOf(HasSubstr("Take out of Operative &lt;1&gt;"), HasSubstr("Others")));
    EXPECT_EQ(send("/office/people/t2/leave", {{"class", "c1"}})->status, 303);
    EXPECT_EQ(send("/office/people/t2/enrol", {{"class", "c1"}, {"role", "administrator"}})->status, 400);
    EXPECT_EQ(send("/office/people/t2/enrol", {{"class", "nowhere"}, {"role", "teacher"}})->status, 400);
    EXPECT_EQ(browser_->get("/office/people/nobody")->status, 403);
}

TEST_F(OfficeTest, OneClickGivesAllThatIsHeldAndOneErases) {
    const auto zip = browser_->get("/office/people/s017/export");
    ASSERT_EQ(zip->status, 200);
    EXPECT_EQ(zip->get_header_value("Content-Type"), "application/zip");
    EXPECT_THAT(zip->get_header_value("Content-Disposition"), HasSubstr("s017.zip"));
    const auto files = cases::readPackage(std::as_bytes(std::span(zip->body)), "s017.zip");
    const auto text = [&](const std::string& name) {
        const auto& bytes = files.at(name);
        return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    };
    EXPECT_THAT(text("tables/identities.csv"), HasSubstr("Ida"));
    EXPECT_THAT(text("tables/attempts.csv"), AllOf(HasSubstr(assigned_), HasSubstr(practice_)));
    EXPECT_THAT(text("tables/audit.csv"), HasSubstr("export"));
    EXPECT_THAT(text("READ-ME.txt"), HasSubstr("sessions/*.h5"));
    const std::string hash = school::sha256Of(session());
    EXPECT_EQ(files.at("sessions/" + hash + ".h5"), core::readFile(session())) << "their recordings, byte for byte";
    for (const auto& [name, bytes] : files)
        EXPECT_THAT(text(name), Not(HasSubstr("argon2id"))) << name;
    for (const auto& entry : fs::directory_iterator(data() / "uploads"))
        ADD_FAILURE() << entry.path() << " is left behind";
    // A name with which a spreadsheet would reckon.
    EXPECT_EQ(send("/office/people/s018/name", {{"name", "-cmd|x"}, {"login", "s018"}})->status, 303);
    const auto reckoned = browser_->get("/office/people/s018/export");
    const auto its = cases::readPackage(std::as_bytes(std::span(reckoned->body)), "s018.zip");
    const auto& identity = its.at("tables/identities.csv");
    EXPECT_THAT(std::string(reinterpret_cast<const char*>(identity.data()), identity.size()), HasSubstr(",'-cmd|x,"));
    // Each may have their own.
    Browser ida(school_->address());
    ASSERT_EQ(ida.logIn("ida"), 303);
    EXPECT_EQ(ida.get("/account/export")->body.substr(0, 2), "PK");
    EXPECT_EQ(ida.get("/office/people/s018/export")->status, 403);
    EXPECT_THAT(ida.get("/account")->body, HasSubstr("export")) << "and sees who looked";
    EXPECT_THAT(send("/office/people/s017/erase", {{"sure", "s018"}})->body, HasSubstr("not the code"));
    EXPECT_TRUE(books().personByLogin("ida"));
    EXPECT_EQ(send("/office/people/s017/erase", {{"sure", "s017"}})->status, 303);
    EXPECT_FALSE(books().personByLogin("ida"));
    EXPECT_EQ(ida.get("/account")->status, 303);
    EXPECT_THAT(page("/office/people/s017"), AllOf(HasSubstr("erased"), Not(HasSubstr("Ida"))));
}

TEST_F(OfficeTest, ImportsAListFirstToSeeAndThenToDo) {
    const std::string list =
        "\xef\xbb\xbf"
        "code;name;login;role;class\r\ns030;\"Abe; Kei\";abe;student;Operative <1>\r\n";
    const std::string before = school::asText(books().everything());
    const auto dry = upload("list.csv", list, "dry");
    EXPECT_EQ(dry->status, 200);
    EXPECT_THAT(dry->body, AllOf(HasSubstr("nothing was changed yet: 3"), HasSubstr("new: s030 Abe; Kei abe"),
                                 HasSubstr("Operative &lt;1&gt;, student")));
    EXPECT_EQ(school::asText(books().everything()), before);
    EXPECT_THAT(upload("list.csv", list, "it")->body, HasSubstr("Changed: 3"));
    EXPECT_THAT(upload("list.csv", list, "it")->body, HasSubstr("It changes nothing"));
    const auto wrong = upload("list.csv", "code,role\ns031,pupil\n", "it");
    EXPECT_EQ(wrong->status, 400);
    EXPECT_THAT(wrong->body, AllOf(HasSubstr("list.csv, line 2, column role"), HasSubstr("pupil")));
    EXPECT_EQ(upload("<b>.csv", "\x01\x02", "it")->status, 400);
    EXPECT_THAT(upload("<b>.csv", "\x01\x02", "it")->body, Not(HasSubstr("<b>")));
    httplib::Client http(school_->address());
    const httplib::MultipartFormDataItems forged{
        {"token", "guess", "", ""}, {"file", list, "list.csv", "text/csv"}, {"do", "it", "", ""}};
    EXPECT_EQ(http.Post("/office/people/import", {{"Cookie", "handpiece=" + browser_->cookie()}}, forged)->status, 403);
}

TEST_F(OfficeTest, KeepsClassesAndStations) {
    const auto made = send("/office/classes", {{"name", "Endodontics"}, {"retention", "400"}});
    ASSERT_EQ(made->status, 303);
    const std::string at = made->get_header_value("Location");
    EXPECT_THAT(page(at), AllOf(HasSubstr("Endodontics"), HasSubstr("400")));
    EXPECT_EQ(send("/office/classes", {{"name", "x"}, {"retention", "-3"}})->status, 400);
    EXPECT_EQ(send("/office/classes", {{"name", "x"}, {"retention", "many"}})->status, 400);
    EXPECT_EQ(send(at + "/enrol", {{"person", "s018"}, {"role", "student"}})->status, 303);
    EXPECT_EQ(send(at + "/enrol", {{"person", "nobody"}, {"role", "student"}})->status, 400);
    EXPECT_THAT(page(at), HasSubstr("Jun &lt;b&gt;"));
    EXPECT_EQ(send(at + "/close", {})->status, 303);
    EXPECT_THAT(page("/office/classes"), HasSubstr("Endodontics"));
    // A station enrols with a code of the page, and is sent away again.
    const std::string code = found(send("/office/stations", {{"name", "chair 2"}})->body, "once: ([0-9A-Z-]{15})");
    ASSERT_FALSE(code.empty());
    const Enrolment station = school_station::enrol(school_->address(), code, "s018");
    EXPECT_NO_THROW((void)school_station::status(station));
    EXPECT_THAT(page("/office/stations"), HasSubstr("Revoke chair 2"));
    EXPECT_EQ(send("/office/stations/" + station.station + "/revoke", {})->status, 303);
    EXPECT_THROW((void)school_station::status(station), core::Error);
    EXPECT_EQ(send("/office/stations/" + station.station + "/revoke", {})->status, 400);
}

TEST_F(OfficeTest, TheAuditTellsWhoDidWhatPageByPage) {
    Books open = books();
    for (int i = 0; i < 250; ++i)
        open.note({"t1", 1000 + i}, "look", "s018", std::to_string(i));
    const std::string first = page("/office/audit?about=s018");
    EXPECT_THAT(first, AllOf(HasSubstr("<td class=\"n\">249</td>"), Not(HasSubstr("<td class=\"n\">149</td>"))));
    std::string next = found(first, "href=\"(/office/audit\\?before=[0-9]+&amp;about=s018)\"");
    ASSERT_FALSE(next.empty());
    next.replace(next.find("&amp;"), 5, "&");
    EXPECT_THAT(page(next), AllOf(HasSubstr("<td class=\"n\">149</td>"), Not(HasSubstr("<td class=\"n\">150</td>"))));
    for (const char* odd :
         {"before=x", "before=-1", "before=99999999999999999999", "about=%27+OR+1=1", "about=%00", "about=%ff%fe"})
        EXPECT_EQ(browser_->get(std::string("/office/audit?") + odd)->status, 200) << odd;
}

}  // namespace
}  // namespace handpiece::school_server::office_test
