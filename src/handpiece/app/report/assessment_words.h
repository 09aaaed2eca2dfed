// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What pages and the window say of a score, in the program's language.

#include <string>

#include "handpiece/assess/score/score.h"

namespace handpiece::report {

/// The id where the rubric has no title.
[[nodiscard]] std::string criterionTitle(const rubric::Rubric& rubric, const std::string& id);
[[nodiscard]] std::string bandTitle(const rubric::Rubric& rubric, const std::string& id);
[[nodiscard]] std::string ruleTitle(const rubric::Rubric& rubric, const std::string& id);
/// passed, not passed, the teacher decides.
[[nodiscard]] std::string verdictOf(score::Passed passed);
/// Why, in one sentence: Assessment::why says it in English.
[[nodiscard]] std::string whyOf(const score::Assessment& assessment, const rubric::Rubric& rubric);
/// An evidence's text, a reason or a proof, which are English, in the program's language where it is known.
[[nodiscard]] std::string said(const std::string& english);
/// Why a server refused work or found another score (school::Score::reason), which is English in the books: likewise.
[[nodiscard]] std::string reasonOf(const std::string& english);
/// "1.52 ± 0.03 mm".
[[nodiscard]] std::string valueOf(const score::CriterionScore& score);
/// Where, in words and numbers.
[[nodiscard]] std::string placeText(const measures::Evidence& evidence);
/// Of AssessmentPictures::View::name.
[[nodiscard]] std::string viewTitle(const std::string& name);

}  // namespace handpiece::report
