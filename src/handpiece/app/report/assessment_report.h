// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A score as a page to read and to print: for the student who made the preparation, and for a class.

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/assess/score/score.h"
#include "handpiece/assess/task/task.h"

namespace handpiece::report {

struct Review;

using Png = std::vector<std::byte>;

/// What assessmentPictures() draws (assessment_pictures.h); the page does without whatever is not there.
struct AssessmentPictures {
    /// The same view of one's own tooth, of the ideal, and of the deviation from it; empty where one is missing.
    struct View {
        std::string name;  ///< "occlusal", "buccal", ...; "section-mesial" and "section-buccal" are cut open
        Png own, ideal, deviation;
        std::string outlines;  ///< of a section: own and ideal as lines, one `<svg>`; needs no OpenGL
    };
    std::vector<View> views;
    std::map<std::string, Png> places;  ///< by criterion: where its value was measured, the eye turned there
    Png undone;                         ///< where most is still to be cut; empty: the work is done
    std::string missing;                ///< why there are none, in the program's language; empty where there are
};

/// Deviation from the ideal is coloured up to this [mm].
inline constexpr double kDeviationMostMm = 0.5;

/// How many of the costliest errors a page puts first.
inline constexpr std::size_t kFirstErrors = 3;
/// True where points are lost because the work is not done: the first of all losses, none of a criterion's.
[[nodiscard]] bool costsUndone(const score::Assessment& assessment);
/// That, in a sentence of the program's language, also where it could not be measured; empty: the work is done.
[[nodiscard]] std::string undoneWords(const score::Assessment& assessment);
/// The graded criteria that cost points of their own or are critical errors, the dearest first (critical before all):
/// indices into `assessment.criteria`.
[[nodiscard]] std::vector<std::size_t> costliest(const score::Assessment& assessment);

using ReviewMaker = std::function<Review(std::size_t mostBytes)>;

/// One HTML page in the program's language, nothing loaded from elsewhere: score with its uncertainty, verdict and
/// why, critical errors, the costliest errors with place, time, force, picture and drill, all criteria, own and ideal;
/// with a `review` the work to look through, in so many bytes at most.
[[nodiscard]] std::string studentReport(const score::Result& result, const tasks::Task& task,
                                        const rubric::Rubric& rubric, const AssessmentPictures& pictures = {},
                                        const ReviewMaker& review = {});

/// One result of a class: what a result.json holds of it.
struct ClassEntry {
    std::string student;  ///< a code, never a name
    std::string file;     ///< it came from
    std::optional<std::size_t>
        attempt;  ///< of the student's on this exercise, from 1; none: counted in the order given
    score::Result result;
};
/// One HTML page for a class, in the program's language: table, distribution of each criterion, learning curve of each
/// student, which criteria cost most. Scores of other exercises, rubrics, devices or motion scales are never pooled:
/// each such group has a part of its own.
[[nodiscard]] std::string classReport(const std::vector<ClassEntry>& entries);

}  // namespace handpiece::report
