// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What to do about what a criterion cost: by how much the value is off, to which side, and where.

#include <string>

#include "handpiece/app/report/bearings.h"
#include "handpiece/app/report/wanted.h"
#include "handpiece/assess/score/score.h"

namespace handpiece::report {

struct Advice {
    Off off = Off::no;
    std::string words;     ///< "0.3 mm too shallow mesially: one more pass there ..."; empty where nothing is off
    std::string fault;     ///< the first part of it: "0.3 mm too shallow mesially"
    std::string exercise;  ///< the id of a shipped one that trains it; empty: none
    const measures::Evidence* at = nullptr;  ///< where it is off most, of the criterion's; null: no place is known
};

/// In the program's language.
[[nodiscard]] Advice adviceOf(const score::CriterionScore& score, const rubric::Rubric& rubric,
                              const Bearings& bearings);
/// Where a value is off most on that side, else where it was taken; null: no place is known.
[[nodiscard]] const measures::Evidence* placeOf(const score::CriterionScore& score, Off off);

/// A critical error as what happened: "The gingiva was cut", in the program's language.
[[nodiscard]] std::string whatHappened(const rubric::Rubric& rubric, const std::string& criterion);
/// The same with where and when: "The gingiva was cut (0.12 N·s, mesially, first at 12.3 s)".
[[nodiscard]] std::string whatHappened(const rubric::Rubric& rubric, const score::CriterionScore& score,
                                       const Bearings& bearings);

}  // namespace handpiece::report
