// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Who may do what, as one table of data: permission.cpp.

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace handpiece::school {

enum class Role { student, teacher, examiner, administrator };
inline constexpr std::size_t kRoles = 4;
[[nodiscard]] std::optional<Role> roleOf(std::string_view name);
[[nodiscard]] std::string_view nameOf(Role role);

enum class Action {
    seeAttempt,  ///< with session, result and machine's score
    seeName,     ///< whose it is
    seeMarks,    ///< what markers said
    mark,        ///< with the others' marks in sight
    markBlind,
    share,  ///< show practice to others
    comment,
    seeClass,      ///< its page: who did what how well
    watchStation,  ///< live
    assign,        ///< assignments of a class
    rescore,
    setExercise,   ///< exercises, rubrics
    managePeople,  ///< accounts, roles, enrolments
    manageClasses,
    manageStations,
    exportPerson,
    erasePerson,
    seeAudit,
};
inline constexpr std::size_t kActions = 18;
[[nodiscard]] std::string_view nameOf(Action action);

/// How far a role's right to an action goes.
enum class Reach {
    none,
    own,            ///< what is one's own
    inClass,        ///< and what is of a class in which one has that role; not practice that is not shared
    othersInClass,  ///< as inClass, and never one's own
    all,
};
[[nodiscard]] Reach reachOf(Role role, Action action);

/// The thing that it is about, as seen by who asks.
struct Relation {
    bool isOwn = false;           ///< they did it, it is about them
    bool isPrivate = false;       ///< practice of another's own that is not shared
    std::optional<Role> inClass;  ///< their role in its class; nothing: of no class, or of one that is not theirs
};
/// Whether one of the roles gives the right.
[[nodiscard]] bool may(std::span<const Role> roles, Action action, const Relation& relation);

}  // namespace handpiece::school
