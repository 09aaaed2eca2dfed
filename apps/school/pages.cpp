// SPDX-License-Identifier: Apache-2.0
#include "school/pages.h"

#include <algorithm>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/report/assessment_report.h"
#include "handpiece/app/report/school_pages.h"
#include "handpiece/base/config/words.h"
#include "handpiece/school/people/permission.h"
#include "handpiece/school/people/secret.h"

namespace handpiece::school_server {
namespace {

using config::words;
using school::Action;
using school::Books;
using school::Relation;
using school::Role;

std::vector<Role> rolesOf(const school::Person& person) {
    std::vector<Role> roles;
    for (const std::string& name : person.roles)
        if (const auto role = school::roleOf(name)) roles.push_back(*role);
    return roles;
}

std::optional<Role> roleIn(const Books& books, const std::string& schoolClass, const std::string& person) {
    for (const school::Enrolment& one : books.enrolments(schoolClass))
        if (one.person == person) return school::roleOf(one.role);
    return {};
}

report::Looker lookerOf(const Visit& v) {
    return {v.person.code, v.person.name, school::requestTokenOf(v.token)};
}

/// An attempt as this person stands to it: of which class its assignment is, and whether it is practice of its own.
Relation relationTo(const Visit& v, const school::PushedAttempt& p) {
    Relation relation;
    relation.isOwn = p.person == v.person.code;
    if (p.assignment.empty()) {
        relation.isPrivate = !relation.isOwn && !v.books.isShared(p.attempt.id);
        // Shared practice is seen by the teachers of one's classes; of one's own and of what is private no class
        // decides.
        if (relation.isOwn || relation.isPrivate) return relation;
        for (const school::SchoolClass& one : v.books.classes())
            if (roleIn(v.books, one.id, p.person) == Role::student)
                if (const auto role = roleIn(v.books, one.id, v.person.code); role && role != Role::student)
                    relation.inClass = role;
    } else if (const auto assignment = v.books.assignment(p.assignment)) {
        relation.inClass = roleIn(v.books, assignment->schoolClass, v.person.code);
    }
    return relation;
}

bool may(const Visit& v, Action action, const Relation& relation) {
    const std::vector<Role> roles = rolesOf(v.person);
    return school::may(roles, action, relation);
}

report::Names namesFor(const Visit& v, const Relation& relation, const std::string& person) {
    report::Names names{{v.person.code, v.person.name}};
    if (may(v, Action::seeName, relation))
        if (const auto one = v.books.person(person)) names[person] = one->name;
    return names;
}

void noteLook(const Visit& v, const char* what, const std::string& about, const std::string& detail = {}) {
    v.books.note({v.person.code, v.now}, what, about, detail);
}

}  // namespace

Page refused(const std::string& what, int status) {
    return {status, report::refusalPage(what, status == 403 ? "" : words()("school.again")), {}, {}};
}

Page classesOf(const Visit& v) {
    std::vector<school::SchoolClass> seen;
    for (const school::SchoolClass& one : v.books.classes()) {
        Relation relation;
        relation.inClass = roleIn(v.books, one.id, v.person.code);
        if (may(v, Action::seeClass, relation)) seen.push_back(one);
    }
    return {200, report::classesPage(lookerOf(v), seen), {}, {}};
}

Page classOf(const Visit& v, const std::string& id) {
    Relation relation;
    relation.inClass = roleIn(v.books, id, v.person.code);
    if (!may(v, Action::seeClass, relation)) return refused(words()("school.not-yours"), 403);
    const school::ClassPage page = v.books.classPage(id);
    report::Names names{{v.person.code, v.person.name}};
    if (may(v, Action::seeName, relation))
        for (const school::Person& student : page.students)
            names[student.code] = student.name;
    noteLook(v, "class seen", "", id);
    return {200, report::classPage(lookerOf(v), page, names), {}, {}};
}

Page personOf(const Visit& v, const std::string& code) {
    // Of all that this person did, what the other may see.
    std::vector<std::pair<school::PushedAttempt, std::optional<school::Score>>> work;
    bool seesAny = code == v.person.code;
    Relation last;
    last.isOwn = seesAny;
    for (school::PushedAttempt& one : v.books.attemptsOf(code)) {
        const Relation relation = relationTo(v, one);
        if (!may(v, Action::seeAttempt, relation)) continue;
        seesAny = true, last = relation;
        const std::vector<school::Score> scores = v.books.scoresOf(one.attempt.id);
        work.emplace_back(std::move(one), scores.empty() ? std::nullopt : std::optional(scores.back()));
    }
    if (!seesAny) return refused(words()("school.not-yours"), 403);
    if (code != v.person.code) noteLook(v, "person seen", code);
    return {200, report::personPage(lookerOf(v), code, namesFor(v, last, code), work), {}, {}};
}

Page attemptOf(const Visit& v, const std::string& id) {
    const auto attempt = v.books.attempt(id);
    const Relation relation = attempt ? relationTo(v, *attempt) : Relation{};
    // What is not there is answered as what one may not see: nobody learns which.
    if (!attempt || !may(v, Action::seeAttempt, relation)) return refused(words()("school.not-yours"), 403);
    if (!relation.isOwn) noteLook(v, "attempt seen", attempt->person, id);
    const bool seesMarks = may(v, Action::seeMarks, relation);
    return {200,
            report::attemptPage(lookerOf(v), *attempt, namesFor(v, relation, attempt->person), v.books.scoresOf(id),
                                seesMarks ? v.books.marksOf(id) : std::vector<school::Mark>{},
                                seesMarks ? v.books.commentsOn(id) : std::vector<school::Comment>{}),
            {},
            {}};
}

Page resultOf(const Visit& v, const std::string& id, const TaskOf& taskOf) {
    const auto attempt = v.books.attempt(id);
    const Relation relation = attempt ? relationTo(v, *attempt) : Relation{};
    if (!attempt || !may(v, Action::seeAttempt, relation)) return refused(words()("school.not-yours"), 403);
    const std::vector<school::Score> scores = v.books.scoresOf(id);
    if (scores.empty() || scores.back().result.empty()) return refused(words()("school.not-there"), 404);
    const school::Score& s = scores.back();
    const score::Result result = assessment::parseResult(s.result, "the books");
    const auto text = v.books.rubric(s.rubric);
    const auto task = taskOf(v.books, result.identity.exerciseHash);
    if (!text || !task) return refused(words()("school.not-there"), 404);
    if (!relation.isOwn) noteLook(v, "result seen", attempt->person, id);
    return {200, report::studentReport(result, *task, rubric::parseRubric(text->text, "rubric " + text->id)), {}, {}};
}

}  // namespace handpiece::school_server
