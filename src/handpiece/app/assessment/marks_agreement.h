// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the agreement statistics say of marks, and that as JSON and pictures.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "handpiece/app/assessment/marks.h"
#include "handpiece/assess/agreement/agreement.h"

namespace handpiece::assessment {

/// What marks may be. Empty categories: numbers where all of them are, else labels without an order.
struct MarkScale {
    std::vector<std::string> categories;  ///< from best to worst, those that nobody gave too
};

struct RaterPair {
    std::string first, second;
    std::size_t items = 0;                                        ///< that both marked
    std::optional<agreement::Estimate> kappa, linear, quadratic;  ///< of categories; weighted ones of ordered ones
    std::optional<agreement::BlandAltman> blandAltman;            ///< of numbers
    std::vector<double> means, differences;                       ///< what it is of
};

struct Alpha {
    agreement::Level level = agreement::Level::nominal;
    agreement::Estimate estimate;
    agreement::Bootstrap bootstrap;
};

struct CriterionAgreement {
    std::string criterion;
    std::string title;  ///< as pictures call it; empty: its id
    bool areNumbers = false, isOrdered = false;
    std::vector<std::string> raters, categories;
    std::size_t items = 0, marks = 0, wholeItems = 0;  ///< whole: marked by all
    std::vector<RaterPair> pairs;
    std::optional<agreement::Icc> icc;                 ///< of numbers, over whole items
    std::optional<agreement::Bootstrap> iccBootstrap;  ///< of (2,1)
    std::vector<Alpha> alphas;
};

/// Draws of each bootstrap interval.
inline constexpr std::size_t kDraws = 2000;

/// Throws core::Error for a mark that is not on the scale.
[[nodiscard]] CriterionAgreement agreementOf(const MarkTable& table, const MarkScale& scale,
                                             std::size_t draws = kDraws);

[[nodiscard]] std::string agreementJson(std::span<const CriterionAgreement> all);
/// In lines to read.
[[nodiscard]] std::string agreementText(std::span<const CriterionAgreement> all);
/// Bland and Altman's plot as a file of its own (SVG), in the program's language.
[[nodiscard]] std::string blandAltmanSvg(const CriterionAgreement& of, const RaterPair& pair);

}  // namespace handpiece::assessment
