// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A teacher's pages by address: marking, rubrics, re-scoring, exercises, results, standards, exemplars. Who may see
/// which is looked at in each. No HTTP here. docs/school-teaching.md.

#include <optional>
#include <string>
#include <vector>

#include "handpiece/app/report/report_html.h"
#include "handpiece/assess/rubric/rubric.h"
#include "school/pages.h"
#include "school/readings.h"
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
/// Whether they see what markers said of it.
[[nodiscard]] bool seesMarks(const Visit& visit, const Assigned& of);
/// Marks and comments as the attempt's own student sees them: settled, and no marker's.
struct SchoolsWord {
    std::vector<school::Mark> marks;
    std::vector<school::Comment> comments;
};
[[nodiscard]] SchoolsWord schoolsWordOn(const Visit& visit, const school::PushedAttempt& attempt);
/// The tooth as the attempt leaves it, or why it is not shown.
void addPicture(report::HtmlReport& page, const Visit& visit, const school::PushedAttempt& attempt,
                const std::string& exercise, Readings& readings);
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
                          Readings& readings);
/// Half or whole: field "do" is "keep" or "give".
[[nodiscard]] Page markWork(const Visit& visit, const std::string& assignment, const std::string& code,
                            const Fields& fields, Readings& readings);
/// What all markers said, what is to be adjudicated, what students see.
[[nodiscard]] Page marksOf(const Visit& visit, const std::string& assignment, const Told& told = {});
/// Field "do": "difference", "release", "take-back"; or "release-one", "take-back-one": an attempt.
[[nodiscard]] Page changeMarks(const Visit& visit, const std::string& assignment, const Fields& fields);
[[nodiscard]] Page adjudicationOf(const Visit& visit, const std::string& attempt, Readings& readings);
[[nodiscard]] Page adjudicate(const Visit& visit, const std::string& attempt, const Fields& fields, Readings& readings);
[[nodiscard]] Page agreementOf(const Visit& visit, const std::string& assignment);

// Standards.
/// `showsAll`: to who is no judge.
[[nodiscard]] Page standardOf(const Visit& visit, const std::string& assignment, bool showsAll, const Told& told = {});
/// Field "do": "estimate" (with "round"), "keep" (with "method").
[[nodiscard]] Page changeStandard(const Visit& visit, const std::string& assignment, const Fields& fields);
/// What was kept, a line each.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> keptStandards(const Visit& visit,
                                                                             const std::string& assignment);

// Exemplars.
[[nodiscard]] Page exemplarsOf(const Visit& visit, const std::string& assignment, const Told& told = {});
[[nodiscard]] Page exemplarOf(const Visit& visit, const std::string& attempt, Readings& readings);
/// Field "do": "set", "remove".
[[nodiscard]] Page setExemplar(const Visit& visit, const std::string& attempt, const Fields& fields,
                               Readings& readings);
[[nodiscard]] Page calibrationOf(const Visit& visit, const std::string& assignment, std::size_t number,
                                 Readings& readings);
[[nodiscard]] Page calibrate(const Visit& visit, const std::string& assignment, std::size_t number,
                             const Fields& fields, Readings& readings);
/// Exemplars that this marker has to mark before they begin.
[[nodiscard]] std::size_t exemplarsOpen(const Visit& visit, const std::string& assignment);

// Rubrics and re-scoring.
[[nodiscard]] Page rubricsOf(const Visit& visit);
[[nodiscard]] Page rubricOf(const Visit& visit, const std::string& hash);
[[nodiscard]] Page editRubric(const Visit& visit, const std::string& hash);
/// What came as a form ("of": whose fields they are) or as TOML (`text`): what is wrong with it, or what it changes.
/// Nothing is kept.
[[nodiscard]] Page checkRubric(const Visit& visit, const Fields& fields, const std::string& text);
/// A version of its own.
[[nodiscard]] Page saveRubric(const Visit& visit, const Fields& fields);
[[nodiscard]] Page rescoreOf(const Visit& visit, const std::string& assignment, const Told& told = {});
/// Nothing but how far each is.
[[nodiscard]] Page rescoreProgressOf(const Visit& visit, const std::string& assignment);
/// Field "do": "begin", "again", "count".
[[nodiscard]] Page changeScores(const Visit& visit, const std::string& assignment, const Fields& fields);

// Results.
/// Curves of a class, and what can be taken along.
[[nodiscard]] Page resultsOfClass(const Visit& visit, const std::string& schoolClass, const std::string& home);
/// Curves of a person: of what one may see of their work.
[[nodiscard]] Page curvesOf(const Visit& visit, const std::string& person, const std::string& home);
/// `what`: "attempts.csv", "criteria.csv", "results.zip", "statements.json", "report". Either of a class or of a
/// person. `home`: under which address statements name people and exercises.
[[nodiscard]] Page exportOfClass(const Visit& visit, const std::string& schoolClass, const std::string& what,
                                 const std::string& home);
[[nodiscard]] Page exportOfPerson(const Visit& visit, const std::string& person, const std::string& what,
                                  const std::string& home);

// Exercises and assignments.
[[nodiscard]] Page exercisesOf(const Visit& visit, const Told& told = {});
/// `file`: the bytes of a .handpiece file.
[[nodiscard]] Page addExercise(const Visit& visit, const std::string& file);
[[nodiscard]] Page exerciseOf(const Visit& visit, const std::string& hash, Readings& readings);
/// All that there is of one assignment, for whom.
[[nodiscard]] Page assignmentOf(const Visit& visit, const std::string& assignment, const Told& told = {});
[[nodiscard]] Page setTimes(const Visit& visit, const std::string& assignment, const Fields& fields);
[[nodiscard]] Page assignmentsOf(const Visit& visit, const std::string& schoolClass);
[[nodiscard]] Page assign(const Visit& visit, const std::string& schoolClass, const Fields& fields);

}  // namespace handpiece::school_server
