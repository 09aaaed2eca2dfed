// SPDX-License-Identifier: Apache-2.0
#include "school/visit.h"

#include <algorithm>

#include "handpiece/base/config/words.h"
#include "handpiece/school/people/secret.h"
#include "school/teaching.h"

namespace handpiece::school_server {

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
    // A way for each room of pages, to those who may see it.
    std::vector<report::HtmlReport::Way> ways;
    const std::vector<Role> roles = rolesOf(v.person);
    const auto has = [&](Role role) { return std::find(roles.begin(), roles.end(), role) != roles.end(); };
    if (has(Role::teacher) || has(Role::examiner))
        ways.push_back({"/marking", config::words()("school-teaching.marking")});
    if (has(Role::teacher)) {
        ways.push_back({"/exercises", config::words()("school-teaching.exercises")});
        ways.push_back({"/rubrics", config::words()("school-teaching.rubrics")});
    }
    const auto office = [](const char* id) { return config::words()(std::string("school-office.") + id); };
    if (may(v, Action::managePeople, {})) ways.push_back({"/office/people", office("people")});
    if (may(v, Action::manageClasses, {})) ways.push_back({"/office/classes", office("classes")});
    if (may(v, Action::manageStations, {})) ways.push_back({"/office/stations", office("stations")});
    if (may(v, Action::seeAudit, {})) ways.push_back({"/office/audit", office("audit")});
    ways.push_back({"/account", office("account")});
    return {v.person.code, v.person.name, school::requestTokenOf(v.token), std::move(ways)};
}

Relation relationToClass(const Visit& v, const std::string& schoolClass) {
    Relation relation;
    relation.inClass = roleIn(v.books, schoolClass, v.person.code);
    return relation;
}

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

school::PushedAttempt workOf(const school::ExamSitting& sitting) {
    school::PushedAttempt work;
    work.attempt.id = sitting.id, work.person = sitting.person, work.assignment = sitting.exam;
    return work;
}

school::Visible Sight::of(const school::PushedAttempt& p) {
    const bool isOwn = p.person == visit_.person.code;
    const auto look = [&] {
        const bool marksBlind = !isOwn && !p.assignment.empty() && marksBlindStill(visit_, p.assignment);
        return school::Eyes{rolesOf(visit_.person), relationTo(visit_, p), marksBlind};
    };
    const school::Standing standing = school::standingOf(visit_.books, p.attempt.id);
    // Of practice each is shared or not by itself.
    if (p.assignment.empty()) return school::visibleOf(look(), standing);
    const auto [place, isNew] = eyes_.try_emplace({p.assignment, isOwn});
    if (isNew) place->second = look();
    return school::visibleOf(place->second, standing);
}

school::Visible visibleOf(const Visit& v, const school::PushedAttempt& attempt) {
    return Sight(v).of(attempt);
}

school::Visible visibleIn(const Visit& v, const Relation& relation, bool marksBlind) {
    return school::visibleOf({rolesOf(v.person), relation, marksBlind}, {});
}

bool may(const Visit& v, Action action, const Relation& relation) {
    const std::vector<Role> roles = rolesOf(v.person);
    return school::may(roles, action, relation);
}

report::Names namesFor(const Visit& v, const school::Visible& seen, const std::string& person) {
    report::Names names{{v.person.code, v.person.name}};
    if (seen.whose)
        if (const auto one = v.books.person(person)) names[person] = one->name;
    return names;
}

school::Act actOf(const Visit& v) {
    return {v.person.code, v.now};
}

void noteLook(const Visit& v, const char* what, const std::string& about, const std::string& detail) {
    v.books.note(actOf(v), what, about, detail);
}

void noteLookAt(const Visit& v, const char* what, const school::PushedAttempt& attempt) {
    if (attempt.person != v.person.code) noteLook(v, what, attempt.person, attempt.attempt.id);
}

Page notYours() {
    return refused(config::words()("school.not-yours"), 403);
}

}  // namespace handpiece::school_server
