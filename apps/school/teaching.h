// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A teacher's pages by address: marking, rubrics, re-scoring, exercises, results, standards, exemplars. Who may see
/// which is looked at in each. No HTTP here. docs/school-teaching.md.

#include "school/pages.h"
#include "school/picture_shelf.h"
#include "school/sheet.h"
#include "school/visit.h"

namespace handpiece::school_server {

/// An assignment with what its pages need, and as this person stands to it.
struct Assigned {
    school::Assignment assignment;
    school::Relation relation;
    std::string rubricHash;
    rubric::Rubric rubric;
};
/// None: it is not there, or they may not do that in its class.
[[nodiscard]] std::optional<Assigned> assignedFor(const Visit& visit, const std::string& id, school::Action action);
/// Whoever has works of it to mark still sees nobody's marks before their own are in.
[[nodiscard]] bool marksBlindStill(const Visit& visit, const std::string& assignment);
/// Marks and comments as the attempt's own student sees them: none before they are released.
struct ReleasedMarks {
    std::vector<school::Mark> marks;
    std::vector<school::Comment> comments;
};
[[nodiscard]] ReleasedMarks releasedMarks(const Visit& visit, const school::PushedAttempt& attempt);
/// To be shown at the top of a page that something was done, or what is wrong.
struct Told {
    std::string text{};
    bool isWrong = false;
};

// Marking.
/// All assignments that they may mark.
[[nodiscard]] Page markingOf(const Visit& visit);
[[nodiscard]] Page markingOfClass(const Visit& visit, const std::string& schoolClass);
/// A marker's own works, by their codes.
[[nodiscard]] Page deskOf(const Visit& visit, const std::string& assignment);
[[nodiscard]] Page takeWorks(const Visit& visit, const std::string& assignment);
[[nodiscard]] Page workOf(const Visit& visit, const std::string& assignment, const std::string& code,
                          const TaskOf& taskOf, PictureShelf& pictures);
/// Half or whole: field "do" is "keep" or "give".
[[nodiscard]] Page markWork(const Visit& visit, const std::string& assignment, const std::string& code,
                            const Fields& fields, const TaskOf& taskOf, PictureShelf& pictures);
/// What all markers said, what is to be adjudicated, what students see.
[[nodiscard]] Page marksOf(const Visit& visit, const std::string& assignment, const Told& told = {});
/// Field "do": "difference", "release", "take-back".
[[nodiscard]] Page changeMarks(const Visit& visit, const std::string& assignment, const Fields& fields);
[[nodiscard]] Page adjudicationOf(const Visit& visit, const std::string& attempt, const TaskOf& taskOf,
                                  PictureShelf& pictures);
[[nodiscard]] Page adjudicate(const Visit& visit, const std::string& attempt, const Fields& fields,
                              const TaskOf& taskOf, PictureShelf& pictures);
[[nodiscard]] Page agreementOf(const Visit& visit, const std::string& assignment);

}  // namespace handpiece::school_server
