// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Where to put the pass mark, by what judges say of borderline students and by what examiners say of work. Pure
/// functions. Definitions and sources: docs/school-teaching.md#standards.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "handpiece/assess/agreement/agreement.h"

namespace handpiece::standard {

/// What one judge says of each criterion: the share of its points [%] that a borderline student would have.
struct JudgeEstimates {
    std::string judge;
    std::vector<std::optional<double>> percents;  ///< by criterion; none: not said
};

/// Modified Angoff (Angoff 1971 [R]; with rounds between which judges see each other's, Hambleton 1978 [R]). A judge's
/// cut is the mean of their percents, weighted by the criteria's points; the cut is the mean of the judges' cuts.
struct Angoff {
    struct Judge {
        std::string judge;
        double cutPercent = 0.0;
    };
    std::vector<Judge> judges;                          ///< who estimated every criterion
    std::vector<std::string> unfinished;                ///< who did not: they do not count
    std::optional<double> cutPercent;                   ///< none without judges
    std::optional<double> spreadPercent;                ///< sample standard deviation of the judges' cuts; none of one
    std::optional<double> standardErrorPercent;         ///< spread / sqrt(judges)
    std::optional<agreement::Interval> interval;        ///< 95 %, by Student's t with judges - 1
    std::vector<std::optional<double>> means, spreads;  ///< by criterion, of all who said one
};
/// `weights`: the criteria's points, above 0. Throws core::Error for sizes that differ, weights that sum to nothing and
/// percents outside of 0 to 100.
[[nodiscard]] Angoff angoff(std::span<const double> weights, std::span<const JudgeEstimates> estimates);

/// One work: an examiner's impression (a number on a scale, the mean of several examiners') and its score.
struct RatedWork {
    double rating = 0.0, percent = 0.0;
};
/// Borderline regression (Wood, Humphrey-Murray and Norman 2006 [R]): least squares of score on rating; the cut is the
/// line at the borderline rating.
struct Borderline {
    std::size_t works = 0;
    std::optional<double> cutPercent;  ///< within 0 to 100
    double interceptPercent = 0.0, slopePercent = 0.0;
    double rSquared = 0.0, residualPercent = 0.0;  ///< residual standard deviation, works - 2
    std::optional<double> standardErrorPercent;    ///< of the line at the borderline rating, by theory
    agreement::Bootstrap bootstrap;                ///< of the cut, works drawn again
    std::string reason;                            ///< why there is no cut
};
/// Draws of the bootstrap interval.
inline constexpr std::size_t kDraws = 2000;
/// Fewer works than three, one rating alone, or a line that does not rise say nothing: then there is no cut. `seed`: of
/// the draws; the same, the same interval.
[[nodiscard]] Borderline borderlineRegression(std::span<const RatedWork> works, double borderlineRating,
                                              std::uint64_t seed, std::size_t draws = kDraws);

}  // namespace handpiece::standard
