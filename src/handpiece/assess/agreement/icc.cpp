// SPDX-License-Identifier: Apache-2.0
// Intraclass correlations, and the limits of agreement of two.
#include <algorithm>
#include <cmath>

#include "handpiece/assess/agreement/agreement.h"
#include "handpiece/base/core/error.h"

namespace handpiece::agreement {
namespace {

bool isTiny(double square, double scale) {
    return square <= 1e-24 * scale;
}

}  // namespace

Icc icc(std::span<const double> values, std::size_t raters) {
    if (raters == 0 || values.size() % raters != 0)
        throw core::Error("the marks do not fill a table of items and raters");
    Icc out;
    const std::size_t items = values.size() / raters;
    const auto undefined = [&](const char* reason) {
        for (Estimate* e : {&out.one1, &out.two1, &out.three1, &out.oneK, &out.twoK, &out.threeK})
            if (!e->value && e->reason.empty()) e->reason = reason;
        return out;
    };
    for (const double v : values)
        if (!std::isfinite(v)) throw core::Error("a mark is no number");
    if (items < 2 || raters < 2) return undefined("two items and two raters at least are needed");
    const double n = static_cast<double>(items), k = static_cast<double>(raters);
    double grand = 0.0, scale = 0.0;
    for (const double v : values)
        grand += v, scale = std::max(scale, v * v);
    grand /= n * k;
    std::vector<double> itemMean(items, 0.0), raterMean(raters, 0.0);
    for (std::size_t i = 0; i < items; ++i)
        for (std::size_t j = 0; j < raters; ++j) {
            itemMean[i] += values[i * raters + j] / k;
            raterMean[j] += values[i * raters + j] / n;
        }
    double items2 = 0.0, raters2 = 0.0, within = 0.0, error = 0.0;
    for (const double m : itemMean)
        items2 += k * (m - grand) * (m - grand);
    for (const double m : raterMean)
        raters2 += n * (m - grand) * (m - grand);
    for (std::size_t i = 0; i < items; ++i)
        for (std::size_t j = 0; j < raters; ++j) {
            const double v = values[i * raters + j], left = v - itemMean[i] - raterMean[j] + grand;
            within += (v - itemMean[i]) * (v - itemMean[i]);
            error += left * left;
        }
    const double dfItems = n - 1.0, dfWithin = n * (k - 1.0), dfError = (n - 1.0) * (k - 1.0);
    const double bms = out.betweenItems = items2 / dfItems, wms = out.withinItems = within / dfWithin;
    const double jms = out.betweenRaters = raters2 / (k - 1.0), ems = out.error = error / dfError;
    if (isTiny(bms, scale) && isTiny(wms, scale)) return undefined("all marks are the same: there is no variance");

    if (isTiny(bms, scale) && isTiny(ems, scale)) {
        for (Estimate* e : {&out.three1, &out.threeK})
            e->reason = "the items do not differ: there is no variance";
    } else {
        out.three1.value = (bms - ems) / (bms + (k - 1.0) * ems);
        if (!isTiny(bms, scale))
            out.threeK.value = (bms - ems) / bms;
        else
            out.threeK.reason = "the items do not differ: there is no variance";
    }
    out.one1.value = (bms - wms) / (bms + (k - 1.0) * wms);
    if (!isTiny(bms, scale))
        out.oneK.value = (bms - wms) / bms;
    else
        out.oneK.reason = "the items do not differ: there is no variance";
    const double spread2 = bms + (k - 1.0) * ems + k * (jms - ems) / n, spreadK = bms + (jms - ems) / n;
    if (spread2 > 1e-24 * scale)
        out.two1.value = (bms - ems) / spread2;
    else
        out.two1.reason = "what raters and items differ by cancels out";
    if (spreadK > 1e-24 * scale)
        out.twoK.value = (bms - ems) / spreadK;
    else
        out.twoK.reason = "what raters and items differ by cancels out";

    // By F of one mean square over another; where raters agree to the bit it has no limits.
    const auto byF = [&](double over, double df, Estimate& one, Estimate& many) {
        if (isTiny(over, scale) || isTiny(bms, scale)) return;
        const double f = bms / over, low = f / fisherAt(0.975, dfItems, df), high = f * fisherAt(0.975, df, dfItems);
        one.interval = Interval{(low - 1.0) / (low + k - 1.0), (high - 1.0) / (high + k - 1.0)};
        many.interval = Interval{1.0 - 1.0 / low, 1.0 - 1.0 / high};
    };
    byF(wms, dfWithin, out.one1, out.oneK);
    byF(ems, dfError, out.three1, out.threeK);
    if (out.two1.value && !isTiny(ems, scale) && !isTiny(bms, scale)) {
        const double r = *out.two1.value, fj = jms / ems;
        const double a = k * r * fj + n * (1.0 + (k - 1.0) * r) - k * r;
        const double b = n * (1.0 + (k - 1.0) * r) - k * r;
        const double v = dfError * a * a / (dfItems * k * k * r * r * fj * fj + b * b);
        if (v > 0.0 && std::isfinite(v)) {
            const double f1 = fisherAt(0.975, dfItems, v), f2 = fisherAt(0.975, v, dfItems);
            const double common = k * jms + (k * n - k - n) * ems;
            const double low = n * (bms - f1 * ems) / (f1 * common + n * bms);
            const double high = n * (f2 * bms - ems) / (common + n * f2 * bms);
            if (std::isfinite(low) && std::isfinite(high)) {
                out.two1.interval = Interval{low, high};
                const auto stepped = [&](double x) { return k * x / (1.0 + (k - 1.0) * x); };
                out.twoK.interval = Interval{stepped(low), stepped(high)};
            }
        }
    }
    return undefined("");
}

BlandAltman blandAltman(std::span<const double> first, std::span<const double> second) {
    if (first.size() != second.size()) throw core::Error("two raters marked different numbers of items");
    BlandAltman out;
    out.count = first.size();
    if (first.size() < 2) {
        out.reason = "two items at least are needed";
        return out;
    }
    const double n = static_cast<double>(first.size());
    double bias = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < first.size(); ++i)
        bias += first[i] - second[i];
    bias /= n;
    for (std::size_t i = 0; i < first.size(); ++i) {
        const double off = first[i] - second[i] - bias;
        squares += off * off;
    }
    const double s = std::sqrt(squares / (n - 1.0)), z = 1.96, t = studentAt(0.975, n - 1.0);
    out.bias = bias;
    out.spread = s;
    out.low = bias - z * s;
    out.high = bias + z * s;
    const double ofBias = t * s / std::sqrt(n), ofLimit = t * s * std::sqrt(1.0 / n + z * z / (2.0 * (n - 1.0)));
    out.biasInterval = Interval{bias - ofBias, bias + ofBias};
    out.lowInterval = Interval{*out.low - ofLimit, *out.low + ofLimit};
    out.highInterval = Interval{*out.high - ofLimit, *out.high + ofLimit};
    return out;
}

}  // namespace handpiece::agreement
