// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The review of an attempt in a server's pages.

#include <span>
#include <string>

#include "handpiece/app/report/review.h"
#include "handpiece/app/report/school_pages.h"

namespace handpiece::report {

/// Of what the page tells; never of whom.
struct ReviewedAttempt {
    std::string id, exercise;
    school::Milliseconds finished = 0;
};
/// A page that holds its review, the same for everybody: nobody's name is in it. Throws core::Error as reviewOf.
[[nodiscard]] std::string reviewPage(std::span<const Reviewed> chain, const ReviewedAttempt& attempt,
                                     const ReviewedAgainst& against, const core::Progress& progress = {});
/// Until it is there: how far it is, loaded again by itself; or why there will be none.
[[nodiscard]] std::string reviewWaitPage(const Looker& who, const std::string& attempt, double progress, bool isBusy,
                                         const std::string& trouble);

}  // namespace handpiece::report
