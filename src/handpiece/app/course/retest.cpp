// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/course/retest.h"

#include <algorithm>

#include "handpiece/app/report/assessment_report.h"

namespace handpiece::course {
namespace {

std::int64_t dueAfter(std::int64_t now, int step) {
    constexpr std::int64_t kDay = 24 * 3600 * 1000;
    return now + kDay * kRetestDays[static_cast<std::size_t>(step)];
}

}  // namespace

std::vector<school::Retest> nextRetests(std::vector<school::Retest> open, const school::Attempt& attempt,
                                        const score::Assessment& result, bool isUnaided) {
    const std::int64_t now = attempt.finished;
    const std::vector<std::size_t> lost = report::costliest(result);
    const auto isLost = [&](const score::CriterionScore& c) {
        return std::any_of(lost.begin(), lost.end(), [&](std::size_t i) { return result.criteria[i].id == c.id; });
    };
    std::erase_if(open, [&](school::Retest& one) {
        const auto c = std::find_if(result.criteria.begin(), result.criteria.end(),
                                    [&](const score::CriterionScore& s) { return s.id == one.criterion; });
        if (c == result.criteria.end() || c->standing != score::Standing::judged) return false;
        if (isLost(*c)) {
            one = {one.exercise, one.criterion, attempt.id, 0, dueAfter(now, 0)};
        } else if (isUnaided && one.due <= now) {
            if (one.step + 1 == static_cast<int>(kRetestDays.size())) return true;
            one = {one.exercise, one.criterion, attempt.id, one.step + 1, dueAfter(now, one.step + 1)};
        }
        return false;
    });
    for (std::size_t i = 0; i < std::min(lost.size(), kMostNewRetests); ++i) {
        const std::string& id = result.criteria[lost[i]].id;
        if (std::none_of(open.begin(), open.end(), [&](const school::Retest& one) { return one.criterion == id; }))
            open.push_back({attempt.exercise, id, attempt.id, 0, dueAfter(now, 0)});
    }
    return open;
}

}  // namespace handpiece::course
