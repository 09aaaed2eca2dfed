// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Rubrics and results in the person's language.

#include <QString>

#include "desktop/work/this_language.h"
#include "handpiece/assess/score/score.h"

namespace handpiece::desktop {

/// The graded criteria, a line each: title, what is best, points.
[[nodiscard]] QString whatIsJudged(const rubric::Rubric& rubric);
/// "0.42 ± 0.05 mm"
[[nodiscard]] QString valueWords(const score::CriterionScore& criterion);
[[nodiscard]] QString titleOf(const rubric::Rubric& rubric, const std::string& criterion);
[[nodiscard]] QString bandTitle(const rubric::Rubric& rubric, const std::string& band);
[[nodiscard]] QString passedWords(score::Passed passed);
/// A reason, a proof or what an evidence says, which are English.
[[nodiscard]] QString saidWords(const std::string& english);
/// "7.5 of 10"; empty where there are none.
[[nodiscard]] QString pointsWords(double points, double most);

}  // namespace handpiece::desktop
