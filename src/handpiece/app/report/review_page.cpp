// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/review_page.h"

#include <fmt/format.h>

#include <algorithm>

#include "handpiece/app/report/assessment_words.h"
#include "handpiece/app/report/plot.h"
#include "handpiece/base/config/words.h"

namespace handpiece::report {

using config::words;
using Tone = HtmlReport::Tone;

namespace {
HtmlReport pageOf(const ReviewedAttempt& attempt) {
    HtmlReport page(attempt.exercise);
    page.link("/attempts/" + attempt.id, words()("school-live.to-attempt"));
    page.paragraph(words()("school-live.finished", momentOf(attempt.finished)), Tone::note);
    page.reviewHere();
    return page;
}
}  // namespace

std::size_t roomForReview(const ReviewedAttempt& attempt) {
    return std::min(pageOf(attempt).roomForReview(), kMostReviewBytes);
}

std::string reviewPage(const Review& review, const ReviewedAttempt& attempt) {
    HtmlReport page = pageOf(attempt);
    page.review(review);
    return page.text();
}

std::string reviewWaitPage(const Looker& who, const std::string& attempt, double progress, bool isBusy,
                           const std::string& trouble) {
    HtmlReport page = sitePage(words()("school-live.review"), who);
    page.link("/attempts/" + attempt, words()("school-live.to-attempt"));
    if (!trouble.empty()) {
        page.paragraph(words()("school-live.no-review", reasonOf(trouble)), Tone::bad);
        return page.text();
    }
    page.live(
        fmt::format("<p id=\"again\" role=\"status\">{}</p>\n",
                    escaped(isBusy ? words()("school-live.review-busy")
                                   : words()("school-live.review-made", fmt::format("{:.0f}", 100.0 * progress)))));
    page.script("/live.js", "{}");
    return page.text();
}

}  // namespace handpiece::report
