// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "handpiece/assess/standard/standard.h"
#include "handpiece/base/core/error.h"

namespace handpiece::standard {
namespace {

double meanOf(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values)
        sum += value;
    return sum / static_cast<double>(values.size());
}
std::optional<double> spreadOf(std::span<const double> values) {
    if (values.size() < 2) return {};
    const double mean = meanOf(values);
    double sum = 0.0;
    for (const double value : values)
        sum += (value - mean) * (value - mean);
    return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

}  // namespace

Angoff angoff(std::span<const double> weights, std::span<const JudgeEstimates> estimates) {
    double total = 0.0;
    for (const double weight : weights) {
        if (!(weight > 0.0) || !std::isfinite(weight))
            throw core::Error(fmt::format("a criterion has {} points", weight), "standard", "give it more than 0");
        total += weight;
    }
    if (!(total > 0.0)) throw core::Error("nothing is graded", "standard", "give a criterion points");
    Angoff result;
    std::vector<double> cuts;
    std::vector<std::vector<double>> byCriterion(weights.size());
    for (const JudgeEstimates& one : estimates) {
        if (one.percents.size() != weights.size())
            throw core::Error(fmt::format("{} estimates for {} criteria", one.percents.size(), weights.size()),
                              "standard of " + one.judge, "give one to each");
        double cut = 0.0;
        bool isWhole = true;
        for (std::size_t i = 0; i < weights.size(); ++i) {
            const std::optional<double>& percent = one.percents[i];
            isWhole = isWhole && percent.has_value();
            if (!percent) continue;
            if (!(*percent >= 0.0 && *percent <= 100.0))
                throw core::Error(fmt::format("an estimate is {}", *percent), "standard of " + one.judge,
                                  "give 0 to 100 %");
            byCriterion[i].push_back(*percent);
            cut += weights[i] * *percent / total;
        }
        if (isWhole) {
            result.judges.push_back({one.judge, cut});
            cuts.push_back(cut);
        } else {
            result.unfinished.push_back(one.judge);
        }
    }
    for (const std::vector<double>& all : byCriterion) {
        result.means.push_back(all.empty() ? std::nullopt : std::optional(meanOf(all)));
        result.spreads.push_back(spreadOf(all));
    }
    if (cuts.empty()) return result;
    result.cutPercent = meanOf(cuts);
    result.spreadPercent = spreadOf(cuts);
    if (result.spreadPercent) {
        const double judges = static_cast<double>(cuts.size());
        result.standardErrorPercent = *result.spreadPercent / std::sqrt(judges);
        const double reach = agreement::studentAt(0.975, judges - 1.0) * *result.standardErrorPercent;
        result.interval = agreement::Interval{*result.cutPercent - reach, *result.cutPercent + reach};
    }
    return result;
}

}  // namespace handpiece::standard
