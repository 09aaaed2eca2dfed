// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The review of an attempt in a server's pages.

#include <string>

#include "handpiece/app/report/review.h"
#include "handpiece/app/report/school_pages.h"

namespace handpiece::report {

/// Of what the page tells; never of whom.
struct ReviewedAttempt {
    std::string id, exercise;
    school::Milliseconds finished = 0;
};
/// How many bytes its review may have.
[[nodiscard]] std::size_t roomForReview(const ReviewedAttempt& attempt);
/// A page that holds its review, the same for everybody: nobody's name is in it.
[[nodiscard]] std::string reviewPage(const Review& review, const ReviewedAttempt& attempt);
/// Until it is there: how far it is, loaded again by itself; or why there will be none.
[[nodiscard]] std::string reviewWaitPage(const Looker& who, const std::string& attempt, double progress, bool isBusy,
                                         const std::string& trouble);

}  // namespace handpiece::report
