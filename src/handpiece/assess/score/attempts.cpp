// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "handpiece/assess/score/score.h"
#include "handpiece/base/core/error.h"

namespace handpiece::score {
namespace {

double meanOf(std::span<const double> values) {
    double sum = 0.0;
    for (const double v : values)
        sum += v;
    return sum / static_cast<double>(values.size());
}
std::optional<double> spreadOf(std::span<const double> values, double mean) {
    if (values.size() < 2) return {};
    double squares = 0.0;
    for (const double v : values)
        squares += (v - mean) * (v - mean);
    return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

}  // namespace

Attempts attempts(std::span<const Assessment> all) {
    if (all.empty()) throw core::Error("there is no attempt", {}, "give one at least");
    std::vector<double> percents;
    for (const Assessment& a : all) {
        const std::string which = fmt::format("attempt {}", percents.size() + 1);
        if (a.rubricHash != all.front().rubricHash)
            throw core::Error("it was judged by another rubric than the first", which,
                              "re-score it under the same one");
        if (a.context.device != all.front().context.device || a.context.motionScale != all.front().context.motionScale)
            throw core::Error(
                fmt::format("it was made with \"{}\" at scale {}, the first with \"{}\" at {}", a.context.device,
                            a.context.motionScale, all.front().context.device, all.front().context.motionScale),
                which, "look at each device for itself");
        if (!(a.maxScore > 0.0) || a.maxScore != all.front().maxScore || a.maxScore != a.wholeScore)
            throw core::Error("not all that the rubric grades was measured", which, "leave it out");
        percents.push_back(a.percent());
    }
    Attempts out;
    out.count = percents.size();
    for (std::size_t n = 1; n <= percents.size(); ++n) {
        const std::span<const double> sofar(percents.data(), n);
        const double mean = meanOf(sofar);
        out.curve.push_back({percents[n - 1], mean, spreadOf(sofar, mean)});
    }
    out.mean = out.curve.back().mean;
    out.spread = out.curve.back().spread;
    out.least = *std::min_element(percents.begin(), percents.end());
    out.greatest = *std::max_element(percents.begin(), percents.end());
    if (const std::size_t half = percents.size() / 2; half >= 2)
        out.change = meanOf(std::span(percents).last(half)) - meanOf(std::span(percents).first(half));
    return out;
}

}  // namespace handpiece::score
