// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/store/visible.h"

#include "handpiece/school/store/exam_books.h"
#include "handpiece/school/store/teaching.h"

namespace handpiece::school {

Standing standingOf(Books& books, const std::string& attempt) {
    const ExamBooks exams(books);
    Standing standing;
    standing.isExam = exams.sitting(attempt).has_value();
    standing.isDecided = standing.isExam && !exams.decisionsOf(attempt).empty();
    standing.isReleased = Teaching(books).isReleased(attempt);
    return standing;
}

Visible visibleOf(const Eyes& eyes, const Standing& standing) {
    const auto mayDo = [&](Action action) { return may(eyes.roles, action, eyes.relation); };
    const bool isOwn = eyes.relation.isOwn;
    // No machine alone says what an exam is worth: its student waits for a teacher.
    const bool waits = isOwn && standing.isExam && !standing.isDecided;
    Visible v;
    v.exists = v.recording = mayDo(Action::seeAttempt);
    v.whose = mayDo(Action::seeName);
    v.worth = v.reason = v.exists && !waits;
    v.comments = v.decisions = v.exists && mayDo(Action::seeMarks);
    v.marks = v.comments && (isOwn ? standing.isReleased && !waits : !eyes.marksBlind);
    // A student has the school's word, and no marker's name.
    v.markers = v.marks && !isOwn;
    v.doubts = standing.isExam && v.decisions && v.worth;
    v.behindCode = standing.isReleased;
    return v;
}

Visible visibleToItsStudent(const Standing& standing) {
    return visibleOf({{Role::student}, {true, false, {}}, false}, standing);
}

}  // namespace handpiece::school
