// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/school_pages.h"

#include <fmt/format.h>

#include "handpiece/app/report/assessment_words.h"
#include "handpiece/app/report/report_html.h"
#include "handpiece/app/statements/statements.h"
#include "handpiece/base/config/words.h"

namespace handpiece::report {
namespace {

using config::words;
using Cell = HtmlReport::Cell;
using Tone = HtmlReport::Tone;

std::string said(double score, double most) {
    return most > 0.0 ? fmt::format("{:.1f} / {:.1f}", score, most) : words()("school.no-score");
}
std::string stateWord(const std::string& state) {
    return state == "proven"    ? words()("school.proven")
           : state == "refused" ? words()("school.refused")
                                : words()("school.provisional");
}
std::string passedWord(const std::string& passed) {
    return passed == "yes"  ? words()("assessment.passed")
           : passed == "no" ? words()("assessment.not-passed")
                            : words()("assessment.teacher");
}
std::string shownAs(const Names& names, const std::string& code) {
    const auto found = names.find(code);
    return found != names.end() && !found->second.empty() ? found->second : code;
}

}  // namespace

std::string momentOf(school::Milliseconds since1970) {
    std::string text = statements::timestamp(since1970).substr(0, 16);
    text[10] = ' ';
    return text;
}

HtmlReport sitePage(std::string title, const Looker& who, std::string_view address) {
    HtmlReport page(std::move(title));
    std::vector<HtmlReport::Way> ways{{"/classes", words()("school.classes")},
                                      {"/people/" + who.code, words()("school.own-work")}};
    for (const HtmlReport::Way& way : who.ways)
        ways.push_back(way);
    for (HtmlReport::Way& way : ways)
        way.isHere = way.address == address;
    page.ofSite(ways, words()("school.logged-in", who.name.empty() ? who.code : who.name),
                Form{"/logout", {tokenField(who)}, {{words()("school.log-out")}}});
    return page;
}

FormField tokenField(const Looker& who) {
    return {"token", {}, "hidden", who.requestToken};
}

std::string loginPage(const std::string& login, const std::string& wrong, const OtherLogIns& others) {
    HtmlReport page(words()("school.title"));
    page.ofSite({}, {}, {});
    if (!wrong.empty()) page.paragraph(wrong, Tone::bad);
    FormField name{"login", words()("school.login"), "text", login},
        password{"password", words()("school.password"), "password"};
    name.complete = "username", password.complete = "current-password";
    name.isRequired = password.isRequired = true;
    page.form({"/login", {name, password}, {{words()("school.log-in")}}});
    page.link("/first", words()("school-office.have-code"));
    if (others.signOn) page.link("/sign-on", words()("school.sign-on"));
    if (others.platform) page.paragraph(words()("school.by-platform"), Tone::note);
    return page.text();
}

std::string classesPage(const Looker& who, const std::vector<school::SchoolClass>& classes) {
    HtmlReport page = sitePage(words()("school.classes"), who, "/classes");
    if (classes.empty()) page.paragraph(words()("school.no-classes"), Tone::missing);
    std::vector<std::vector<Cell>> rows;
    for (const school::SchoolClass& one : classes)
        rows.push_back({{one.name, "/classes/" + one.id}, {one.closed > 0 ? words()("school.closed") : ""}});
    if (!rows.empty()) page.linkedTable({words()("school.class"), ""}, rows);
    return page.text();
}

std::string classPage(const Looker& who, const school::ClassPage& of, const Names& names,
                      const std::vector<Cell>& rooms) {
    HtmlReport page = sitePage(of.schoolClass.name, who);
    page.link("/classes/" + of.schoolClass.id + "/live", words()("school-live.watch"));
    for (const Cell& room : rooms)
        page.link(room.address, room.text);
    std::vector<std::string> header{words()("class.student")};
    for (const school::Assignment& assignment : of.assignments)
        header.push_back(assignment.title);
    std::map<std::pair<std::string, std::string>, const school::ClassCell*> cells;
    for (const school::ClassCell& cell : of.cells)
        cells[{cell.person, cell.assignment}] = &cell;
    std::vector<std::vector<Cell>> rows;
    for (const school::Person& student : of.students) {
        std::vector<Cell> row{{shownAs(names, student.code), "/people/" + student.code}};
        for (const school::Assignment& assignment : of.assignments) {
            const auto found = cells.find({student.code, assignment.id});
            if (found == cells.end()) {
                row.push_back({"\u2013"});
                continue;
            }
            const school::ClassCell& c = *found->second;
            std::string text = fmt::format("{} ({})", said(c.score, c.maxScore), stateWord(c.state));
            if (c.attempts > 1) text += ", " + words()("school.attempts", c.attempts);
            if (c.marks > 0) text += ", " + words()("school.marks", c.marks);
            row.push_back({std::move(text), "/attempts/" + c.last});
        }
        rows.push_back(std::move(row));
    }
    if (rows.empty())
        page.paragraph(words()("school.no-students"), Tone::missing);
    else
        page.linkedTable(header, rows, words()("school.class-about"));
    for (const school::Assignment& assignment : of.assignments)
        if (assignment.kind == "exam")
            page.link("/exams/" + assignment.id, words()("school-exam.exam-of", assignment.title));
    return page.text();
}

std::string personPage(const Looker& who, const std::string& person, const Names& names,
                       const std::vector<std::pair<school::PushedAttempt, std::optional<school::Score>>>& work) {
    HtmlReport page = sitePage(shownAs(names, person), who, "/people/" + person);
    page.link("/people/" + person + "/curves", words()("school-teaching.results"));
    std::vector<std::vector<Cell>> rows;
    for (auto one = work.rbegin(); one != work.rend(); ++one) {
        const school::Attempt& a = one->first.attempt;
        const bool isThere = one->second.has_value();
        rows.push_back({{momentOf(a.finished), "/attempts/" + a.id},
                        {a.exercise},
                        {isThere ? said(one->second->score, one->second->maxScore) : said(a.score, a.maxScore)},
                        {stateWord(isThere ? one->second->state : "provisional")},
                        {passedWord(isThere ? one->second->passed : a.passed)},
                        {a.device}});
    }
    if (rows.empty())
        page.paragraph(words()("class.no-results"), Tone::missing);
    else
        page.linkedTable({words()("school.finished"), words()("school.exercise"), words()("class.score"),
                          words()("school.state"), words()("class.verdict"), words()("assessment.device")},
                         rows);
    return page.text();
}

std::string attemptPage(const Looker& who, const school::PushedAttempt& p, const Names& names,
                        const std::vector<school::Score>& scores, const std::vector<school::Mark>& marks,
                        const std::vector<school::Comment>& comments, const std::vector<school::Books::Alike>& alike,
                        bool isAnybodys) {
    const school::Attempt& a = p.attempt;
    HtmlReport page = sitePage(fmt::format("{}: {}", shownAs(names, p.person), a.exercise), who);
    if (scores.empty()) {
        page.paragraph(words()("school.waits"), Tone::missing);
    } else {
        const school::Score& s = scores.back();
        page.paragraph(fmt::format("{} {}", stateWord(s.state), said(s.score, s.maxScore)),
                       s.state == "proven" ? Tone::good : Tone::bad);
        if (!s.reason.empty()) page.paragraph(reasonOf(s.reason), s.state == "proven" ? Tone::note : Tone::bad);
        if (!s.result.empty()) page.link("/attempts/" + a.id + "/result", words()("school.whole-result"));
    }
    if (isAnybodys) page.paragraph(words()("school.station-anybodys"), Tone::note);
    for (const school::Books::Alike& one : alike) {
        page.paragraph(words()("school.alike", one.percent, shownAs(names, one.person)), Tone::bad);
        page.link("/attempts/" + one.attempt, words()("school.alike-other"));
    }
    if (!p.files.empty()) page.link("/attempts/" + a.id + "/review", words()("school-live.review"));
    const auto fact = [](const char* word, std::string value) { return std::pair(words()(word), std::move(value)); };
    // By the clock of its station, as far as that can be found to be wrong.
    constexpr school::Milliseconds kAgrees = 60'000;
    if (a.finished > p.received + kAgrees) page.paragraph(words()("school.clock-ahead"), Tone::note);
    page.facts(words()("school.station-says"),
               {fact("school.finished", momentOf(a.finished)), fact("school.received", momentOf(p.received)),
                fact("class.score", said(a.score, a.maxScore)), fact("class.verdict", passedWord(a.passed)),
                fact("assessment.device", a.device), fact("school.worked", fmt::format("{:.0f} s", a.workedS)),
                fact("assessment.exercise", a.exerciseHash)});
    page.heading(words()("school.marks-heading"));
    std::vector<std::vector<Cell>> rows;
    for (const school::Mark& m : marks)
        rows.push_back(
            {{momentOf(m.made)}, {shownAs(names, m.marker)}, {said(m.points, m.maxPoints)}, {passedWord(m.verdict)}});
    if (rows.empty())
        page.paragraph(words()("school.no-marks"), Tone::note);
    else
        page.linkedTable(
            {words()("school.made"), words()("school.marker"), words()("assessment.points"), words()("class.verdict")},
            rows);
    for (const school::Comment& comment : comments)
        page.paragraph(fmt::format("{}: {}", shownAs(names, comment.author), comment.words));
    return page.text();
}

std::string refusalPage(const std::string& what, const std::string& remedy) {
    HtmlReport page(words()("school.title"));
    page.ofSite({}, {}, {});
    page.paragraph(what, Tone::bad);
    if (!remedy.empty()) page.paragraph(remedy, Tone::note);
    page.link("/classes", words()("school.classes"));
    return page.text();
}

}  // namespace handpiece::report
