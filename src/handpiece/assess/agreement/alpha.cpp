// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "handpiece/assess/agreement/agreement.h"
#include "handpiece/base/core/error.h"

namespace handpiece::agreement {

Estimate krippendorffAlpha(std::span<const std::optional<double>> values, std::size_t raters, Level level) {
    if (raters == 0 || values.size() % raters != 0)
        throw core::Error("the marks do not fill a table of items and raters");
    Estimate out;
    std::vector<double> scale;
    for (const auto& v : values) {
        if (!v) continue;
        if (!std::isfinite(*v)) throw core::Error("a mark is no number");
        if (level == Level::ratio && *v < 0.0) {
            out.reason = "a mark is negative: there are no ratios of such";
            return out;
        }
        scale.push_back(*v);
    }
    std::sort(scale.begin(), scale.end());
    scale.erase(std::unique(scale.begin(), scale.end()), scale.end());
    const std::size_t m = scale.size();
    if (m > 2000) {
        out.reason = "there are more than 2000 different marks";
        return out;
    }
    const auto placeOf = [&](double v) {
        return static_cast<std::size_t>(std::lower_bound(scale.begin(), scale.end(), v) - scale.begin());
    };
    // Coincidences: pairs of marks of one item, each item with the weight of its marks.
    std::vector<double> pairs(m * m, 0.0), sums(m, 0.0);
    std::vector<std::size_t> marks;
    double total = 0.0;
    for (std::size_t item = 0; item < values.size() / raters; ++item) {
        marks.clear();
        for (std::size_t r = 0; r < raters; ++r)
            if (const auto& v = values[item * raters + r]) marks.push_back(placeOf(*v));
        if (marks.size() < 2) continue;
        const double each = 1.0 / static_cast<double>(marks.size() - 1);
        for (std::size_t a = 0; a < marks.size(); ++a)
            for (std::size_t b = 0; b < marks.size(); ++b)
                if (a != b) pairs[marks[a] * m + marks[b]] += each;
        for (const std::size_t a : marks)
            sums[a] += 1.0;
        total += static_cast<double>(marks.size());
    }
    if (total == 0.0) {
        out.reason = "no item was marked by two";
        return out;
    }
    const auto apart = [&](std::size_t c, std::size_t k) {
        double d = c == k ? 0.0 : 1.0;
        if (level == Level::ordinal) {
            d = -0.5 * (sums[c] + sums[k]);
            for (std::size_t g = std::min(c, k); g <= std::max(c, k); ++g)
                d += sums[g];
        } else if (level == Level::interval) {
            d = scale[c] - scale[k];
        } else if (level == Level::ratio) {
            d = scale[c] + scale[k] > 0.0 ? (scale[c] - scale[k]) / (scale[c] + scale[k]) : 0.0;
        }
        return d * d;
    };
    double observed = 0.0, expected = 0.0;
    for (std::size_t c = 0; c < m; ++c)
        for (std::size_t k = 0; k < m; ++k) {
            if (c == k) continue;
            const double d = apart(c, k);
            observed += pairs[c * m + k] * d;
            expected += sums[c] * sums[k] * d;
        }
    if (expected == 0.0) {
        out.reason = "all marks are the same: there is no variance";
        return out;
    }
    out.value = 1.0 - (total - 1.0) * observed / expected;
    return out;
}

}  // namespace handpiece::agreement
