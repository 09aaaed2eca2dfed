// SPDX-License-Identifier: Apache-2.0
#include "school/pages.h"

#include <algorithm>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/report/review_page.h"
#include "handpiece/app/report/school_pages.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/file.h"
#include "school/exam_pages.h"
#include "school/readings.h"
#include "school/review_shelf.h"
#include "school/teaching.h"
#include "school/visit.h"

namespace handpiece::school_server {
using config::words;
using school::Action;
using school::Relation;

Page refused(const std::string& what, int status) {
    return {status, report::refusalPage(what, status == 403 || status == 503 ? "" : words()("school.again"))};
}

Page classesOf(const Visit& v) {
    std::vector<school::SchoolClass> seen;
    for (const school::SchoolClass& one : v.books.classes()) {
        if (may(v, Action::seeClass, relationToClass(v, one.id))) seen.push_back(one);
    }
    return {200, report::classesPage(lookerOf(v), seen)};
}

Page classOf(const Visit& v, const std::string& id) {
    const Relation relation = relationToClass(v, id);
    if (!may(v, Action::seeClass, relation)) return notYours();
    const school::ClassPage page = v.books.classPage(id);
    report::Names names{{v.person.code, v.person.name}};
    if (visibleIn(v, relation).whose)
        for (const school::Person& student : page.students)
            names[student.code] = student.name;
    noteLook(v, "class seen", "", id);
    std::vector<report::HtmlReport::Cell> rooms;
    if (may(v, Action::markBlind, relation))
        rooms.push_back({words()("school-teaching.marking"), "/classes/" + id + "/marking"});
    rooms.push_back({words()("school-teaching.results"), "/classes/" + id + "/results"});
    if (may(v, Action::assign, relation))
        rooms.push_back({words()("school-teaching.assignments"), "/classes/" + id + "/assignments"});
    return {200, report::classPage(lookerOf(v), page, names, rooms)};
}

Page personOf(const Visit& v, const std::string& code) {
    // Of all that this person did, what the other may see.
    std::vector<std::pair<school::PushedAttempt, std::optional<school::Score>>> work;
    bool seesAny = code == v.person.code;
    school::Visible last;
    Sight sight(v);
    for (school::PushedAttempt& one : v.books.attemptsOf(code)) {
        const school::Visible seen = sight.of(one);
        if (!seen.exists) continue;
        seesAny = true, last = seen;
        std::vector<school::Score> scores;
        if (seen.worth) scores = v.books.scoresOf(one.attempt.id);
        // No machine alone fails a person.
        if (!scores.empty() && isExam(v, one.attempt.id)) scores.back().passed = "teacher";
        work.emplace_back(std::move(one), scores.empty() ? std::nullopt : std::optional(scores.back()));
    }
    if (!seesAny) return notYours();
    if (code != v.person.code) noteLook(v, "person seen", code);
    return {200, report::personPage(lookerOf(v), code, namesFor(v, last, code), work)};
}

static bool isAnybodys(const Visit& v, const school::PushedAttempt& attempt) {
    const auto station = v.books.station(attempt.station);
    return !attempt.assignment.empty() && station && station->person.empty();
}

Page attemptOf(const Visit& v, const std::string& id) {
    const auto attempt = v.books.attempt(id);
    const school::Visible seen = attempt ? visibleOf(v, *attempt) : school::Visible{};
    if (!seen.exists) return notYours();
    if (isExam(v, id)) return {303, {}, "/sittings/" + id};
    noteLookAt(v, "attempt seen", *attempt);
    std::vector<school::Mark> marks;
    std::vector<school::Comment> comments;
    if (seen.comments) comments = v.books.commentsOn(id);
    if (seen.markers) {
        marks = v.books.marksOf(id);
    } else if (seen.marks) {
        SchoolsWord word = schoolsWordOn(v, *attempt);
        marks = std::move(word.marks);
        for (school::Comment& one : word.comments)
            comments.push_back(std::move(one));
    }
    return {200, report::attemptPage(lookerOf(v), *attempt, namesFor(v, seen, attempt->person),
                                     seen.worth ? v.books.scoresOf(id) : std::vector<school::Score>{}, marks, comments,
                                     seen.markers ? v.books.alike(id) : std::vector<school::Books::Alike>{},
                                     seen.markers && isAnybodys(v, *attempt))};
}

Page resultOf(const Visit& v, const std::string& id, Readings& readings) {
    const auto attempt = v.books.attempt(id);
    if (!attempt || !visibleOf(v, *attempt).worth) return notYours();
    const std::vector<school::Score> scores = v.books.scoresOf(id);
    if (scores.empty() || scores.back().result.empty()) return refused(words()("school.not-there"), 404);
    const school::Score& s = scores.back();
    const score::Result result = assessment::parseResult(s.result, "the books");
    const auto text = v.books.rubric(s.rubric);
    const std::string& exercise = result.identity.exerciseHash;
    if (!text || !v.books.pack(exercise)) return refused(words()("school.not-there"), 404);
    noteLookAt(v, "result seen", *attempt);
    return {200, readings.studentReport(v.books, exercise, s.result, text->text)};
}

Page reviewOf(const Visit& v, const std::string& id, ReviewShelf& shelf) {
    const auto attempt = v.books.attempt(id);
    const school::Visible seen = attempt ? visibleOf(v, *attempt) : school::Visible{};
    if (!seen.recording || !seen.worth) return notYours();  // it has the points that were lost
    const bool isWhole = !attempt->files.empty() && v.books.isWhole(id) &&
                         std::all_of(attempt->files.begin(), attempt->files.end(), [&](const std::string& file) {
                             return core::isThere(v.books.files().path(file));
                         });
    if (!isWhole) return refused(words()("school-live.no-session"), 404);
    ReviewShelf::Answer answer = shelf.ask(*attempt, v.books.scoresOf(id));
    if (answer.page.empty()) {
        Page page{answer.trouble.empty() ? 200 : 500,
                  report::reviewWaitPage(lookerOf(v), id, answer.progress, answer.isBusy, answer.trouble),
                  {},
                  {}};
        page.runsScript = true;
        return page;
    }
    noteLookAt(v, "review seen", *attempt);
    Page page{200, std::move(answer.page), {}, {}};
    page.isReview = true;
    return page;
}

}  // namespace handpiece::school_server
