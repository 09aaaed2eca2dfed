// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a person may see of an attempt: one rule, which pages, exports, statements, curves, audit, live work and grades
/// of other systems ask. docs/school-visibility.md has it route by route.

#include <string>
#include <vector>

#include "handpiece/school/people/permission.h"
#include "handpiece/school/store/books.h"

namespace handpiece::school {

/// Who looks, as they stand to the attempt.
struct Eyes {
    std::vector<Role> roles{};
    Relation relation{};
    bool marksBlind = false;  ///< they have works of its assignment open
};

/// How far the attempt is. What was taken back is as if it had never been released.
struct Standing {
    bool isExam = false;
    bool isDecided = false;   ///< an exam's: a teacher has said what it is
    bool isReleased = false;  ///< its marks
};
[[nodiscard]] Standing standingOf(Books& books, const std::string& attempt);

struct Visible {
    bool exists = false;      ///< that it is there
    bool whose = false;       ///< by name
    bool recording = false;   ///< as it is; a review has what it is worth in it
    bool worth = false;       ///< score, points, criteria
    bool reason = false;      ///< why the server refused it
    bool comments = false;    ///< of those who sign them
    bool marks = false;       ///< what markers said
    bool markers = false;     ///< who said it
    bool decisions = false;   ///< on an exam, by whom and why
    bool doubts = false;      ///< of an exam
    bool behindCode = false;  ///< which work a marker had under a code: to that marker, and in the audit
};
[[nodiscard]] Visible visibleOf(const Eyes& eyes, const Standing& standing);
/// To who did it.
[[nodiscard]] Visible visibleToItsStudent(const Standing& standing);

}  // namespace handpiece::school
