// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a marker types of a work, as a form and as marks, and what several markers' marks come to.

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "handpiece/app/marking/desk.h"
#include "handpiece/app/report/html_form.h"
#include "handpiece/school/store/books.h"

namespace handpiece::school_server {

/// What a form sent, as it was typed.
using Fields = std::multimap<std::string, std::string>;
/// Empty: nothing.
[[nodiscard]] std::string fieldOf(const Fields& fields, const std::string& name);
/// With a point or a comma; none: it is no finite number.
[[nodiscard]] std::optional<double> numberIn(std::string text);

/// An examiner's impression of the whole work, as borderline regression needs it: 1 fail, 2 borderline, 3 pass, 4 good,
/// 5 excellent.
inline constexpr int kBorderlineRating = 2, kMostRating = 5;
[[nodiscard]] std::string ratingWord(int rating);

/// Of one work.
struct Sheet {
    std::map<std::string, marking::Mark> marks;  ///< by criterion, and marking::kTotal
    std::string verdict;                         ///< "yes", "no", "teacher"
    int rating = 0;                              ///< 0: not said
    std::vector<marking::Comment> comments;
    std::map<std::string, std::string> wrong;  ///< by field: what is wrong, and what to do; empty: it may be given in
};
/// In the program's language.
[[nodiscard]] Sheet readSheet(const rubric::Rubric& rubric, const Fields& fields);
/// The fields of the form, with what is typed and what is wrong.
[[nodiscard]] std::vector<report::FormField> sheetFields(const rubric::Rubric& rubric, const Fields& typed,
                                                         const std::map<std::string, std::string>& wrong);
/// In words: points, a band's title, that it cannot be told, or a dash.
[[nodiscard]] std::string markText(const rubric::Rubric& rubric, const Sheet& sheet, const std::string& id);
/// As the books keep it, half of it too; and back. Only fields of a sheet are in it.
[[nodiscard]] std::string sheetJson(const Fields& fields);
[[nodiscard]] Fields parseSheet(const std::string& json);

/// A whole sheet as a mark of this attempt. `score`: what the server made of it; its hashes go along.
[[nodiscard]] school::Mark markOf(const Sheet& sheet, const rubric::Rubric& rubric, const std::string& rubricHash,
                                  const school::PushedAttempt& attempt, const std::optional<school::Score>& score,
                                  const std::string& id, const std::string& marker, const std::string& kind,
                                  school::Milliseconds now);

/// What marks of one attempt come to.
struct Settled {
    std::vector<school::Mark> markers;  ///< the newest of each, by marker
    std::optional<school::Mark> adjudication;
    double differencePercent = 0.0;  ///< between the highest and the lowest, of the most points
    bool needsAdjudication = false;
    /// Adjudication, else the mean of the markers; none while it needs adjudication or nobody marked.
    std::optional<school::Mark> final;
};
/// `allowedPercent`: they may differ by that much; passing against not passing never.
[[nodiscard]] Settled settle(std::span<const school::Mark> marks, double allowedPercent);

}  // namespace handpiece::school_server
