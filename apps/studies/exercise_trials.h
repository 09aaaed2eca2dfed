// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The ten exercises, done by scripted hands and judged as a student's work is: a check of zones, hands, measures,
/// rubrics and scores together. It says nothing of how well a score tells students apart.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "handpiece/assess/task/task.h"
#include "handpiece/base/core/progress.h"

namespace handpiece::studies {

struct TrialOptions {
    std::filesystem::path out;           ///< teeth stay in it and are used again
    std::vector<std::size_t> exercises;  ///< 1 to 10; empty: all
    double voxelMm = 0.1;
    std::size_t faces = 20000;  ///< of each tooth that is worked on
    int trials = 20;            ///< of each steadiness; 0: none
    std::uint64_t seed = 1;
    bool atTheArm = false;  ///< those done well: by the loop at 1 kHz, recorded and proven; else by sweeping alone
    bool withErrors = true;
};

/// One piece of work and what came of it.
struct TrialScore {
    double score = 0.0, maxScore = 0.0, wholeScore = 0.0, mostScore = 0.0;
    bool isFull = false;  ///< each criterion that was measured reaches all its points within its uncertainty
    std::vector<std::string> shortOf;                 ///< criteria that do not, with value and points
    std::vector<std::string> notMeasured;             ///< of the tooth, and graded or critical
    std::vector<std::string> critical, criticalSaid;  ///< ids; with their values
    std::string passed, json;
    [[nodiscard]] double percent() const { return maxScore > 0.0 ? 100.0 * score / maxScore : 0.0; }
};
struct ErrorOnPurpose {
    std::string name, criterion;
    bool isFound = false, isMeasured = true;
    std::vector<std::string> others;  ///< critical errors that were found as well
};
struct HandTrials {
    double tremorMm = 0.0, driftMm = 0.0;
    std::vector<double> percent;
    int critical = 0;  ///< trials with a critical error
    [[nodiscard]] double mean() const;
};
struct ExerciseTrials {
    int number = 0;
    std::string id, bur;
    TrialScore ideal, doneWell;
    std::string proof;  ///< at the arm
    double handS = 0.0, wayMm = 0.0;
    std::vector<ErrorOnPurpose> errors;
    std::vector<HandTrials> hands;
    double auc = 0.0;  ///< of the steadiest hand against the shakiest
    bool isOrdered = false;
};

/// Share of pairs in which the first is the greater; ties count half.
[[nodiscard]] double areaUnderCurve(const std::vector<double>& greater, const std::vector<double>& less);

/// The same for the same options, at any number of threads.
[[nodiscard]] std::vector<ExerciseTrials> tryExercises(const TrialOptions& options,
                                                       const core::Progress& progress = {});
[[nodiscard]] std::string trialsJson(const TrialOptions& options, const std::vector<ExerciseTrials>& all);
/// As a page of Markdown.
[[nodiscard]] std::string trialsText(const TrialOptions& options, const std::vector<ExerciseTrials>& all);

}  // namespace handpiece::studies
