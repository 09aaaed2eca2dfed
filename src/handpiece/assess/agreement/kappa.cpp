// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "handpiece/assess/agreement/agreement.h"
#include "handpiece/base/core/error.h"

namespace handpiece::agreement {

std::vector<std::size_t> countsOf(std::span<const std::size_t> first, std::span<const std::size_t> second,
                                  std::size_t categories) {
    if (first.size() != second.size()) throw core::Error("two raters marked different numbers of items");
    std::vector<std::size_t> counts(categories * categories, 0);
    for (std::size_t i = 0; i < first.size(); ++i) {
        if (first[i] >= categories || second[i] >= categories) throw core::Error("a mark is in no category");
        ++counts[first[i] * categories + second[i]];
    }
    return counts;
}

Estimate kappa(std::span<const std::size_t> counts, std::size_t categories, Weights weights) {
    if (counts.size() != categories * categories) throw core::Error("the table of counts is not square");
    std::size_t total = 0;
    for (const std::size_t n : counts)
        total += n;
    Estimate out;
    if (total == 0 || categories < 2) {
        out.reason = categories < 2 ? "there is one category only" : "no item was marked by both";
        return out;
    }
    const double n = static_cast<double>(total);
    std::vector<double> rows(categories, 0.0), columns(categories, 0.0);
    const auto share = [&](std::size_t i, std::size_t j) {
        return static_cast<double>(counts[i * categories + j]) / n;
    };
    const auto weight = [&](std::size_t i, std::size_t j) {
        if (weights == Weights::none) return i == j ? 1.0 : 0.0;
        const double apart = static_cast<double>(std::max(i, j) - std::min(i, j)) / static_cast<double>(categories - 1);
        return 1.0 - (weights == Weights::linear ? apart : apart * apart);
    };
    for (std::size_t i = 0; i < categories; ++i)
        for (std::size_t j = 0; j < categories; ++j) {
            rows[i] += share(i, j);
            columns[j] += share(i, j);
        }
    double observed = 0.0, expected = 0.0;
    std::vector<double> rowWeight(categories, 0.0), columnWeight(categories, 0.0);
    for (std::size_t i = 0; i < categories; ++i)
        for (std::size_t j = 0; j < categories; ++j) {
            observed += weight(i, j) * share(i, j);
            expected += weight(i, j) * rows[i] * columns[j];
            rowWeight[i] += columns[j] * weight(i, j);
            columnWeight[j] += rows[i] * weight(i, j);
        }
    // One category alone was used, by both: agreement by chance is all there can be.
    const auto usesOne = [&](const std::vector<double>& shares) {
        return std::count_if(shares.begin(), shares.end(), [](double p) { return p > 0.0; }) == 1;
    };
    if (usesOne(rows) && usesOne(columns)) {
        out.reason = "each rater gave one mark only: there is no variance";
        return out;
    }
    const double rest = 1.0 - expected;
    out.value = (observed - expected) / rest;
    double sum = 0.0;
    for (std::size_t i = 0; i < categories; ++i)
        for (std::size_t j = 0; j < categories; ++j) {
            const double term = weight(i, j) * rest - (rowWeight[i] + columnWeight[j]) * (1.0 - observed);
            sum += share(i, j) * term * term;
        }
    const double middle = observed * expected - 2.0 * expected + observed;
    out.standardError = std::sqrt(std::max(0.0, sum - middle * middle) / n) / (rest * rest);
    out.interval = Interval{*out.value - kNormal975 * *out.standardError, *out.value + kNormal975 * *out.standardError};
    return out;
}

}  // namespace handpiece::agreement
