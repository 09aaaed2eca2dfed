// SPDX-License-Identifier: Apache-2.0
// Grooves and ridges: valleys and crests of the crown seen from above, followed where the average tooth has them.
#include <algorithm>
#include <cmath>
#include <limits>

#include "handpiece/scan/landmarks/finder.h"

namespace handpiece::landmarks {
namespace {
using core::Vec2;

constexpr double kAlongMm = 0.2, kAcrossMm = 0.1;
/// To both sides of where it is expected.
constexpr int kSteps = 11;
constexpr double kBesideMm = 0.4;  ///< a valley lies lower than what is so far to both sides
/// Cost [mm] of a bend, and of lying elsewhere, a mm squared.
constexpr double kBend = 1.0, kElsewhere = 0.03;
constexpr double kNothingThereMm = 0.5;
/// Shallower than this, on the mean of some places along it, it is not told from noise.
constexpr double kLeastMm = 0.012;
constexpr double kMostOf = 0.6;

std::vector<Vec2> spaced(const std::vector<Vec2>& line) {
    std::vector<Vec2> points;
    double left = 0.0;  // to the next point
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        const Vec2 way = line[i + 1] - line[i];
        const double length = way.norm();
        double at = left;
        for (; at < length; at += kAlongMm)
            points.emplace_back(line[i] + way * (at / length));
        left = at - length;
    }
    if (line.size() > 1) points.push_back(line.back());
    return points;
}

}  // namespace

std::vector<Vec2> lineAlong(const Relief& relief, const std::vector<Vec2>& expected, LineOf what) {
    const std::vector<Vec2> base = spaced(expected);
    const std::size_t count = base.size();
    if (count < 4) return {};
    constexpr int kOffsets = 2 * kSteps + 1;
    const double sign = what == LineOf::valley ? 1.0 : -1.0;
    const auto at = [](std::size_t k, int o) { return k * kOffsets + static_cast<std::size_t>(o); };
    std::vector<Vec2> across(count);
    for (std::size_t k = 0; k < count; ++k) {
        const Vec2 way = (base[std::min(k + 2, count - 1)] - base[k < 2 ? 0 : k - 2]).normalized();
        across[k] = Vec2(-way.y(), way.x());
    }
    // How far it lies under (over) what is beside, everywhere it may run.
    std::vector<double> depth(count * kOffsets, -kNothingThereMm);
    std::vector<double> cost(count * kOffsets, std::numeric_limits<double>::infinity());
    std::vector<int> from(count * kOffsets, 0);
    const auto placeOf = [&](std::size_t k, int o) -> Vec2 { return base[k] + (o - kSteps) * kAcrossMm * across[k]; };
    for (std::size_t k = 0; k < count; ++k)
        for (int o = 0; o < kOffsets; ++o) {
            const Vec2 p = placeOf(k, o);
            const auto here = relief.heightAt(p), one = relief.heightAt(p + kBesideMm * across[k]),
                       other = relief.heightAt(p - kBesideMm * across[k]);
            if (here && one && other) depth[at(k, o)] = sign * (0.5 * (*one + *other) - *here);
        }
    for (std::size_t k = 0; k < count; ++k)
        for (int o = 0; o < kOffsets; ++o) {
            const double off = (o - kSteps) * kAcrossMm;
            const double own = kAlongMm * (kElsewhere * off * off - depth[at(k, o)]);
            if (k == 0) {
                cost[at(k, o)] = own;
                continue;
            }
            for (int d = -2; d <= 2; ++d) {
                if (o + d < 0 || o + d >= kOffsets) continue;
                const double bend = d * kAcrossMm;
                const double sum = cost[at(k - 1, o + d)] + own + kBend * bend * bend / kAlongMm * 0.1;
                if (sum < cost[at(k, o)]) {
                    cost[at(k, o)] = sum;
                    from[at(k, o)] = o + d;
                }
            }
        }
    int o = 0;
    for (int i = 0; i < kOffsets; ++i)
        if (cost[at(count - 1, i)] < cost[at(count - 1, o)]) o = i;
    std::vector<Vec2> path(count);
    std::vector<double> deep(count);
    for (std::size_t k = count; k-- > 0; o = from[at(k, o)]) {
        path[k] = placeOf(k, o);
        deep[k] = depth[at(k, o)];
    }
    // The longest piece that shows.
    std::size_t bestFrom = 0, bestTo = 0, begin = 0;
    for (std::size_t k = 0; k <= count; ++k) {
        double mean = 0.0, weight = 0.0;
        for (std::size_t i = k < 2 ? 0 : k - 2; i < std::min(k + 3, count); ++i) {
            mean += deep[i];
            ++weight;
        }
        if (k < count && mean > kLeastMm * weight) continue;
        if (k - begin > bestTo - bestFrom) bestFrom = begin, bestTo = k;
        begin = k + 1;
    }
    if (static_cast<double>(bestTo - bestFrom) < kMostOf * static_cast<double>(count)) return {};
    return {path.begin() + static_cast<std::ptrdiff_t>(bestFrom), path.begin() + static_cast<std::ptrdiff_t>(bestTo)};
}

}  // namespace handpiece::landmarks
