// SPDX-License-Identifier: Apache-2.0
// Lists of people as spreadsheets and school systems write them, and what they change in the books of both databases.
#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/package.h"
#include "handpiece/school/roster/roster_files.h"
#include "handpiece/school/roster/spreadsheet.h"
#include "handpiece/school/store/books_accounts.h"
#include "school/store/books_fixture.h"

namespace handpiece::school::roster_test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using Kind = RosterChange::Kind;

std::string errorOf(const std::function<void()>& work) {
    try {
        work();
    } catch (const core::Error& e) {
        return e.id() + ": " + e.what();
    }
    return "no error";
}
std::string errorIn(const std::string& text) {
    return errorOf([&] { (void)peopleList(text, "list.csv"); });
}

// Spreadsheets.

constexpr const char* kPlain =
    "code,name,login,role,class\ns1,Mori Aiko,mori,student,Second year\nt1,\"Sato, Yuki\",sato,teacher,Second year\n";

std::string utf16(std::string_view ascii, bool big) {
    std::string out = big ? "\xfe\xff" : "\xff\xfe";
    for (const char c : ascii)
        out += big ? std::string{'\0', c} : std::string{c, '\0'};
    return out;
}

TEST(Spreadsheet, ReadsWhatSpreadsheetProgramsWrite) {
    const auto written = [](const Roster& r) {
        std::string all;
        for (const auto& p : r.people)
            all += p.key + "|" + p.name.value_or("-") + "|" + p.login.value_or("-") + "|" +
                   (p.roles ? p.roles->front() : "-") + "\n";
        for (const auto& e : r.enrolments)
            all += e.schoolClass + "<" + e.person + "\n";
        return all;
    };
    const std::string expected = written(peopleList(kPlain, "list.csv"));
    EXPECT_EQ(expected, "s1|Mori Aiko|mori|student\nt1|Sato, Yuki|sato|teacher\nSecond year<s1\nSecond year<t1\n");
    std::string semicolons = kPlain, tabs = kPlain, crlf;
    // A comma inside of quotes is no separator.
    for (std::string* text : {&semicolons, &tabs}) {
        bool quoted = false;
        for (char& c : *text) {
            if (c == '"') quoted = !quoted;
            if (c == ',' && !quoted) c = text == &tabs ? '\t' : ';';
        }
    }
    for (const char c : std::string(kPlain))
        crlf += c == '\n' ? std::string("\r\n") : std::string{c};
    for (const std::string& text : std::vector<std::string>{
             "\xef\xbb\xbf" + std::string(kPlain), semicolons, tabs, crlf, "sep=;\r\n" + semicolons,
             "\xef\xbb\xbfsep=;\n" + semicolons, utf16(tabs, false), utf16(tabs, true),
             std::string(kPlain) + ",,,,\n\n,,,,\n",
             "Code,NAME,Login,Role,Class\n" + std::string(kPlain).substr(std::string(kPlain).find('\n') + 1),
             "code,name,login,role,class,,\n s1 , Mori Aiko ,mori,Student,Second year,,\n\"t1\",\"Sato, Yuki\" "
             ",sato,TEACHER,\"Second year\""})
        EXPECT_EQ(written(peopleList(text, "list.csv")), expected) << text;
    // Doubled quotes, Japanese with its own blanks, a pair of UTF-16.
    const Roster odd =
        peopleList("code;name\na;\"O'Hara \"\"Bob\"\"\"\nb;\xe3\x80\x80\xe6\xa3\xae \xe6\x84\x9b\xe3\x80\x80\n", "x");
    EXPECT_EQ(*odd.people[0].name, "O'Hara \"Bob\"");
    EXPECT_EQ(*odd.people[1].name, "\xe6\xa3\xae \xe6\x84\x9b");
    EXPECT_EQ(*peopleList(std::string("\xff\xfe"
                                      "c\0o\0d\0e\0\t\0n\0a\0m\0e\0\n\0"
                                      "1\0\t\0\x42\xd8\xb7\xdf\n\0",
                                      32),
                          "x")
                   .people[0]
                   .name,
              "\xf0\xa0\xae\xb7");
}

// A list out of a Japanese Excel: "Mori Ai" and a class "2A" in Shift_JIS, a name in half-width katakana.
TEST(Spreadsheet, ShiftJisIsReadAndTold) {
    const Roster roster =
        peopleList("code,name,class\ns1,\x90\x58 \x88\xa4,2A\x91\x67\ns2,\xb1\xb2,2A\x91\x67\n", "list.csv");
    ASSERT_EQ(roster.people.size(), 2u);
    EXPECT_EQ(*roster.people[0].name, "\u68ee \u611b");
    EXPECT_EQ(*roster.people[1].name, "\uff71\uff72");
    ASSERT_EQ(roster.classes.size(), 1u);
    EXPECT_EQ(roster.classes[0].name, "2A\u7d44");
    EXPECT_THAT(roster.notices, testing::Contains(testing::HasSubstr("Shift_JIS")));
    EXPECT_THAT(peopleList("code,name\ns1,\u68ee\n", "list.csv").notices, testing::IsEmpty());
}

TEST(Spreadsheet, SaysFileLineColumnAndWhatToDo) {
    const std::pair<std::string, std::vector<std::string>> cases[] = {
        {"", {"list.csv, line 1", "nothing in it"}},
        {"name,role\nMori,student\n", {"list.csv, line 1", "no column \"code\"", "there are: name, role"}},
        {"code,role\ns1,student\ns2,pupil\n",
         {"list.csv, line 3, column role", "'pupil' is no role", "student, teacher"}},
        {"code,name\ns1,\"Mori\ns2,Sato\n", {"list.csv, line 2", "never closed"}},
        {"code,name\ns1,\"Mori\" Aiko\n", {"list.csv, line 2", "behind a closed quote"}},
        {"code,name\ns1,Mo\xf1i\n", {"list.csv, line 2", "f1 is no UTF-8", "CSV UTF-8"}},
        {"code,name\ns1,Ren\xe9"
         "e\n",
         {"list.csv, line 2", "e9 is no UTF-8", "CSV UTF-8"}},
        {"code,name\ns1,M\xfcller\n", {"list.csv, line 2", "fc is no UTF-8", "CSV UTF-8"}},
        {"code,name\ns1,a\ns1,b\n", {"list.csv, line 3, column name", "list.csv, line 2"}},
        {"code,code\ns1,s2\n", {"two columns \"code\""}},
        {"code,name\ns1,Mori,Aiko\n", {"list.csv, line 2", "\"Aiko\" stands in column 3"}},
        {"code,class\ns1,A\ns1,A\n", {"line 3, column class", "already, in line 2"}},
        {"code,class role\ns1,teacher\n", {"line 2, column class", "name the class"}},
        {"code,class,class role\ns1,A,administrator\n", {"column class role", "no role in a class"}},
        {"code,name\n,Mori\n", {"line 2, column code", "it is empty"}},
        {std::string("code,name\ns1,a\0b\n", 17), {"line 2", "control character"}},
        {"PK\x03\x04whatever", {"own file", "CSV UTF-8"}},
        {"code,name\n\"a\nb\",c\n", {"line", "line's end"}},
        {"code,name\ns1," + std::string(3000, 'x') + "\n", {"line 2", "longer than 2000"}},
        {utf16("code\ns1", false) + "\x41", {"middle of a character"}},
        {std::string("\xff\xfe"
                     "c\0\0\xd8"
                     "a\0",
                     8),
         {"half a character"}},
    };
    for (const auto& [text, parts] : cases)
        for (const std::string& part : parts)
            EXPECT_THAT(errorIn(text), AllOf(HasSubstr(part), HasSubstr("list-unfit"))) << text.substr(0, 60);
}

// Into the books.

class RosterTest : public BooksTest {
  protected:
    std::vector<RosterChange> import(Books& books, const Roster& roster, RosterRules rules = {}) {
        if (roster.isExternal && !rules.isDryRun) rules.newCode = [this] { return "p" + std::to_string(++codes_); };
        return BooksRoster(books).import(roster, rules, kAdmin);
    }
    /// Books whose people came from no other system.
    std::unique_ptr<Books> ownSchool() const {
        auto books = filled();
        sql("UPDATE identities SET external = ''");
        return books;
    }
    static std::vector<Kind> kinds(const std::vector<RosterChange>& changes) {
        std::vector<Kind> all;
        for (const RosterChange& c : changes)
            all.push_back(c.kind);
        return all;
    }
    static std::string rolesOf(Books& books, const std::string& code) {
        return fmt::format("{}", fmt::join(books.person(code)->roles, " "));
    }
    static std::string membersOf(const Books& books, const std::string& name) {
        std::string all;
        for (const SchoolClass& c : books.classes())
            if (c.name == name)
                for (const Enrolment& e : books.enrolments(c.id))
                    all += e.person + ":" + e.role + " ";
        return all;
    }
    int codes_ = 0;
};
INSTANTIATE_TEST_SUITE_P(OnBoth, RosterTest, testing::Values("sqlite", "postgres"));

TEST_P(RosterTest, AListOfOnesOwnIsTakenOnceAndTheSameAgainChangesNothing) {
    const auto books = filled();
    const std::string before = dump();
    const Roster list = peopleList(
        "code,name,login,role,class,class role\n"
        "s1,Mori Aiko,mori,student,Second year,\n"       // is there
        "s2,Robert O'Hara,mori2,student,Second year,\n"  // another name and login
        "s9,New One,new,,Third year,\n"                  // new, in a new class
        "t1,,,,Third year,\n"                            // says nothing but the class
        "e1,Ex Aminer,ex,examiner/teacher,Second year,examiner\n",
        "list.csv");
    RosterRules dry;
    dry.isDryRun = true;
    const auto would = import(*books, list, dry);
    EXPECT_EQ(dump(), before) << "a dry run changes nothing, the audit neither";
    const auto did = import(*books, list);
    EXPECT_EQ(kinds(did), kinds(would));
    EXPECT_EQ(kinds(import(*books, list)), std::vector<Kind>{});
    EXPECT_EQ(books->person("s2")->name, "Robert O'Hara");
    EXPECT_EQ(books->person("s2")->login, "mori2");
    EXPECT_EQ(rolesOf(*books, "s9"), "student");
    EXPECT_EQ(rolesOf(*books, "e1"), "examiner teacher");
    EXPECT_EQ(membersOf(*books, "Third year"), "s9:student t1:teacher ");
    EXPECT_EQ(membersOf(*books, "Second year"), "e1:examiner s1:student s2:student s3:student t1:teacher ");
    EXPECT_EQ(books->person("t1")->password, "$argon2id$2") << "what the list does not say stays";
    // Whole: who is not in it leaves, students only.
    Roster whole = list;
    whole.hasAllEnrolments = true;
    EXPECT_THAT(kinds(import(*books, whole)), ElementsAre(Kind::leave));
    EXPECT_EQ(membersOf(*books, "Second year"), "e1:examiner s1:student s2:student t1:teacher ");
}

TEST_P(RosterTest, LoginsAreOnePersonsEachAndCanBeExchanged) {
    const auto books = filled();
    import(*books, peopleList("code,login\ns1,ohara\ns2,mori\n", "list.csv"));
    EXPECT_EQ(books->personByLogin("mori")->code, "s2");
    EXPECT_EQ(books->personByLogin("ohara")->code, "s1");
    const std::string before = dump();
    EXPECT_THAT(errorOf([&] { import(*books, peopleList("code,name,login\ns7,New,\ns3,,sato\n", "list.csv")); }),
                AllOf(HasSubstr("list.csv, line 3"), HasSubstr("'sato' is another person's"), HasSubstr("t1 has it")));
    EXPECT_EQ(dump(), before) << "all of it or nothing";
    EXPECT_THAT(errorOf([&] { import(*books, peopleList("code,login\ns8,same\ns9,same\n", "list.csv")); }),
                HasSubstr("line 3"));
    EXPECT_THAT(errorOf([&] { import(*books, peopleList("code\nno blanks\n", "list.csv")); }),
                HasSubstr("no code of a person"));
    books->erase("s2", kAdmin);
    EXPECT_THAT(errorOf([&] { import(*books, peopleList("code\ns2\n", "list.csv")); }), HasSubstr("was erased"));
}

TEST_P(RosterTest, AListMakesNobodyAnAdministratorUnlessToldAndTakesItFromNobody) {
    const auto books = filled();
    const Roster list = peopleList("code,role\ns1,administrator/student\nadmin,teacher\n", "list.csv");
    import(*books, list);
    EXPECT_EQ(rolesOf(*books, "s1"), "student");
    EXPECT_EQ(rolesOf(*books, "admin"), "administrator teacher");
    RosterRules rules;
    rules.makesAdministrators = true;
    import(*books, list, rules);
    EXPECT_EQ(rolesOf(*books, "s1"), "administrator student");
}

TEST_P(RosterTest, ClassesAreNamedByIdOrNameAndNeverGuessed) {
    const auto books = filled();
    import(*books, peopleList("code,class\ns1,c1\n", "list.csv"));
    EXPECT_EQ(books->classes().size(), 1u);
    books->add(SchoolClass{"c2", "Second year", "", 0}, kAdmin);
    EXPECT_THAT(errorOf([&] { import(*books, peopleList("code,class\ns1,Second year\n", "list.csv")); }),
                AllOf(HasSubstr("two classes"), HasSubstr("c1 or c2")));
    books->close("c1", kAdmin);
    import(*books, peopleList("code,class\ns1,Second year\n", "list.csv"));
    EXPECT_THAT(errorOf([&] { import(*books, peopleList("code,class\ns1,c1\n", "list.csv")); }),
                HasSubstr("is closed"));
}

// OneRoster. The files are written by the tables of the specification, for 1EdTech's own examples were not to be had.

using Files = std::map<std::string, std::string>;

Files school() {
    return {
        {"manifest.csv",
         "propertyName,value\nmanifest.version,1.0\noneroster.version,1.1\nfile.academicSessions,bulk\n"
         "file.categories,absent\nfile.classes,bulk\nfile.classResources,absent\nfile.courses,bulk\n"
         "file.courseResources,absent\nfile.demographics,absent\nfile.enrollments,bulk\nfile.lineItems,absent\n"
         "file.orgs,bulk\nfile.resources,absent\nfile.results,absent\nfile.users,bulk\n"
         "source.systemName,Campus\nsource.systemCode,C1\n"},
        {"orgs.csv",
         "sourcedId,status,dateLastModified,name,type,identifier,parentSourcedId\n"
         "org-1,,,Dental School,school,DS,\n"},
        {"academicSessions.csv",
         "sourcedId,status,dateLastModified,title,type,startDate,endDate,parentSourcedId,schoolYear\n"
         "term-1,,,Autumn,term,2026-09-01,2027-02-28,,2027\n"},
        {"courses.csv",
         "sourcedId,status,dateLastModified,schoolYearSourcedId,title,courseCode,grades,orgSourcedId,"
         "subjects,subjectCodes\ncourse-1,,,term-1,Operative dentistry,OD2,\"13,14\",org-1,,\n"},
        {"classes.csv",
         "\"sourcedId\",\"status\",\"dateLastModified\",\"title\",\"grades\",\"courseSourcedId\",\"classCode\","
         "\"classType\",\"location\",\"schoolSourcedId\",\"termSourcedIds\",\"subjects\",\"subjectCodes\",\"periods\"\n"
         "class-1,,,Operative 2 A,,course-1,OD2A,scheduled,Room 2,org-1,term-1,,,\"1,2\"\n"
         "class-2,,,Operative 2 B,,course-1,OD2B,scheduled,Room 3,org-1,\"term-1\",,,\n"},
        {"users.csv",
         "sourcedId,status,dateLastModified,enabledUser,orgSourcedIds,role,username,userIds,givenName,familyName,"
         "middleName,identifier,email,sms,phone,agentSourcedIds,grades,password\n"
         "u-t,,,true,org-1,teacher,sato.y,{LDAP:sato},Yuki,Sato,,T1,sato@school.example,,,,,\n"
         "u-1,,,TRUE,org-1,student,ito.i,,Ida,Ito,,S1,,,,u-p,14,\n"
         "u-2,,,true,org-1,student,ono.j,,Jun,Ono,K.,S2,,,,,14,secret\n"
         "u-p,,,true,org-1,parent,ito.p,,Paul,Ito,,,,,,u-1,,\n"
         "u-a,,,true,org-1,administrator,adm,,Ada,Min,,,,,,,,\n"},
        {"enrollments.csv",
         "sourcedId,status,dateLastModified,classSourcedId,schoolSourcedId,userSourcedId,role,primary,beginDate,"
         "endDate\n"
         "e-1,,,class-1,org-1,u-t,teacher,true,2026-09-01,2027-02-28\n"
         "e-2,,,class-1,org-1,u-1,student,false,2026-09-01,2027-02-28\n"
         "e-3,,,class-1,org-1,u-2,student,,,\n"
         "e-4,,,class-2,org-1,u-1,student,,2025-09-01,2026-02-28\n"
         "e-5,,,class-2,org-1,u-2,student,,2027-09-01,\n"
         "e-6,,,class-2,org-1,u-a,administrator,,,\n"},
    };
}

Roster read(const Files& files) {
    std::map<std::string, std::vector<std::byte>> bytes;
    for (const auto& [name, text] : files)
        bytes[name] = {std::as_bytes(std::span(text)).begin(), std::as_bytes(std::span(text)).end()};
    return oneRoster(bytes, "school.zip", "2026-11-27");
}
Files delta(const std::string& users, const std::string& enrolments, const std::string& classes = {}) {
    Files files = school();
    std::string& manifest = files["manifest.csv"];
    for (std::size_t at = 0; (at = manifest.find(",bulk", at)) != manifest.npos;)
        manifest.replace(at, 5, ",absent");
    const auto use = [&](const char* name, const std::string& rows) {
        std::string& text = files[std::string(name) + ".csv"];
        text = text.substr(0, text.find('\n') + 1) + rows;
        if (rows.empty()) return;
        const std::size_t at = manifest.find(std::string("file.") + name + ",");
        manifest.replace(at, manifest.find('\n', at) - at, std::string("file.") + name + ",delta");
    };
    use("users", users), use("enrollments", enrolments), use("classes", classes);
    return files;
}

TEST_P(RosterTest, OneRosterBulkIsTheSchoolAndTheSameAgainChangesNothing) {
    const auto books = ownSchool();
    const Roster roster = read(school());
    EXPECT_THAT(roster.notices, ElementsAre("enrolments with the role administrator are not read: 1",
                                            "people with the role parent are not read: 1"));
    RosterRules dry;
    dry.isDryRun = true;
    const std::string before = dump();
    const auto would = import(*books, roster, dry);
    EXPECT_EQ(dump(), before);
    EXPECT_EQ(kinds(import(*books, roster)), kinds(would));
    EXPECT_TRUE(import(*books, roster).empty());
    const auto ono = books->personByLogin("ono.j");
    ASSERT_TRUE(ono);
    EXPECT_EQ(ono->name, "Jun K. Ono");
    EXPECT_EQ(ono->external, "u-2");
    EXPECT_EQ(ono->password, "") << "a list's password is none";
    EXPECT_EQ(rolesOf(*books, books->personByLogin("adm")->code), "") << "nobody is made an administrator by a list";
    EXPECT_FALSE(books->personByLogin("ito.p"));
    EXPECT_EQ(membersOf(*books, "Operative 2 A"), "p1:teacher p2:student p3:student ");
    EXPECT_EQ(membersOf(*books, "Operative 2 B"), "") << "not yet, no longer, and no role of a class";
    EXPECT_EQ(membersOf(*books, "Second year"), "s1:student s2:student s3:student t1:teacher ")
        << "what is not of that system stays";
    EXPECT_TRUE(books->personByLogin("mori"));
}

TEST_P(RosterTest, WhoIsNoLongerInABulkListIsGoneAndComesBack) {
    const auto books = ownSchool();
    import(*books, read(school()));
    for (const SchoolClass& c : books->classes())
        if (c.name == "Operative 2 A") books->enrol(std::vector<Enrolment>{{c.id, "t1", "examiner"}}, kAdmin);
    Files next = school();
    std::string& users = next["users.csv"];
    users.erase(users.find("u-2"), users.find("u-p,,,") - users.find("u-2"));
    std::string& enrolments = next["enrollments.csv"];
    enrolments = enrolments.substr(0, enrolments.find("e-3"));
    std::string& classes = next["classes.csv"];
    classes.erase(classes.find("class-2"));
    EXPECT_THAT(kinds(import(*books, read(next))), ElementsAre(Kind::suspend, Kind::closeClass, Kind::leave));
    EXPECT_TRUE(import(*books, read(next)).empty());
    EXPECT_TRUE(BooksAccounts(*books).isSuspended("p3"));
    EXPECT_EQ(books->person("p3")->name, "Jun K. Ono") << "nobody is erased by a list";
    EXPECT_THAT(errorOf([&] { books->addLogin(std::string(64, 'a'), "p3", kNow + 1, kAdmin); }),
                HasSubstr("account-suspended"));
    EXPECT_EQ(membersOf(*books, "Operative 2 A"), "p1:teacher p2:student t1:examiner ") << "set by hand";
    EXPECT_THAT(kinds(import(*books, read(school()))), ElementsAre(Kind::resume, Kind::openClass, Kind::enrol));
    books->addLogin(std::string(64, 'a'), "p3", kNow + 1, kAdmin);
    // One who may not log in for now keeps the classes... and is suspended.
    Files disabled = school();
    std::string& text = disabled["users.csv"];
    text.replace(text.find("u-2,,,true"), 10, "u-2,,,false");
    EXPECT_EQ(kinds(import(*books, read(disabled)))[0], Kind::suspend);
    EXPECT_FALSE(books->personByToken(std::string(64, 'a'), kNow)) << "and is logged out";
}

TEST_P(RosterTest, OneRosterDeltaChangesWhatItNamesAndNothingElse) {
    const auto books = ownSchool();
    import(*books, read(school()));
    const std::string at = "2026-11-20T08:30:00.000Z";
    const auto changes = import(*books, read(delta("u-2,tobedeleted," + at +
                                                       ",true,org-1,student,ono.j,,Jun,Ono,K.,,,,,,,\n"
                                                       "u-9,active," +
                                                       at + ",true,org-1,student,abe.k,,Kei,Abe,,,,,,,,\n",
                                                   "e-3,tobedeleted," + at +
                                                       ",class-1,org-1,u-2,student,,,\n"
                                                       "e-9,active," +
                                                       at +
                                                       ",class-1,org-1,u-9,student,,,\n"
                                                       "e-8,active," +
                                                       at + ",class-2,org-1,u-1,student,,,\n")));
    const std::set<Kind> all = [&] {
        const auto k = kinds(changes);
        return std::set<Kind>(k.begin(), k.end());
    }();
    EXPECT_EQ(all, (std::set<Kind>{Kind::addPerson, Kind::setRoles, Kind::suspend, Kind::enrol, Kind::leave}));
    EXPECT_EQ(membersOf(*books, "Operative 2 A"),
              fmt::format("p1:teacher p2:student {}:student ", books->personByLogin("abe.k")->code));
    EXPECT_EQ(membersOf(*books, "Operative 2 B"), "p2:student ");
    EXPECT_TRUE(BooksAccounts(*books).isSuspended("p3"));
    import(*books, read(delta("", "", "class-2,tobedeleted," + at + ",x,,course-1,,homeroom,,org-1,term-1,,,\n")));
    for (const SchoolClass& c : books->classes())
        EXPECT_EQ(c.closed > 0, c.name == "Operative 2 B") << c.name;
}

TEST_P(RosterTest, AListThatIsHalfIsNotTakenForTheWhole) {
    const auto books = ownSchool();
    Files many = school();
    for (int i = 0; i < 60; ++i)
        many["users.csv"] += fmt::format("m-{0},,,true,org-1,student,m{0},,M,{0},,,,,,,,\n", i);
    import(*books, read(many));
    const std::string before = dump();
    EXPECT_THAT(errorOf([&] { import(*books, read(school())); }),
                AllOf(HasSubstr("list-short"), HasSubstr("60 of 64 people"), HasSubstr("--ends-many")));
    EXPECT_EQ(dump(), before);
    RosterRules rules;
    rules.endsMany = true;
    EXPECT_EQ(import(*books, read(school()), rules).size(), 60u);
}

TEST(OneRoster, SaysFileLineAndColumnOfWhatIsWrong) {
    const auto wrong = [](const char* file, const std::string& from, const std::string& to) {
        Files files = school();
        std::string& text = files[file];
        EXPECT_NE(text.find(from), text.npos) << from;
        text.replace(text.find(from), from.size(), to);
        return errorOf([&] { (void)read(files); });
    };
    EXPECT_THAT(wrong("manifest.csv", "oneroster.version,1.1", "oneroster.version,1.2"),
                AllOf(HasSubstr("school.zip/manifest.csv, line 3, column value"), HasSubstr("OneRoster 1.2"),
                      HasSubstr("1.1")));
    EXPECT_THAT(wrong("manifest.csv", "oneroster.version,1.1\n", ""), HasSubstr("does not say of which version"));
    EXPECT_THAT(wrong("manifest.csv", "file.users,bulk", "file.users,all"), HasSubstr("absent, bulk or delta"));
    EXPECT_THAT(wrong("users.csv", "u-1,,,TRUE", "u-1,,,yes"),
                AllOf(HasSubstr("users.csv, line 3, column enabledUser"), HasSubstr("'yes'")));
    EXPECT_THAT(wrong("users.csv", "student,ito.i", "pupil,ito.i"),
                AllOf(HasSubstr("line 3, column role"), HasSubstr("'pupil'")));
    EXPECT_THAT(wrong("users.csv", "student,ito.i", "student,"),
                AllOf(HasSubstr("line 3, column username"), HasSubstr("it is empty")));
    EXPECT_THAT(wrong("users.csv", "u-2,,,true,org-1", "u-2,,,true,\"org-1,org-9\""),
                AllOf(HasSubstr("line 4, column orgSourcedIds"), HasSubstr("orgs.csv has no 'org-9'")));
    EXPECT_THAT(wrong("users.csv", "u-2,", "u-1,"), AllOf(HasSubstr("line 4, column sourcedId"), HasSubstr("twice")));
    EXPECT_THAT(wrong("users.csv", "familyName", "surname"),
                AllOf(HasSubstr("users.csv, line 1"), HasSubstr("\"familyName\"")));
    EXPECT_THAT(wrong("users.csv", "u-1,,", "u-1,deleted,"), HasSubstr("line 3, column status"));
    EXPECT_THAT(wrong("classes.csv", "course-1,OD2A", "course-7,OD2A"),
                AllOf(HasSubstr("classes.csv, line 2, column courseSourcedId"), HasSubstr("course-7")));
    EXPECT_THAT(wrong("classes.csv", "scheduled,Room 2", "lecture,Room 2"), HasSubstr("line 2, column classType"));
    EXPECT_THAT(wrong("classes.csv", "term-1,,,\"1,2\"", "term-4,,,\"1,2\""),
                HasSubstr("academicSessions.csv has no 'term-4'"));
    EXPECT_THAT(
        wrong("enrollments.csv", "class-1,org-1,u-2", "class-1,org-1,u-77"),
        AllOf(HasSubstr("enrollments.csv, line 4, column userSourcedId"), HasSubstr("users.csv has no 'u-77'")));
    EXPECT_THAT(wrong("enrollments.csv", "class-1,org-1,u-2", "class-5,org-1,u-2"),
                HasSubstr("classes.csv has no 'class-5'"));
    EXPECT_THAT(wrong("enrollments.csv", "2026-09-01,2027-02-28\ne-2", "1.9.2026,\ne-2"),
                HasSubstr("line 2, column beginDate"));
    EXPECT_THAT(wrong("enrollments.csv", "u-t,teacher", "u-t,aide"), HasSubstr("line 2, column role"));
    Files without = school();
    without.erase("users.csv");
    EXPECT_THAT(errorOf([&] { (void)read(without); }), HasSubstr("names users.csv, and it is not there"));
    without.erase("manifest.csv");
    EXPECT_THAT(errorOf([&] { (void)read(without); }), HasSubstr("no manifest.csv"));
    EXPECT_THAT(errorOf([] { (void)read(delta("u-2,active,,true,org-1,student,x,,A,B,,,,,,,,\n", "")); }),
                HasSubstr("line 2, column dateLastModified"));
    EXPECT_THAT(errorOf([] { (void)read(delta("u-2,,2026-11-20,true,org-1,student,x,,A,B,,,,,,,,\n", "")); }),
                HasSubstr("line 2, column status"));
}

TEST_P(RosterTest, DeltaThatNamesWhomNobodyKnowsIsRefusedWhole) {
    const auto books = ownSchool();
    import(*books, read(school()));
    const std::string before = dump();
    EXPECT_THAT(errorOf([&] {
                    import(*books, read(delta("u-9,active,2026-11-20,true,org-1,student,abe.k,,Kei,Abe,,,,,,,,\n",
                                              "e-9,active,2026-11-20,class-1,org-1,u-99,student,,,\n")));
                }),
                AllOf(HasSubstr("enrollments.csv, line 2, column userSourcedId"), HasSubstr("no person 'u-99'")));
    EXPECT_EQ(dump(), before);
}

TEST(OneRoster, ComesAsAZipAFolderAndInAFolderOfAZip) {
    const core::PrivateFolder folder;
    cases::PackageFiles flat, nested;
    for (const auto& [name, text] : school()) {
        const std::vector<std::byte> bytes(std::as_bytes(std::span(text)).begin(),
                                           std::as_bytes(std::span(text)).end());
        flat[name] = bytes, nested["export/" + name] = bytes;
        fs::create_directories(folder.path() / "files");
        core::writeFile(folder.path() / "files" / name, bytes);
    }
    cases::writePackage(folder.path() / "flat.zip", flat);
    cases::writePackage(folder.path() / "nested.zip", nested);
    for (const char* name : {"flat.zip", "nested.zip", "files"}) {
        const Roster roster = readRoster(folder.path() / name, "2026-11-27");
        EXPECT_EQ(roster.people.size(), 4u) << name;
        EXPECT_EQ(roster.enrolments.size(), 5u) << name;
    }
    core::writeFile(folder.path() / "broken.zip", std::string("PK\x03\x04 and no more"));
    EXPECT_THAT(errorOf([&] { (void)readRoster(folder.path() / "broken.zip", "2026-11-27"); }),
                HasSubstr("broken.zip"));
}

}  // namespace
}  // namespace handpiece::school::roster_test
