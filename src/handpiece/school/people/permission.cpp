// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/people/permission.h"

#include <algorithm>

namespace handpiece::school {
namespace {

constexpr std::array<std::string_view, kRoles> kRoleNames = {"student", "teacher", "examiner", "administrator"};

struct Line {
    Action action;
    std::string_view name;
    std::array<Reach, kRoles> of;  ///< student, teacher, examiner, administrator
};
constexpr Reach no = Reach::none, own = Reach::own, cls = Reach::inClass, oth = Reach::othersInClass, all = Reach::all;
// An administrator keeps the accounts and does not look at anybody's work; an examiner does not learn whose it is.
constexpr std::array<Line, kActions> kTable = {{
    {Action::seeAttempt, "see-attempt", {own, cls, cls, no}},
    {Action::seeName, "see-name", {own, cls, no, all}},
    {Action::seeMarks, "see-marks", {own, cls, no, no}},
    {Action::mark, "mark", {no, oth, no, no}},
    {Action::markBlind, "mark-blind", {no, oth, oth, no}},
    {Action::share, "share", {own, own, own, no}},
    {Action::comment, "comment", {own, cls, cls, no}},
    {Action::seeClass, "see-class", {no, cls, no, no}},
    {Action::watchStation, "watch-station", {no, cls, no, no}},
    {Action::assign, "assign", {no, cls, no, no}},
    {Action::rescore, "rescore", {no, cls, no, no}},
    {Action::setExercise, "set-exercise", {no, all, no, no}},
    {Action::managePeople, "manage-people", {no, no, no, all}},
    {Action::manageClasses, "manage-classes", {no, no, no, all}},
    {Action::manageStations, "manage-stations", {no, no, no, all}},
    {Action::exportPerson, "export-person", {own, own, own, all}},
    {Action::erasePerson, "erase-person", {no, no, no, all}},
    {Action::seeAudit, "see-audit", {own, own, own, all}},
}};

constexpr bool isInOrder() {
    for (std::size_t i = 0; i < kTable.size(); ++i)
        if (static_cast<std::size_t>(kTable[i].action) != i) return false;
    return true;
}
static_assert(isInOrder(), "one line an action, in their order");

}  // namespace

std::optional<Role> roleOf(std::string_view name) {
    const auto found = std::find(kRoleNames.begin(), kRoleNames.end(), name);
    if (found == kRoleNames.end()) return {};
    return static_cast<Role>(found - kRoleNames.begin());
}

std::string_view nameOf(Role role) {
    return kRoleNames[static_cast<std::size_t>(role)];
}

std::string_view nameOf(Action action) {
    return kTable[static_cast<std::size_t>(action)].name;
}

Reach reachOf(Role role, Action action) {
    return kTable[static_cast<std::size_t>(action)].of[static_cast<std::size_t>(role)];
}

bool may(std::span<const Role> roles, Action action, const Relation& relation) {
    return std::any_of(roles.begin(), roles.end(), [&](Role role) {
        const bool isOfClass = relation.inClass == role && !relation.isPrivate;
        switch (reachOf(role, action)) {
            case Reach::none:
                return false;
            case Reach::own:
                return relation.isOwn;
            case Reach::inClass:
                return relation.isOwn || isOfClass;
            case Reach::othersInClass:
                return isOfClass && !relation.isOwn;
            case Reach::all:
                return true;
        }
        return false;
    });
}

}  // namespace handpiece::school
