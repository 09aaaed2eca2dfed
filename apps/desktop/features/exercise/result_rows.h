// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A criterion of a result in words that a student knows: what was measured, what was asked, and why points are gone.

#include <QString>

#include "handpiece/app/course/finished_work.h"

namespace handpiece::desktop {

struct ResultRow {
    QString name, value, asked, points;
    QString why;                             ///< not all of its points, or what else is to be said of it
    QString exact;                           ///< the value with its uncertainty
    QString advice;                          ///< what to do; empty where nothing is off
    std::string exercise;                    ///< that trains it, by its id; empty: none
    const measures::Evidence* at = nullptr;  ///< where to look; null: nowhere
};
/// `of` is one of the work's criteria, and outlives the row.
[[nodiscard]] ResultRow resultRow(const course::FinishedWork& work, const score::CriterionScore& of);
/// In a sentence for the place itself: "depth of the floor: 1.20 mm, asked: 1.5 to 2 mm. 0.3 mm too shallow mesially".
[[nodiscard]] QString placeWords(const ResultRow& row);
/// A critical error as what happened, with where and when.
[[nodiscard]] QString criticalWords(const course::FinishedWork& work, const score::CriticalError& error);
/// "1.48 mm", "5:12 min", "uneven (-7.5)": without what a student cannot use.
[[nodiscard]] QString plainValue(const score::CriterionScore& of);

}  // namespace handpiece::desktop
