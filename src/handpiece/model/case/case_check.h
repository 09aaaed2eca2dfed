// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Whether a case can be cut: what is missing, crossing, sticking out.

#include <string>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/model/case/case.h"

namespace handpiece::cases {

/// Parts may stick out of the outer surface, or reach into one of the same priority, by this: surfaces that are meant
/// to be the same are meshed apart (our own coarse teeth: up to 0.06 mm), and nothing outside the outer surface is
/// felt.
inline constexpr double kCaseToleranceMm = 0.1;

struct CaseFinding {
    bool isError = false;  ///< the case cannot be cut as it is; else a remark
    std::string part;      ///< whose; empty: the case's
    std::string what;      ///< one sentence
    double byMm = 0.0;     ///< how far it sticks out or crosses; 0 where that says nothing
    std::string remedy;
};

/// All that is wrong, errors first: surfaces that are no solids, parts outside the outer surface, parts that cross at
/// the same priority, tooth that lies in no part. Nested and overlapping parts are right where priorities decide.
/// Distances are taken at the vertices, coverage at some thousand points; the same at any thread count. Seconds for a
/// fine case.
[[nodiscard]] std::vector<CaseFinding> checkCase(const Case& toothCase, const core::Progress& progress = {});

/// Throws core::Error with the first error and how many there are.
void requireCase(const Case& toothCase);

}  // namespace handpiece::cases
