// SPDX-License-Identifier: Apache-2.0
// Marks of several, blind, and what becomes of them.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/marking/desk_agreement.h"
#include "handpiece/app/marking/returned_marks.h"
#include "handpiece/app/report/assessment_words.h"
#include "handpiece/app/report/report_html.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash_text.h"
#include "handpiece/school/people/secret.h"
#include "handpiece/school/store/teaching.h"
#include "school/teaching.h"

namespace handpiece::school_server {
namespace {

using config::words;
using report::HtmlReport;
using school::Action;
using school::Teaching;
using Cell = HtmlReport::Cell;
using Tone = HtmlReport::Tone;

std::string at(const std::string& assignment, const std::string& more) {
    return "/assignments/" + assignment + more;
}

/// The desk as the room of marking knows it: codes, order and repeats are a function of seed and batches.
std::vector<marking::DeskItem> itemsOf(const school::MarkingDesk& desk) {
    marking::DeskState state;
    state.isBlind = true;
    state.seed = desk.seed;
    state.batches = desk.batches;
    return marking::itemsOf(state);
}

std::string pointsText(double points, double most) {
    return most > 0.0 ? fmt::format("{:.1f} / {:.1f}", points, most) : words()("school.no-score");
}
std::string verdictText(const std::string& verdict) {
    return verdict == "yes"  ? words()("assessment.passed")
           : verdict == "no" ? words()("assessment.not-passed")
                             : words()("school-teaching.cannot-tell");
}

std::optional<school::Score> countingScore(const school::Books& books, const std::string& attempt) {
    const std::vector<school::Score> scores = books.scoresOf(attempt);
    return scores.empty() ? std::nullopt : std::optional(scores.back());
}

/// A work of a marker's desk behind a code.
struct Found {
    school::MarkingDesk desk;
    std::vector<marking::DeskItem> items;
    std::size_t place = 0;
    school::PushedAttempt attempt;
};
std::optional<Found> find(const Visit& v, const std::string& assignment, const std::string& code) {
    const Teaching teaching(v.books);
    Found found;
    auto desk = teaching.desk(assignment, v.person.code);
    if (!desk) return {};
    found.desk = std::move(*desk);
    found.items = itemsOf(found.desk);
    const auto item = std::find_if(found.items.begin(), found.items.end(),
                                   [&](const marking::DeskItem& one) { return one.code == code; });
    if (item == found.items.end()) return {};
    found.place = static_cast<std::size_t>(item - found.items.begin());
    auto attempt = v.books.attempt(item->workId);
    if (!attempt) return {};
    found.attempt = std::move(*attempt);
    return found;
}

Page sheetPage(const Visit& v, const Assigned& of, const Found& found, const Fields& typed,
               const std::map<std::string, std::string>& wrong, bool isIn, const std::string& told,
               Readings& readings) {
    const std::string& code = found.items[found.place].code;
    HtmlReport page = report::sitePage(words()("school-teaching.work", code), lookerOf(v));
    page.link(at(of.assignment.id, "/marking"), words()("school-teaching.back-to-desk", of.assignment.title));
    page.paragraph(words()("school-teaching.work-of", found.place + 1, found.items.size()), Tone::note);
    if (!told.empty()) page.paragraph(told, Tone::good);
    if (!wrong.empty()) page.paragraph(words()("school-teaching.wrong", wrong.size()), Tone::bad);
    page.begin(HtmlReport::Group::beside);
    addPicture(page, v, found.attempt, of.assignment.pack, readings);
    page.begin(HtmlReport::Group::part);
    page.heading(words()("school-teaching.your-marks"));
    if (isIn) {
        page.paragraph(words()("school-teaching.is-in"), Tone::good);
        std::vector<std::vector<std::string>> rows;
        const Sheet sheet = readSheet(of.rubric, typed);
        for (const std::string& id : marking::askedOf(of.rubric)) {
            if (!sheet.marks.contains(id)) continue;
            rows.push_back(
                {id == marking::kTotal ? words()("agreement.all-points") : report::criterionTitle(of.rubric, id),
                 markText(of.rubric, sheet, id), fieldOf(typed, "c." + id)});
        }
        rows.push_back({words()("class.verdict"), verdictText(sheet.verdict), fieldOf(typed, "comment")});
        if (sheet.rating > 0) rows.push_back({words()("school-teaching.rating"), ratingWord(sheet.rating), ""});
        page.table(
            {words()("assessment.criterion"), words()("school-teaching.mark"), words()("school-teaching.comment")},
            rows);
    } else {
        report::Form form{at(of.assignment.id, "/marking/" + code), {report::tokenField(lookerOf(v))}, {}};
        for (report::FormField& field : sheetFields(of.rubric, typed, wrong))
            form.fields.push_back(std::move(field));
        form.buttons = {{words()("school-teaching.give-in"), "do", "give"},
                        {words()("school-teaching.keep"), "do", "keep"}};
        page.form(form);
        page.paragraph(words()("school-teaching.give-in-about"), Tone::note);
    }
    page.end();
    page.end();
    if (found.place + 1 < found.items.size())
        page.link(at(of.assignment.id, "/marking/" + found.items[found.place + 1].code),
                  words()("school-teaching.next-work"));
    return {wrong.empty() ? 200 : 422, page.text()};
}

/// What one marker said, as rows can have it.
std::string said(const rubric::Rubric& rubric, const marking::ReturnedMarks& marks, const std::string& criterion) {
    std::string text = "\u2013";
    for (const auto& c : marks.changes) {
        if (c.criterion != criterion) continue;
        text = c.band.empty() ? std::string() : report::bandTitle(rubric, c.band);
        if (c.points) text += fmt::format("{}{:g} / {:g}", text.empty() ? "" : ", ", *c.points, c.maxPoints);
    }
    for (const marking::Comment& one : marks.comments)
        if (one.criterion == criterion) text += ": " + one.text;
    return text;
}

Page adjudicationPage(const Visit& v, const Assigned& of, const school::PushedAttempt& attempt, const Fields& typed,
                      const std::map<std::string, std::string>& wrong, Readings& readings) {
    const Teaching teaching(v.books);
    const Settled settled = settle(v.books.marksOf(attempt.attempt.id), teaching.differenceAllowed(of.assignment.id));
    HtmlReport page =
        report::sitePage(words()("school-teaching.adjudicate-title", attempt.attempt.id.substr(0, 6)), lookerOf(v));
    page.link(at(of.assignment.id, "/marks"), words()("school-teaching.back-to-marks", of.assignment.title));
    page.link("/attempts/" + attempt.attempt.id, words()("school-teaching.attempt"));
    page.link("/attempts/" + attempt.attempt.id + "/review", words()("school-live.review"));
    if (!wrong.empty()) page.paragraph(words()("school-teaching.wrong", wrong.size()), Tone::bad);
    page.begin(HtmlReport::Group::beside);
    addPicture(page, v, attempt, of.assignment.pack, readings);
    page.begin(HtmlReport::Group::part);
    page.heading(words()("school-teaching.markers-said"));
    std::vector<school::Mark> all = settled.markers;
    if (settled.adjudication) all.push_back(*settled.adjudication);
    if (all.empty()) page.paragraph(words()("school.no-marks"), Tone::note);
    std::vector<std::string> header{words()("assessment.criterion")};
    std::vector<marking::ReturnedMarks> read;
    for (const school::Mark& mark : all) {
        header.push_back(mark.kind == "adjudication" ? words()("school-teaching.adjudicated-by", mark.marker)
                                                     : mark.marker);
        read.push_back(marking::parseReturned(mark.marks, "the books"));
    }
    std::vector<std::vector<std::string>> rows;
    for (const rubric::Criterion& c : of.rubric.criteria) {
        if (!c.isGraded() && c.bands.empty()) continue;
        std::vector<std::string> row{report::criterionTitle(of.rubric, c.id)};
        for (const marking::ReturnedMarks& one : read)
            row.push_back(said(of.rubric, one, c.id));
        rows.push_back(std::move(row));
    }
    std::vector<std::string> points{words()("agreement.all-points")}, verdicts{words()("class.verdict")},
        comments{words()("school-teaching.comment-whole")};
    for (std::size_t i = 0; i < all.size(); ++i) {
        points.push_back(pointsText(all[i].points, all[i].maxPoints));
        verdicts.push_back(verdictText(all[i].verdict));
        std::string text;
        for (const marking::Comment& one : read[i].comments)
            if (one.criterion.empty()) text += (text.empty() ? "" : " ") + one.text;
        comments.push_back(std::move(text));
    }
    for (auto* row : {&points, &verdicts, &comments})
        rows.push_back(std::move(*row));
    if (!all.empty()) page.table(header, rows, words()("school-teaching.markers-said"));
    page.heading(words()("school-teaching.adjudicate"));
    page.paragraph(words()("school-teaching.adjudicate-about"), Tone::note);
    report::Form form{"/attempts/" + attempt.attempt.id + "/adjudication", {report::tokenField(lookerOf(v))}, {}};
    for (report::FormField& field : sheetFields(of.rubric, typed, wrong))
        form.fields.push_back(std::move(field));
    form.buttons = {{words()("school-teaching.adjudicate")}};
    page.form(form);
    page.end();
    page.end();
    return {wrong.empty() ? 200 : 422, page.text()};
}

/// A work of an assignment whose marks they may see and judge; never their own.
std::optional<std::pair<Assigned, school::PushedAttempt>> toAdjudicate(const Visit& v, const std::string& id) {
    auto attempt = v.books.attempt(id);
    if (!attempt || attempt->assignment.empty() || !may(v, Action::mark, relationTo(v, *attempt))) return {};
    auto of = assignedFor(v, attempt->assignment, Action::mark);
    if (!of || !visibleOf(v, *attempt).marks) return {};
    return std::pair(std::move(*of), std::move(*attempt));
}

std::string markId(const school::MarkingSheet& sheet) {
    return school::sha256(sheet.assignment + "\n" + sheet.marker + "\n" + sheet.code).substr(0, 32);
}

std::uint64_t newSeed() {
    return core::readHash(school::newSecret().substr(0, 16)).value();
}

}  // namespace

std::optional<Assigned> assignedFor(const Visit& v, const std::string& id, Action action) {
    auto assignment = v.books.assignment(id);
    if (!assignment) return {};
    Assigned of{std::move(*assignment), {}, {}, {}};
    of.relation = relationToClass(v, of.assignment.schoolClass);
    if (!may(v, action, of.relation)) return {};
    of.rubricHash = of.assignment.rubric;
    if (const auto text = v.books.rubric(of.rubricHash)) of.rubric = rubric::parseRubric(text->text, text->id);
    return of;
}

void addPicture(HtmlReport& page, const Visit& v, const school::PushedAttempt& attempt, const std::string& exercise,
                Readings& readings) {
    if (!v.books.pack(exercise)) return page.paragraph(words()("school.not-there"), Tone::missing);
    const Readings::Picture drawn = readings.picture(v.books, attempt, exercise);
    if (drawn.png.empty())
        page.paragraph(words()("report.no-pictures", drawn.missing), Tone::missing);
    else
        page.picture(std::span(drawn.png), words()("school-teaching.picture"));
}

bool marksBlindStill(const Visit& v, const std::string& assignment) {
    const Teaching teaching(v.books);
    const auto desk = teaching.desk(assignment, v.person.code);
    if (!desk) return false;
    std::set<std::string> in;
    for (const school::MarkingSheet& sheet : teaching.sheets(assignment, v.person.code))
        if (sheet.isIn) in.insert(sheet.code);
    const std::vector<marking::DeskItem> items = itemsOf(*desk);
    return std::any_of(items.begin(), items.end(), [&](const marking::DeskItem& item) {
        return !in.contains(item.code) && v.books.attempt(item.workId);
    });
}

bool seesMarks(const Visit& v, const Assigned& of) {
    return visibleIn(v, of.relation, marksBlindStill(v, of.assignment.id)).marks;
}

SchoolsWord schoolsWordOn(const Visit& v, const school::PushedAttempt& attempt) {
    const Settled settled =
        settle(v.books.marksOf(attempt.attempt.id), Teaching(v.books).differenceAllowed(attempt.assignment));
    if (!settled.final) return {};
    SchoolsWord word{{*settled.final}, {}};
    word.marks.front().marker = words()("school-teaching.school");
    std::vector<school::Mark> from =
        settled.adjudication ? std::vector<school::Mark>{*settled.adjudication} : settled.markers;
    const auto text = v.books.assignment(attempt.assignment);
    const auto version = text ? v.books.rubric(text->rubric) : std::nullopt;
    const rubric::Rubric rubric = version ? rubric::parseRubric(version->text, version->id) : rubric::Rubric{};
    for (const school::Mark& mark : from)
        for (const marking::Comment& one : marking::parseReturned(mark.marks, "the books").comments)
            word.comments.push_back({{},
                                     attempt.attempt.id,
                                     one.criterion.empty() ? words()("school-teaching.whole-work")
                                                           : report::criterionTitle(rubric, one.criterion),
                                     one.text,
                                     {},
                                     {},
                                     mark.made});
    return word;
}

Page markingOf(const Visit& v) {
    const std::vector<school::Role> roles = rolesOf(v.person);
    // Who may mark in some class, also where there is none yet.
    if (std::none_of(roles.begin(), roles.end(),
                     [](school::Role role) { return school::reachOf(role, Action::markBlind) != school::Reach::none; }))
        return notYours();
    HtmlReport page = report::sitePage(words()("school-teaching.marking"), lookerOf(v), "/marking");
    bool isAny = false;
    for (const school::SchoolClass& one : v.books.classes()) {
        if (!may(v, Action::markBlind, relationToClass(v, one.id))) continue;
        isAny = true;
        page.link("/classes/" + one.id + "/marking", one.name);
    }
    if (!isAny) page.paragraph(words()("school-teaching.no-marking"), Tone::missing);
    return {200, page.text()};
}

Page markingOfClass(const Visit& v, const std::string& schoolClass) {
    const school::Relation relation = relationToClass(v, schoolClass);
    if (!may(v, Action::markBlind, relation)) return notYours();
    const Teaching teaching(v.books);
    std::string name = schoolClass;
    for (const school::SchoolClass& one : v.books.classes())
        if (one.id == schoolClass) name = one.name;
    HtmlReport page = report::sitePage(words()("school-teaching.marking-of", name), lookerOf(v));
    page.link("/marking", words()("school-teaching.marking"));
    const bool seesMarks = may(v, Action::mark, relation);
    std::vector<std::vector<Cell>> rows;
    for (const school::Assignment& a : v.books.assignments(schoolClass)) {
        const auto desk = teaching.desk(a.id, v.person.code);
        const std::size_t all = desk ? itemsOf(*desk).size() : 0;
        std::size_t in = 0;
        for (const school::MarkingSheet& sheet : teaching.sheets(a.id, v.person.code))
            in += sheet.isIn ? 1 : 0;
        std::vector<Cell> row{
            {a.title, at(a.id, "")},
            {words()("school-teaching.your-desk"), at(a.id, "/marking")},
            {desk ? words()("school-teaching.in-of", in, all) : words()("school-teaching.not-begun")}};
        if (seesMarks) row.push_back({words()("school-teaching.all-marks"), at(a.id, "/marks")});
        rows.push_back(std::move(row));
    }
    std::vector<std::string> header{words()("school-teaching.assignment"), words()("school-teaching.your-desk"),
                                    words()("school.state")};
    if (seesMarks) header.push_back(words()("school-teaching.all-marks"));
    if (rows.empty())
        page.paragraph(words()("school-teaching.no-assignments"), Tone::missing);
    else
        page.linkedTable(header, rows, words()("school-teaching.marking-about"));
    return {200, page.text()};
}

Page deskOf(const Visit& v, const std::string& assignment) {
    const auto of = assignedFor(v, assignment, Action::markBlind);
    if (!of) return notYours();
    const Teaching teaching(v.books);
    HtmlReport page = report::sitePage(words()("school-teaching.desk", of->assignment.title), lookerOf(v));
    page.link("/classes/" + of->assignment.schoolClass + "/marking", words()("school-teaching.back-to-class"));
    page.paragraph(words()("school-teaching.desk-about"), Tone::note);
    std::map<std::string, school::MarkingSheet> sheets;
    for (school::MarkingSheet& sheet : teaching.sheets(assignment, v.person.code))
        sheets[sheet.code] = std::move(sheet);
    const auto desk = teaching.desk(assignment, v.person.code);
    const std::vector<marking::DeskItem> items = desk ? itemsOf(*desk) : std::vector<marking::DeskItem>{};
    std::vector<std::vector<Cell>> rows;
    std::size_t in = 0;
    for (const marking::DeskItem& item : items) {
        const auto sheet = sheets.find(item.code);
        const bool isIn = sheet != sheets.end() && sheet->second.isIn;
        in += isIn ? 1 : 0;
        rows.push_back({{item.code, at(assignment, "/marking/" + item.code)},
                        {isIn                    ? words()("school-teaching.given-in")
                         : sheet != sheets.end() ? words()("school-teaching.half")
                                                 : words()("school-teaching.open")}});
    }
    if (!items.empty()) {
        page.progress(static_cast<double>(in), static_cast<double>(items.size()),
                      words()("school-teaching.in-of", in, items.size()));
        page.linkedTable({words()("school-teaching.code"), words()("school.state")}, rows,
                         words()("school-teaching.works-by-code"));
        if (in == items.size()) page.paragraph(words()("school-teaching.all-in"), Tone::good);
    }
    std::size_t waiting = 0;
    for (const std::string& id : teaching.worksOf(assignment)) {
        const bool isThere =
            std::any_of(items.begin(), items.end(), [&](const marking::DeskItem& item) { return item.workId == id; });
        const auto attempt = v.books.attempt(id);
        waiting += !isThere && attempt && attempt->person != v.person.code ? 1 : 0;
    }
    if (const std::size_t open = items.empty() ? exemplarsOpen(v, assignment) : 0; open > 0) {
        page.paragraph(words()("school-teaching.exemplars-first", open), Tone::missing);
        page.link(at(assignment, "/exemplars"), words()("school-teaching.exemplars"));
    } else if (waiting > 0) {
        page.form({at(assignment, "/marking"),
                   {report::tokenField(lookerOf(v))},
                   {{words()(items.empty() ? "school-teaching.begin" : "school-teaching.take-more", waiting)}}});
    } else if (items.empty()) {
        page.paragraph(words()("school-teaching.no-works"), Tone::missing);
    }
    return {200, page.text()};
}

Page takeWorks(const Visit& v, const std::string& assignment) {
    const auto of = assignedFor(v, assignment, Action::markBlind);
    if (!of) return notYours();
    if (!Teaching(v.books).desk(assignment, v.person.code) && exemplarsOpen(v, assignment) > 0)
        return {303, {}, at(assignment, "/exemplars")};
    (void)Teaching(v.books).takeWorks(assignment, v.person.code, newSeed(), actOf(v));
    return {303, {}, at(assignment, "/marking")};
}

Page workOf(const Visit& v, const std::string& assignment, const std::string& code, Readings& readings) {
    const auto of = assignedFor(v, assignment, Action::markBlind);
    const auto found = of ? find(v, assignment, code) : std::nullopt;
    if (!found) return notYours();
    noteLook(v, "work seen blind", found->attempt.attempt.id, assignment);
    const auto sheet = Teaching(v.books).sheet(assignment, v.person.code, code);
    return sheetPage(v, *of, *found, sheet ? parseSheet(sheet->content) : Fields{}, {}, sheet && sheet->isIn, {},
                     readings);
}

Page markWork(const Visit& v, const std::string& assignment, const std::string& code, const Fields& fields,
              Readings& readings) {
    const auto of = assignedFor(v, assignment, Action::markBlind);
    const auto found = of ? find(v, assignment, code) : std::nullopt;
    if (!found) return notYours();
    Teaching teaching(v.books);
    school::MarkingSheet sheet{assignment, v.person.code, code, found->attempt.attempt.id, sheetJson(fields)};
    if (fieldOf(fields, "do") != "give") {
        if (!teaching.save(sheet, {}, actOf(v)))
            return sheetPage(v, *of, *found, parseSheet(teaching.sheet(assignment, v.person.code, code)->content), {},
                             true, {}, readings);
        return sheetPage(v, *of, *found, fields, {}, false, words()("school-teaching.kept"), readings);
    }
    const Sheet read = readSheet(of->rubric, fields);
    if (!read.wrong.empty()) {
        // What is typed so far is not lost whatever becomes of this page.
        (void)teaching.save(sheet, {}, actOf(v));
        return sheetPage(v, *of, *found, fields, read.wrong, false, {}, readings);
    }
    sheet.isIn = true;
    std::optional<school::Mark> mark;
    // The second mark of a work that comes twice tells how even the marker is, and is none of the student's.
    if (!found->items[found->place].isRepeat)
        mark = markOf(read, of->rubric, of->rubricHash, found->attempt,
                      countingScore(v.books, found->attempt.attempt.id), markId(sheet), v.person.code, "blind", v.now);
    (void)teaching.save(sheet, mark, actOf(v));
    // On to the next that is open.
    std::set<std::string> in;
    for (const school::MarkingSheet& one : teaching.sheets(assignment, v.person.code))
        if (one.isIn) in.insert(one.code);
    for (std::size_t i = 1; i < found->items.size(); ++i) {
        const std::string& next = found->items[(found->place + i) % found->items.size()].code;
        if (!in.contains(next)) return {303, {}, at(assignment, "/marking/" + next)};
    }
    return {303, {}, at(assignment, "/marking")};
}

Page marksOf(const Visit& v, const std::string& assignment, const Told& told) {
    const auto of = assignedFor(v, assignment, Action::mark);
    if (!of) return notYours();
    const Teaching teaching(v.books);
    const double allowed = teaching.differenceAllowed(assignment);
    HtmlReport page = report::sitePage(words()("school-teaching.marks-of", of->assignment.title), lookerOf(v));
    page.link("/classes/" + of->assignment.schoolClass + "/marking", words()("school-teaching.back-to-class"));
    page.link(at(assignment, "/agreement"), words()("school-teaching.agreement"));
    if (!told.text.empty()) page.paragraph(told.text, told.isWrong ? Tone::bad : Tone::good);
    if (!seesMarks(v, *of)) {
        page.paragraph(words()("school-teaching.give-in-first"), Tone::missing);
        page.link(at(assignment, "/marking"), words()("school-teaching.your-desk"));
        return {200, page.text()};
    }
    std::map<std::string, std::vector<school::Mark>> byAttempt;
    std::set<std::string> markers;
    for (const std::string& id : teaching.worksOf(assignment))
        byAttempt[id];
    for (school::Mark& mark : teaching.marksOn(assignment)) {
        if (mark.kind != "adjudication") markers.insert(mark.marker);
        byAttempt[mark.attempt].push_back(std::move(mark));
    }
    // Of who was a student of the class before: nobody sees who marked their own.
    for (const school::PushedAttempt& own : v.books.attemptsOf(v.person.code, assignment))
        if (!visibleOf(v, own).markers) byAttempt.erase(own.attempt.id);
    const std::set<std::string> released = teaching.released(assignment);
    std::vector<std::string> header{words()("school-teaching.attempt")};
    for (const std::string& marker : markers)
        header.push_back(marker);
    for (const char* word : {"school-teaching.difference", "school-teaching.final", "school-teaching.released"})
        header.push_back(words()(word));
    std::vector<std::vector<Cell>> rows;
    std::vector<report::FormButton> single;
    std::size_t settledCount = 0, open = 0;
    for (const auto& [id, marks] : byAttempt) {
        const Settled settled = settle(marks, allowed);
        std::vector<Cell> row{{id.substr(0, 6), "/attempts/" + id + "/adjudication"}};
        for (const std::string& marker : markers) {
            const auto mark = std::find_if(settled.markers.begin(), settled.markers.end(),
                                           [&](const school::Mark& one) { return one.marker == marker; });
            row.push_back(
                {mark == settled.markers.end()
                     ? "\u2013"
                     : fmt::format("{}, {}", pointsText(mark->points, mark->maxPoints), verdictText(mark->verdict))});
        }
        row.push_back({settled.markers.size() > 1 ? fmt::format("{:.1f} %", settled.differencePercent) : "\u2013"});
        if (settled.needsAdjudication)
            row.push_back({words()("school-teaching.to-adjudicate"), "/attempts/" + id + "/adjudication"});
        else
            row.push_back({settled.final
                               ? fmt::format("{}, {}", pointsText(settled.final->points, settled.final->maxPoints),
                                             verdictText(settled.final->verdict))
                               : "\u2013"});
        row.push_back({released.contains(id) ? words()("school-teaching.released") : ""});
        if (released.contains(id))
            single.push_back({words()("school-teaching.take-back-one", id.substr(0, 6)), "take-back-one", id, true});
        else if (settled.final)
            single.push_back({words()("school-teaching.release-one", id.substr(0, 6)), "release-one", id});
        settledCount += settled.final ? 1 : 0;
        open += settled.needsAdjudication ? 1 : 0;
        rows.push_back(std::move(row));
    }
    if (rows.empty())
        page.paragraph(words()("school-teaching.no-works"), Tone::missing);
    else
        page.linkedTable(
            header, rows,
            words()("school-teaching.marks-about", settledCount, rows.size(), open, fmt::format("{:g}", allowed)));
    const report::FormField token = report::tokenField(lookerOf(v));
    page.heading(words()("school-teaching.release-heading"));
    page.paragraph(words()("school-teaching.release-about"), Tone::note);
    page.form({at(assignment, "/marks"),
               {token},
               {{words()("school-teaching.release"), "do", "release"},
                {words()("school-teaching.take-back"), "do", "take-back", true}}});
    if (!single.empty()) page.form({at(assignment, "/marks"), {token}, std::move(single)});
    page.heading(words()("school-teaching.difference-heading"));
    report::FormField difference{"percent", words()("school-teaching.difference-label"), "text",
                                 fmt::format("{:g}", allowed)};
    difference.hint = words()("school-teaching.difference-hint");
    page.form({at(assignment, "/marks"), {token, difference}, {{words()("school-teaching.set"), "do", "difference"}}});
    noteLook(v, "marks seen", "", assignment);
    return {told.isWrong ? 422 : 200, page.text()};
}

Page changeMarks(const Visit& v, const std::string& assignment, const Fields& fields) {
    const auto of = assignedFor(v, assignment, Action::mark);
    if (!of) return notYours();
    Teaching teaching(v.books);
    const std::string one = fieldOf(fields, "release-one"), back = fieldOf(fields, "take-back-one"), only = one + back,
                      what = !one.empty()    ? "release"
                             : !back.empty() ? "take-back"
                                             : fieldOf(fields, "do");
    if (what == "difference") {
        const std::optional<double> percent = numberIn(fieldOf(fields, "percent"));
        if (!percent || *percent < 0.0 || *percent > 100.0)
            return marksOf(v, assignment, {words()("school-teaching.difference-wrong"), true});
        teaching.setDifferenceAllowed(assignment, *percent, actOf(v));
        return {303, {}, at(assignment, "/marks")};
    }
    std::vector<std::string> attempts;
    if (what == "release") {
        std::map<std::string, std::vector<school::Mark>> byAttempt;
        for (school::Mark& mark : teaching.marksOn(assignment))
            byAttempt[mark.attempt].push_back(std::move(mark));
        for (const auto& [id, marks] : byAttempt)
            if (settle(marks, teaching.differenceAllowed(assignment)).final) attempts.push_back(id);
    } else if (what == "take-back") {
        const std::set<std::string> released = teaching.released(assignment);
        attempts.assign(released.begin(), released.end());
    } else {
        return refused(words()("school.not-there"), 400);
    }
    if (!only.empty()) {
        std::erase_if(attempts, [&only](const std::string& id) { return id != only; });
        if (attempts.empty()) return marksOf(v, assignment, {words()("school-teaching.not-to-release"), true});
    }
    teaching.release(attempts, what == "release", actOf(v));
    return marksOf(v, assignment,
                   {words()(what == "release" ? "school-teaching.released-count" : "school-teaching.taken-back-count",
                            attempts.size())});
}

Page adjudicationOf(const Visit& v, const std::string& id, Readings& readings) {
    const auto of = toAdjudicate(v, id);
    if (!of) return notYours();
    noteLook(v, "marks seen", id);
    return adjudicationPage(v, of->first, of->second, {}, {}, readings);
}

Page adjudicate(const Visit& v, const std::string& id, const Fields& fields, Readings& readings) {
    const auto of = toAdjudicate(v, id);
    if (!of) return notYours();
    const Sheet read = readSheet(of->first.rubric, fields);
    if (!read.wrong.empty()) return adjudicationPage(v, of->first, of->second, fields, read.wrong, readings);
    (void)v.books.push(markOf(read, of->first.rubric, of->first.rubricHash, of->second, countingScore(v.books, id),
                              school::newId(), v.person.code, "adjudication", v.now),
                       actOf(v));
    return {303, {}, at(of->first.assignment.id, "/marks")};
}

Page agreementOf(const Visit& v, const std::string& assignment) {
    const auto of = assignedFor(v, assignment, Action::mark);
    if (!of) return notYours();
    const Teaching teaching(v.books);
    HtmlReport page = report::sitePage(words()("school-teaching.agreement-of", of->assignment.title), lookerOf(v));
    page.link(at(assignment, "/marks"), words()("school-teaching.back-to-marks", of->assignment.title));
    if (!seesMarks(v, *of)) {
        page.paragraph(words()("school-teaching.give-in-first"), Tone::missing);
        return {200, page.text()};
    }
    const std::vector<std::string> asked = marking::askedOf(of->rubric);
    std::string csv = marking::marksHead();
    std::set<std::string> works;
    for (const school::MarkingDesk& desk : teaching.desks(assignment)) {
        std::map<std::string, school::MarkingSheet> sheets;
        for (school::MarkingSheet& sheet : teaching.sheets(assignment, desk.marker))
            if (sheet.isIn) sheets[sheet.code] = std::move(sheet);
        const std::vector<marking::DeskItem> items = itemsOf(desk);
        for (const marking::DeskItem& item : items) {
            const auto sheet = sheets.find(item.code);
            if (sheet == sheets.end()) continue;
            works.insert(item.workId);
            csv += marking::marksLines(item.workId, desk.marker + (item.isRepeat ? marking::kAgain : ""), asked,
                                       readSheet(of->rubric, parseSheet(sheet->second.content)).marks);
        }
    }
    for (const school::Score& score : teaching.scores(assignment)) {
        if (!works.contains(score.attempt) || score.result.empty() || score.rubric != of->rubricHash) continue;
        csv += marking::machineLines(score.attempt, of->rubric, asked,
                                     assessment::parseResult(score.result, "the books").assessment);
    }
    constexpr std::size_t kDraws = 500;  // of each interval: a page shall not keep one waiting
    const marking::DeskAgreement agreement = marking::agreementOfMarks(of->rubric, csv, "the books", kDraws);
    if (agreement.criteria.empty()) {
        page.paragraph(words()("school-teaching.no-agreement"), Tone::missing);
        return {200, page.text()};
    }
    page.paragraph(words()("school-teaching.agreement-about", works.size(), kDraws), Tone::note);
    const auto estimate = [](const agreement::Estimate& one) {
        if (!one.value) return report::said(one.reason);
        std::string text = fmt::format("{:.2f}", *one.value);
        if (one.interval) text += fmt::format(" ({:.2f} \u2013 {:.2f})", one.interval->low, one.interval->high);
        return text;
    };
    for (const assessment::CriterionAgreement& c : agreement.criteria) {
        page.heading(c.title);
        std::vector<std::vector<std::string>> rows;
        for (const assessment::RaterPair& p : c.pairs) {
            std::string kappa = p.linear  ? estimate(*p.linear)
                                : p.kappa ? estimate(*p.kappa)
                                          : "",
                        bias = "", limits = "";
            if (p.blandAltman && p.blandAltman->bias) bias = fmt::format("{:+.2f}", *p.blandAltman->bias);
            if (p.blandAltman && p.blandAltman->low)
                limits = fmt::format("{:.2f} \u2013 {:.2f}", *p.blandAltman->low, *p.blandAltman->high);
            rows.push_back({fmt::format("{}, {}", marking::raterName(p.first), marking::raterName(p.second)),
                            fmt::format("{}", p.items), kappa, bias, limits});
        }
        if (!rows.empty())
            page.table({words()("school-teaching.raters"), words()("class.count"), words()("school-teaching.kappa"),
                        words()("school-teaching.bias"), words()("school-teaching.limits")},
                       rows, words()("school-teaching.pairs"));
        rows.clear();
        if (c.icc) rows.push_back({"ICC(2,1)", estimate(c.icc->two1)});
        for (const assessment::Alpha& alpha : c.alphas)
            rows.push_back({words()("school-teaching.alpha",
                                    alpha.level == agreement::Level::nominal    ? words()("school-teaching.nominal")
                                    : alpha.level == agreement::Level::ordinal  ? words()("school-teaching.ordinal")
                                    : alpha.level == agreement::Level::interval ? words()("school-teaching.interval")
                                                                                : words()("school-teaching.ratio")),
                            estimate(alpha.estimate)});
        if (!rows.empty())
            page.table({words()("school-teaching.coefficient"), words()("school-teaching.value-interval")}, rows,
                       words()("school-teaching.all-raters"));
    }
    noteLook(v, "agreement seen", "", assignment);
    return {200, page.text()};
}

}  // namespace handpiece::school_server
