// SPDX-License-Identifier: Apache-2.0
#include "school/office_pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <set>

#include "handpiece/app/report/school_pages.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/school/keeping/person_export.h"
#include "handpiece/school/people/secret.h"
#include "handpiece/school/roster/roster_files.h"
#include "handpiece/school/roster/spreadsheet.h"
#include "handpiece/school/store/books_accounts.h"
#include "school/roster_words.h"
#include "school/visit.h"

namespace handpiece::school_server {
namespace {

using config::words;
using report::Form;
using report::FormField;
using report::HtmlReport;
using school::Action;
using school::BooksAccounts;
using Cell = HtmlReport::Cell;
using Tone = HtmlReport::Tone;

constexpr school::Milliseconds kDay = 86'400'000;
constexpr const char* kRoles[] = {"student", "teacher", "examiner", "administrator"};
constexpr std::size_t kMostShown = 500, kAuditLines = 100;

std::string word(const std::string& id) {
    return words()("school-office." + id);
}
/// Without where the books lie; a list's own place is told.
std::string said(const core::Error& e) {
    if (e.id() == "list-unfit") return e.what();
    return e.remedy().empty() ? e.problem() : fmt::format("{} ({})", e.problem(), e.remedy());
}
Page back(const std::string& address) {
    return {303, {}, address, {}};
}
FormField field(const std::string& name, const std::string& label, const std::string& value = {},
                const std::string& kind = "text") {
    FormField one{name, label, kind, value};
    return one;
}
FormField required(FormField one) {
    one.isRequired = true;
    return one;
}
FormField hinted(FormField one, std::string hint) {
    one.hint = std::move(hint);
    return one;
}
FormField chosen(const std::string& name, const std::string& label, std::vector<FormField::Choice> choices,
                 const std::string& value = {}) {
    FormField one{name, label, "select", value};
    one.choices = std::move(choices);
    return one;
}
std::vector<FormField::Choice> roleChoices(bool ofClass) {
    std::vector<FormField::Choice> all;
    for (const char* role : kRoles)
        if (!ofClass || std::string_view(role) != "administrator") all.push_back({role, word(role)});
    return all;
}
std::string rolesInWords(const std::vector<std::string>& roles) {
    std::vector<std::string> all;
    for (const std::string& role : roles)
        all.push_back(word(role));
    return fmt::format("{}", fmt::join(all, ", "));
}
void wrongOver(HtmlReport& page, const std::string& wrong) {
    if (!wrong.empty()) page.paragraph(words()("school-office.not-accepted", wrong), Tone::bad);
}
bool mayManage(const Visit& v, Action action) {
    return may(v, action, {});
}

/// What one of these refuses is told on the page it came from.
template <class Change, class Again>
Page tried(const Change& change, const Again& again) {
    try {
        return change();
    } catch (const core::Error& e) {
        constexpr std::string_view kTold[] = {"books-unknown", "books-duplicate", "books-changed", "books-invalid",
                                              "list-unfit",    "list-short",      "not-a-package", "password-unfit"};
        if (std::find(std::begin(kTold), std::end(kTold), e.id()) == std::end(kTold)) throw;
        Page page = again(said(e));
        page.status = 400;
        return page;
    }
}

void importForm(HtmlReport& page, const Visit& v) {
    page.heading(word("import-heading"));
    page.paragraph(word("import-about"), Tone::note);
    page.form(
        {"/office/people/import",
         {report::tokenField(lookerOf(v)), required(field("file", word("import-file"), {}, "file")),
          field("whole", word("import-whole"), {}, "checkbox"), field("many", word("import-many"), {}, "checkbox")},
         {{word("import-dry"), "do", "dry"}, {word("import-do"), "do", "it"}}});
}

}  // namespace

// People.

Page peoplePage(const Visit& v, const std::string& find, const std::string& wrong) {
    if (!mayManage(v, Action::managePeople)) return notYours();
    noteLook(v, "list of people seen", "");
    HtmlReport page = report::sitePage(word("people"), lookerOf(v), "/office/people");
    wrongOver(page, wrong);
    page.form({"/office/people", {field("find", word("find"), find)}, {{word("find-do")}}, true});
    const std::set<std::string> suspended = BooksAccounts(v.books).suspended();
    const std::string wanted = school::inSmallLetters(find);
    const auto fits = [&](const std::string& text) { return school::inSmallLetters(text).find(wanted) != text.npos; };
    std::vector<std::vector<Cell>> rows;
    const std::vector<school::Person> people = v.books.people();
    std::size_t found = 0;
    for (const school::Person& p : people) {
        if (!wanted.empty() && !fits(p.code) && !fits(p.name) && !fits(p.login)) continue;
        if (++found > kMostShown) continue;
        const std::string state = p.erased > 0                  ? word("erased")
                                  : suspended.count(p.code) > 0 ? word("suspended")
                                  : p.login.empty()             ? word("log-in-no")
                                  : p.password.empty()          ? word("log-in-code")
                                                                : word("log-in-yes");
        rows.push_back({{p.code, "/office/people/" + p.code}, {p.name}, {p.login}, {rolesInWords(p.roles)}, {state}});
    }
    if (rows.empty())
        page.paragraph(word("nobody"), Tone::missing);
    else
        page.linkedTable({word("code"), word("name"), word("login"), word("roles"), word("log-in")}, rows,
                         found > kMostShown ? words()("school-office.first-shown", kMostShown, found)
                                            : words()("school-office.shown", found, people.size()));
    page.heading(word("add-heading"));
    page.form(
        {"/office/people",
         {report::tokenField(lookerOf(v)), hinted(required(field("code", word("code"))), word("code-hint")),
          field("name", word("name")), field("login", word("login")), chosen("role", word("role"), roleChoices(false))},
         {{word("add-do")}}});
    importForm(page, v);
    return {200, page.text()};
}

Page addPerson(const Visit& v, const Sent& sent) {
    if (!mayManage(v, Action::managePeople)) return notYours();
    return tried(
        [&] {
            const school::Person person{sent("code"), sent("name"), sent("login"), {}, {}, {sent("role")}, v.now, 0};
            v.books.add(std::span(&person, 1), actOf(v));
            return back("/office/people/" + person.code);
        },
        [&](const std::string& wrong) { return peoplePage(v, {}, wrong); });
}

Page importList(const Visit& v, const Sent& sent, const std::string& fileName, const std::string& file) {
    if (!mayManage(v, Action::managePeople)) return notYours();
    return tried(
        [&] {
            school::Roster roster = school::readRoster(std::as_bytes(std::span(file)), fileName, today(v.now));
            if (!roster.isExternal) roster.hasAllEnrolments = !sent("whole").empty();
            school::RosterRules rules;
            rules.isDryRun = sent("do") != "it";
            rules.endsMany = !sent("many").empty();
            rules.newCode = newPersonCode;
            const auto changes = school::BooksRoster(v.books).import(roster, rules, actOf(v));
            HtmlReport page = report::sitePage(word("import-heading"), lookerOf(v));
            if (changes.empty())
                page.paragraph(word("import-nothing"), Tone::good);
            else
                page.paragraph(
                    words()(rules.isDryRun ? "school-office.import-would" : "school-office.import-did", changes.size()),
                    rules.isDryRun ? Tone::plain : Tone::good);
            for (const std::string& notice : roster.notices)
                page.paragraph(notice, Tone::note);
            std::vector<std::string> lines;
            for (const school::RosterChange& change : changes)
                if (lines.size() < 2 * kMostShown) lines.push_back(inWords(change));
            if (!lines.empty()) page.list(lines);
            importForm(page, v);
            page.link("/office/people", word("people"));
            return Page{200, page.text()};
        },
        [&](const std::string& wrong) { return peoplePage(v, {}, wrong); });
}

Page accountPage(const Visit& v, const std::string& code, const std::string& shown, const std::string& wrong) {
    if (!mayManage(v, Action::managePeople)) return notYours();
    const auto person = v.books.person(code);
    if (!person) return notYours();
    noteLook(v, "account seen", code);
    const BooksAccounts accounts(v.books);
    const std::string here = "/office/people/" + code;
    HtmlReport page =
        report::sitePage(words()("school-office.account-of", person->name.empty() ? code : person->name), lookerOf(v));
    wrongOver(page, wrong);
    if (!shown.empty()) page.paragraph(shown, Tone::good);
    const bool isErased = person->erased > 0, isSuspended = accounts.isSuspended(code);
    const std::string state = isErased                   ? word("erased")
                              : isSuspended              ? word("suspended")
                              : person->login.empty()    ? word("log-in-no")
                              : person->password.empty() ? word("log-in-code")
                                                         : word("log-in-yes");
    page.facts({}, {{word("code"), code}, {word("log-in"), state}, {word("made"), report::momentOf(person->made)}});
    const FormField token = report::tokenField(lookerOf(v));
    if (!isErased) {
        page.form({here + "/name",
                   {token, field("name", word("name"), person->name), field("login", word("login"), person->login)},
                   {{word("save")}}});
        std::vector<FormField> roles{token, field("", word("roles"), {}, "group")};
        for (const char* role : kRoles)
            roles.push_back(
                field(role, word(role),
                      std::find(person->roles.begin(), person->roles.end(), role) != person->roles.end() ? "on" : "",
                      "checkbox"));
        roles.push_back(field("", {}, {}, "end"));
        page.form({here + "/roles", roles, {{word("roles-do")}}});
        page.heading(word("reset-heading"));
        page.paragraph(word(person->login.empty() ? "no-login-yet" : "reset-about"), Tone::note);
        if (!person->login.empty()) page.form({here + "/code", {token}, {{word("reset-do")}}});
        page.paragraph(word("suspend-about"), Tone::note);
        page.form({here + (isSuspended ? "/resume" : "/suspend"),
                   {token},
                   {{word(isSuspended ? "resume-do" : "suspend-do")}}});
    }
    page.heading(word("in-classes"));
    std::map<std::string, std::string> names;
    std::vector<FormField::Choice> open;
    for (const school::SchoolClass& one : v.books.classes()) {
        names[one.id] = one.name;
        if (one.closed == 0) open.push_back({one.id, one.name});
    }
    const std::vector<school::Enrolment> enrolments = accounts.enrolmentsOf(code);
    if (enrolments.empty()) page.paragraph(word("no-class"), Tone::missing);
    std::vector<std::vector<Cell>> rows;
    for (const school::Enrolment& one : enrolments)
        rows.push_back({{names[one.schoolClass], "/office/classes/" + one.schoolClass}, {word(one.role)}});
    if (!rows.empty()) page.linkedTable({word("class"), word("role")}, rows);
    for (const school::Enrolment& one : enrolments)
        page.form({here + "/leave",
                   {token, field("class", {}, one.schoolClass, "hidden")},
                   {{words()("school-office.leave-do", names[one.schoolClass])}}});
    if (!open.empty() && !isErased)
        page.form({here + "/enrol",
                   {token, chosen("class", word("class"), open), chosen("role", word("role"), roleChoices(true))},
                   {{word("enrol-do")}}});
    page.heading(word("export-heading"));
    page.link(here + "/export", word("export-do"));
    page.link("/office/audit?about=" + code, word("audit"));
    if (!isErased) {
        page.heading(word("erase-heading"));
        page.paragraph(word("erase-about"), Tone::note);
        page.form({here + "/erase",
                   {token, required(field("sure", word("erase-sure")))},
                   {{word("erase-do"), {}, {}, true}}});
    }
    return {200, page.text()};
}

Page changeAccount(const Visit& v, const std::string& code, const std::string& what, const Sent& sent,
                   const std::string& address) {
    if (!mayManage(v, what == "erase" ? Action::erasePerson : Action::managePeople)) return notYours();
    const auto person = v.books.person(code);
    if (!person) return notYours();
    const std::string here = "/office/people/" + code;
    const bool isSelf = code == v.person.code;
    const auto again = [&](const std::string& wrong) { return accountPage(v, code, {}, wrong); };
    BooksAccounts accounts(v.books);
    return tried(
        [&]() -> Page {
            if (what == "name") {
                v.books.rename(code, sent("name"), sent("login"), actOf(v));
            } else if (what == "roles") {
                std::vector<std::string> roles;
                for (const char* role : kRoles)
                    if (!sent(role).empty()) roles.push_back(role);
                // Somebody must be left who can give it back.
                if (isSelf && sent("administrator").empty()) return again(word("own-self"));
                v.books.setRoles(code, roles, actOf(v));
            } else if (what == "code") {
                if (person->login.empty()) return again(word("no-login-yet"));
                const std::string one = school::newStationCode();
                const school::Milliseconds until = v.now + 14 * kDay;
                accounts.offerPasswordCode(code, one, until, actOf(v));
                return accountPage(v, code,
                                   words()("school-office.reset-shown", person->login, one, address + "/first",
                                           report::momentOf(until)));
            } else if (what == "suspend") {
                if (isSelf) return again(word("own-self"));
                accounts.suspend(code, actOf(v));
            } else if (what == "resume") {
                accounts.resume(code, actOf(v));
            } else if (what == "enrol") {
                const school::Enrolment one{sent("class"), code, sent("role")};
                v.books.enrol(std::span(&one, 1), actOf(v));
            } else if (what == "leave") {
                v.books.leave(sent("class"), code, actOf(v));
            } else if (what == "erase") {
                if (isSelf) return again(word("own-self"));
                if (sent("sure") != code) return again(word("erase-typed"));
                v.books.erase(code, actOf(v));
            }
            return back(here);
        },
        again);
}

Page exportPage(const Visit& v, const std::string& code) {
    school::Relation relation;
    relation.isOwn = code == v.person.code;
    if (!may(v, Action::exportPerson, relation) || !v.books.person(code)) return notYours();
    // Beside the uploads: there is room for what is as large as they are, and what a crash leaves is swept.
    const std::filesystem::path file = v.books.files().path(std::string(64, '0')).parent_path().parent_path() /
                                       "uploads" / fmt::format("export-{}.zip", school::newId());
    school::exportPerson(v.books, code, file, actOf(v));
    Page page;
    page.stream = core::openFile(file);
    std::error_code none;
    std::filesystem::remove(file, none);
    page.type = "application/zip";
    page.fileName = code + ".zip";
    return page;
}

// Classes.

Page officeClassesPage(const Visit& v, const std::string& wrong) {
    if (!mayManage(v, Action::manageClasses)) return notYours();
    HtmlReport page = report::sitePage(word("classes"), lookerOf(v), "/office/classes");
    wrongOver(page, wrong);
    std::vector<std::vector<Cell>> rows;
    for (const school::SchoolClass& one : v.books.classes())
        rows.push_back({{one.name.empty() ? one.id : one.name, "/office/classes/" + one.id},
                        {std::to_string(v.books.enrolments(one.id).size())},
                        {report::momentOf(one.made)},
                        {one.closed > 0 ? report::momentOf(one.closed) : ""}});
    if (!rows.empty()) page.linkedTable({word("class"), word("members"), word("made"), word("closed")}, rows);
    page.heading(word("new-class"));
    FormField days = hinted(field("retention", word("retention"), "0", "number"), word("retention-hint"));
    days.least = "0", days.most = "36500";
    page.form({"/office/classes",
               {report::tokenField(lookerOf(v)), required(field("name", word("class-name"))), days},
               {{word("add-do")}}});
    return {200, page.text()};
}

Page addClass(const Visit& v, const Sent& sent) {
    if (!mayManage(v, Action::manageClasses)) return notYours();
    return tried(
        [&] {
            school::SchoolClass made;
            made.id = school::newId(), made.name = sent("name");
            const std::string days = sent("retention");
            const auto [end, ec] = std::from_chars(days.data(), days.data() + days.size(), made.retentionDays);
            if (!days.empty() && (ec != std::errc() || end != days.data() + days.size())) made.retentionDays = -1;
            v.books.add(made, actOf(v));
            return back("/office/classes/" + made.id);
        },
        [&](const std::string& wrong) { return officeClassesPage(v, wrong); });
}

Page officeClassPage(const Visit& v, const std::string& id, const std::string& wrong) {
    if (!mayManage(v, Action::manageClasses)) return notYours();
    const std::vector<school::SchoolClass> classes = v.books.classes();
    const auto one = std::find_if(classes.begin(), classes.end(), [&](const auto& c) { return c.id == id; });
    if (one == classes.end()) return notYours();
    HtmlReport page = report::sitePage(words()("school-office.class-of", one->name), lookerOf(v));
    wrongOver(page, wrong);
    page.facts({}, {{word("code"), id},
                    {word("made"), report::momentOf(one->made)},
                    {word("closed"), one->closed > 0 ? report::momentOf(one->closed) : "\u2013"},
                    {word("retention"), std::to_string(one->retentionDays)}});
    page.heading(word("members"));
    std::map<std::string, std::string> names;
    for (const school::Person& person : v.books.people())
        names[person.code] = person.name;
    std::vector<std::vector<Cell>> rows;
    for (const school::Enrolment& e : v.books.enrolments(id))
        rows.push_back({{e.person, "/office/people/" + e.person}, {names[e.person]}, {word(e.role)}});
    if (rows.empty())
        page.paragraph(word("nobody"), Tone::missing);
    else
        page.linkedTable({word("code"), word("name"), word("role")}, rows);
    const FormField token = report::tokenField(lookerOf(v));
    if (one->closed == 0) {
        const std::string here = "/office/classes/" + id;
        page.form({here + "/enrol",
                   {token, required(field("person", word("person"))), chosen("role", word("role"), roleChoices(true))},
                   {{word("enrol-do")}}});
        page.form({here + "/close", {token}, {{word("close-do"), {}, {}, true}}});
    }
    return {200, page.text()};
}

Page changeClass(const Visit& v, const std::string& id, const std::string& what, const Sent& sent) {
    if (!mayManage(v, Action::manageClasses)) return notYours();
    return tried(
        [&] {
            if (what == "close") {
                v.books.close(id, actOf(v));
            } else {
                const school::Enrolment one{id, sent("person"), sent("role")};
                v.books.enrol(std::span(&one, 1), actOf(v));
            }
            return back("/office/classes/" + id);
        },
        [&](const std::string& wrong) { return officeClassPage(v, id, wrong); });
}

// Stations.

Page stationsPage(const Visit& v, const std::string& shown) {
    if (!mayManage(v, Action::manageStations)) return notYours();
    HtmlReport page = report::sitePage(word("stations"), lookerOf(v), "/office/stations");
    if (!shown.empty()) page.paragraph(shown, Tone::good);
    const std::vector<school::Station> stations = BooksAccounts(v.books).stations();
    std::vector<std::vector<Cell>> rows;
    for (const school::Station& one : stations)
        rows.push_back({{one.name},
                        {one.kind == "worker" ? word("cuts-again")
                         : one.kind != "exam" ? "\u2013"
                         : one.released == 0  ? word("exams-unreleased")
                                              : words()("school-office.exams-since", report::momentOf(one.released))},
                        {report::momentOf(one.enrolled)},
                        {one.revoked > 0 ? report::momentOf(one.revoked) : "\u2013"},
                        {one.id}});
    if (rows.empty())
        page.paragraph(word("no-stations"), Tone::missing);
    else
        page.linkedTable({word("station"), word("exams"), word("enrolled"), word("revoked"), word("code")}, rows);
    const FormField token = report::tokenField(lookerOf(v));
    page.heading(word("new-station"));
    FormField forExams{"exams", word("for-exams"), "checkbox"};
    forExams.hint = word("for-exams-hint");
    page.form(
        {"/office/stations", {token, required(field("name", word("station-name"))), forExams}, {{word("station-do")}}});
    for (const school::Station& one : stations)
        if (one.revoked == 0 && one.kind == "exam" && one.released == 0)
            page.form({"/office/stations/" + one.id + "/release",
                       {token},
                       {{words()("school-office.release-do", one.name)}}});
    for (const school::Station& one : stations)
        if (one.revoked == 0)
            page.form({"/office/stations/" + one.id + "/revoke",
                       {token},
                       {{words()("school-office.revoke-do", one.name), {}, {}, true}}});
    return {200, page.text()};
}

Page addStationCode(const Visit& v, const Sent& sent) {
    if (!mayManage(v, Action::manageStations)) return notYours();
    return tried(
        [&] {
            const std::string code = school::newStationCode();
            const bool isForExams = !sent("exams").empty();
            v.books.offerCode(code, sent("name"), v.now + kDay, actOf(v), isForExams ? "exam" : "practice");
            return stationsPage(v, isForExams ? words()("school-office.exam-station-shown", code, code)
                                              : words()("school-office.station-shown", code, code));
        },
        [&](const std::string& wrong) { return stationsPage(v, wrong); });
}

Page releaseStation(const Visit& v, const std::string& id) {
    if (!mayManage(v, Action::manageStations)) return notYours();
    return tried(
        [&] {
            v.books.releaseForExams(id, actOf(v));
            return back("/office/stations");
        },
        [&](const std::string& wrong) { return stationsPage(v, wrong); });
}

Page revokeStation(const Visit& v, const std::string& id) {
    if (!mayManage(v, Action::manageStations)) return notYours();
    return tried(
        [&] {
            v.books.revoke(id, actOf(v));
            return back("/office/stations");
        },
        [&](const std::string& wrong) { return stationsPage(v, wrong); });
}

// The audit.

namespace {
std::int64_t addAudit(HtmlReport& page, const std::vector<school::AuditLine>& lines) {
    std::vector<std::vector<std::string>> rows;
    for (const school::AuditLine& line : lines)
        rows.push_back({report::momentOf(line.at), line.who, line.what, line.about, line.detail});
    if (rows.empty())
        page.paragraph(word("no-audit"), Tone::missing);
    else
        page.table({word("when"), word("who"), word("what"), word("about"), word("detail")}, rows);
    return lines.size() < kAuditLines ? 0 : lines.back().number;
}
}  // namespace

Page auditPage(const Visit& v, const std::string& before, const std::string& about) {
    if (!mayManage(v, Action::seeAudit)) return notYours();
    std::int64_t number = 0;
    (void)std::from_chars(before.data(), before.data() + before.size(), number);
    HtmlReport page = report::sitePage(word("audit"), lookerOf(v), "/office/audit");
    page.form({"/office/audit", {field("about", word("audit-about"), about)}, {{word("find-do")}}, true});
    // Codes and ids are what lines are about; anything else is found nowhere.
    const bool isCode =
        about.size() <= 64 &&
        about.find_first_not_of("0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ._-") == about.npos;
    std::vector<school::AuditLine> lines;
    if (isCode) lines = BooksAccounts(v.books).auditBefore(number, kAuditLines, about);
    if (const std::int64_t older = addAudit(page, lines); older > 1)
        page.link(fmt::format("/office/audit?before={}&about={}", older, about), word("audit-older"));
    noteLook(v, "audit seen", isCode ? about : "");
    return {200, page.text()};
}

// Of oneself.

Page ownAccountPage(const Visit& v, const std::string& shown, const std::string& wrong) {
    HtmlReport page = report::sitePage(word("account"), lookerOf(v), "/account");
    wrongOver(page, wrong);
    if (!shown.empty()) page.paragraph(shown, Tone::good);
    page.facts({}, {{word("code"), v.person.code},
                    {word("login"), v.person.login},
                    {word("roles"), rolesInWords(v.person.roles)}});
    FormField old = required(field("old", word("own-old"), {}, "password")),
              fresh = required(field("new", word("first-new"), {}, "password")),
              again = required(field("again", word("first-again"), {}, "password"));
    old.complete = "current-password", fresh.complete = again.complete = "new-password";
    page.form({"/account", {report::tokenField(lookerOf(v)), old, fresh, again}, {{word("own-do")}}});
    page.heading(word("own-stations"));
    page.paragraph(words()("school-office.own-stations-about", school::Books::kTerm / kDay), Tone::note);
    const FormField token = report::tokenField(lookerOf(v));
    for (const school::Station& one : v.books.stationsOf(v.person.code)) {
        if (one.revoked > 0 || one.ends <= v.now) continue;
        page.paragraph(words()("school-office.own-station-until", one.name, report::momentOf(one.ends)));
        page.form({"/account/stations/" + one.id + "/revoke",
                   {token},
                   {{words()("school-office.revoke-do", one.name), {}, {}, true}}});
    }
    page.form(
        {"/account/stations", {token, required(field("name", word("station-name")))}, {{word("own-station-do")}}});
    page.heading(word("own-export"));
    page.link("/account/export", word("export-do"));
    page.heading(word("own-audit"));
    (void)addAudit(page, BooksAccounts(v.books).auditBefore(0, kAuditLines, v.person.code));
    return {200, page.text()};
}

Page addOwnStation(const Visit& v, const Sent& sent) {
    return tried(
        [&] {
            const std::string code = school::newStationCode();
            v.books.offerCode(code, sent("name"), v.now + kDay, actOf(v), "practice", v.person.code);
            return ownAccountPage(v, words()("school-office.own-station-shown", code, code));
        },
        [&](const std::string& wrong) { return ownAccountPage(v, {}, wrong); });
}

Page revokeOwnStation(const Visit& v, const std::string& id) {
    const auto station = v.books.station(id);
    if (!station || station->person != v.person.code) return notYours();
    return tried(
        [&] {
            v.books.revoke(id, actOf(v));
            return back("/account");
        },
        [&](const std::string& wrong) { return ownAccountPage(v, {}, wrong); });
}

Page setOwnPassword(const Visit& v, const Sent& sent, const std::function<void()>& isTheirs) {
    return tried(
        [&]() -> Page {
            if (v.person.password.empty() || sent("old").size() > 256 ||
                !school::isPassword(v.person.password, sent("old")))
                return {400, ownAccountPage(v, {}, word("own-wrong")).body};
            isTheirs();
            if (sent("new") != sent("again")) return {400, ownAccountPage(v, {}, word("first-not-same")).body};
            school::requireGoodPassword(sent("new"), v.person.login);
            v.books.setPassword(v.person.code, school::hashOfPassword(sent("new")), actOf(v));
            // All log-ins are over, this one too.
            return {303, {}, "/login", std::string()};
        },
        [&](const std::string& wrong) { return ownAccountPage(v, {}, wrong); });
}

}  // namespace handpiece::school_server
