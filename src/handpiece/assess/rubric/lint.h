// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What check() finds, to be said in any language.

#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/base/config/words.h"

namespace handpiece::rubric {

struct SaidFinding {
    Finding finding;       ///< in English
    config::Phrase about;  ///< the criterion, step or rule; empty: the whole
    config::Phrase problem, remedy;
};
/// As check().
[[nodiscard]] std::vector<SaidFinding> lint(const Rubric& rubric);

}  // namespace handpiece::rubric
