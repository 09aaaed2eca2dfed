// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "handpiece/assess/standard/standard.h"

namespace handpiece::standard {
namespace {

struct Line {
    double intercept = 0.0, slope = 0.0, meanRating = 0.0, spanOfRatings = 0.0;  ///< sum of squares about the mean
};

/// Of works[place(0)], works[place(1)], ...; none where all have one rating.
template <class PlaceOf>
std::optional<Line> lineThrough(std::span<const RatedWork> works, std::size_t count, const PlaceOf& place) {
    const double n = static_cast<double>(count);
    double sumX = 0.0, sumY = 0.0;
    for (std::size_t i = 0; i < count; ++i)
        sumX += works[place(i)].rating, sumY += works[place(i)].percent;
    Line line;
    line.meanRating = sumX / n;
    const double meanY = sumY / n;
    double xy = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        const double x = works[place(i)].rating - line.meanRating;
        line.spanOfRatings += x * x;
        xy += x * (works[place(i)].percent - meanY);
    }
    if (!(line.spanOfRatings > 1e-12)) return {};
    line.slope = xy / line.spanOfRatings;
    line.intercept = meanY - line.slope * line.meanRating;
    return line;
}

}  // namespace

Borderline borderlineRegression(std::span<const RatedWork> works, double borderlineRating, std::uint64_t seed,
                                std::size_t draws) {
    Borderline result;
    result.works = works.size();
    result.bootstrap.seed = seed;
    if (works.size() < 3) {
        result.reason = "fewer than three works have a rating and a score";
        return result;
    }
    const auto line = lineThrough(works, works.size(), [](std::size_t i) { return i; });
    if (!line) {
        result.reason = "all works have the same rating";
        return result;
    }
    result.interceptPercent = line->intercept, result.slopePercent = line->slope;
    double meanY = 0.0, residual = 0.0, whole = 0.0;
    for (const RatedWork& one : works)
        meanY += one.percent / static_cast<double>(works.size());
    for (const RatedWork& one : works) {
        const double off = one.percent - (line->intercept + line->slope * one.rating);
        residual += off * off;
        whole += (one.percent - meanY) * (one.percent - meanY);
    }
    result.rSquared = whole > 0.0 ? 1.0 - residual / whole : 0.0;
    const double n = static_cast<double>(works.size());
    result.residualPercent = std::sqrt(residual / (n - 2.0));
    const double away = borderlineRating - line->meanRating;
    result.standardErrorPercent = result.residualPercent * std::sqrt(1.0 / n + away * away / line->spanOfRatings);
    if (!(line->slope > 0.0)) {
        result.reason = "better ratings do not go with better scores";
        return result;
    }
    const auto cutOf = [borderlineRating](const Line& of) {
        return std::clamp(of.intercept + of.slope * borderlineRating, 0.0, 100.0);
    };
    result.cutPercent = cutOf(*line);
    result.bootstrap = agreement::bootstrap(
        works.size(), seed, draws, [&](std::span<const std::size_t> places) -> std::optional<double> {
            const auto drawn = lineThrough(works, places.size(), [&](std::size_t i) { return places[i]; });
            if (!drawn) return {};
            return cutOf(*drawn);
        });
    return result;
}

}  // namespace handpiece::standard
