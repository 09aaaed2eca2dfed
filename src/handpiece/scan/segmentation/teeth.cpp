// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/segmentation/teeth.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"

namespace handpiece::segmentation {

using core::Vec3;

namespace {
constexpr double kBlockMm = 0.25;
constexpr double kMinToothMm3 = 2.0;   ///< smaller things are calculus, bone, noise
constexpr double kNeckShare = 0.55;    ///< a neck narrower than this share of the thinner side parts two teeth
constexpr double kMinRadiusMm = 0.9;   ///< a part thinner than this is no tooth of its own
constexpr double kApexRadiusMm = 0.6;  ///< openings up to this radius are closed before cavities are looked for
constexpr float kSpeckShare = 0.36f;   ///< of the step from what surrounds a tooth: more noise than this is averaged

/// The mask with its cavities filled, those with narrow mouths too.
Mask filled(const Shape& shape, const Mask& mask, double spacingMm) {
    const Field far = squaredDistance(shape, mask);
    const double r = kApexRadiusMm / spacingMm;
    Mask open(mask.size());
    for (std::size_t n = 0; n < open.size(); ++n)
        open[n] = far[n] > r * r;
    const Parts parts = connectedParts(shape, open);
    std::vector<std::uint8_t> touches(parts.counts.size(), 0);
    for (std::size_t n = 0; n < open.size(); ++n) {
        if (!open[n]) continue;
        const auto [i, j, k] = shape.at(n);
        if (i == 0 || j == 0 || k == 0 || i + 1 == shape.size[0] || j + 1 == shape.size[1] || k + 1 == shape.size[2])
            touches[parts.of[n]] = 1;
    }
    for (std::size_t n = 0; n < open.size(); ++n)
        open[n] = parts.of[n] != 0 && touches[parts.of[n]];
    const Field outside = squaredDistance(shape, open);
    Mask result(mask.size());
    for (std::size_t n = 0; n < result.size(); ++n) {
        const auto [i, j, k] = shape.at(n);
        const bool isFace =
            i == 0 || j == 0 || k == 0 || i + 1 == shape.size[0] || j + 1 == shape.size[1] || k + 1 == shape.size[2];
        result[n] = mask[n] || (!isFace && outside[n] > (r + 1) * (r + 1));
    }
    return result;
}

/// Floods from the thickest places down; two floods that meet stay apart where their neck is narrow.
std::vector<std::uint32_t> floodFromThickest(const Shape& shape, const Mask& mask, double spacingMm) {
    Mask outside(mask.size());
    for (std::size_t n = 0; n < mask.size(); ++n)
        outside[n] = !mask[n];
    const Field squared = squaredDistance(shape, outside);
    std::vector<std::uint32_t> order;
    for (std::size_t n = 0; n < mask.size(); ++n)
        if (mask[n]) order.push_back(static_cast<std::uint32_t>(n));
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return squared[a] > squared[b]; });
    std::vector<std::uint32_t> of(mask.size(), 0), parent{0};
    std::vector<float> top{0};
    const auto root = [&](std::uint32_t a) {
        while (parent[a] != a)
            a = parent[a] = parent[parent[a]];
        return a;
    };
    for (const std::uint32_t at : order) {
        const float here = std::sqrt(squared[at]);
        std::uint32_t own = 0;
        forNeighbours(shape, at, [&](std::size_t n) {
            if (of[n] == 0) return;
            const std::uint32_t other = root(of[n]);
            if (own == 0) {
                own = other;
                return;
            }
            own = root(own);
            if (own == other) return;
            const float lower = std::min(top[own], top[other]);
            const bool isOne = here >= static_cast<float>(kNeckShare) * lower || lower * spacingMm < kMinRadiusMm;
            const std::uint32_t high = top[own] >= top[other] ? own : other, low = high == own ? other : own;
            if (isOne) parent[low] = high;
            own = high;
        });
        if (own == 0) {
            own = static_cast<std::uint32_t>(parent.size());
            parent.push_back(own);
            top.push_back(here);
        }
        of[at] = own;
    }
    for (std::uint32_t& o : of)
        o = root(o);
    return of;
}
}  // namespace

CoarseTeeth partTeeth(const volume::Volume& volume, const Thresholds& thresholds, const core::Progress& progress) {
    CoarseTeeth result;
    result.coarse = coarsen(volume, std::max(kBlockMm, volume.grid.spacingMm.minCoeff()), core::part(progress, 0, 0.4));
    const Shape& shape = result.coarse.shape;
    // Where bone is nearly as bright as a tooth, noise would tie teeth together by specks.
    const float noise = noiseOf(shape, result.coarse.values);
    if (noise > kSpeckShare * (thresholds.dentine - thresholds.toothFrom)) {
        Field scratch;
        blur(shape, result.coarse.values, result.coarse.values, scratch, 0.8);
    }
    Mask mask(shape.count());
    for (std::size_t n = 0; n < mask.size(); ++n)
        mask[n] = result.coarse.values[n] > thresholds.toothFrom;
    const double spacing = core::pow(result.coarse.spacingMm.prod(), 1.0 / 3.0);
    const Mask solid = filled(shape, mask, spacing);
    core::report(progress, 0.6);
    const std::vector<std::uint32_t> of = floodFromThickest(shape, solid, spacing);
    core::report(progress, 0.9);

    struct Sum {
        std::size_t count = 0;
        double hard = 0;
        std::array<int, 3> low{1 << 30, 1 << 30, 1 << 30}, high{-1, -1, -1};
        bool touches = false;
        bool hasNeighbour = false;
    };
    std::uint32_t last = 0;
    for (const std::uint32_t o : of)
        last = std::max(last, o);
    std::vector<Sum> sums(last + 1);
    for (std::size_t n = 0; n < of.size(); ++n) {
        if (of[n] == 0) continue;
        Sum& s = sums[of[n]];
        ++s.count;
        const auto at = shape.at(n);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            s.low[axis] = std::min(s.low[axis], at[axis]);
            s.high[axis] = std::max(s.high[axis], at[axis]);
            if (at[axis] == 0 || at[axis] + 1 == shape.size[axis]) s.touches = true;
        }
        forNeighbours(shape, n, [&](std::size_t other) {
            if (of[other] != 0 && of[other] != of[n]) s.hasNeighbour = true;
        });
    }
    std::vector<std::uint32_t> order;
    for (std::uint32_t p = 1; p <= last; ++p)
        if (static_cast<double>(sums[p].count) * result.coarse.spacingMm.prod() >= kMinToothMm3) order.push_back(p);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return sums[a].count > sums[b].count; });
    std::vector<std::uint32_t> rank(last + 1, 0);
    for (std::size_t t = 0; t < order.size(); ++t)
        rank[order[t]] = static_cast<std::uint32_t>(t + 1);
    result.of.resize(of.size());
    for (std::size_t n = 0; n < of.size(); ++n)
        result.of[n] = rank[of[n]];

    // A point deep inside: the block furthest from anything else.
    Mask other(of.size());
    for (std::size_t n = 0; n < of.size(); ++n)
        other[n] = !mask[n] || result.of[n] == 0;
    const Field depth = squaredDistance(shape, other);
    std::vector<std::size_t> deepest(order.size(), 0);
    std::vector<float> most(order.size(), -1);
    for (std::size_t n = 0; n < of.size(); ++n)
        if (const std::uint32_t t = result.of[n]; t != 0 && depth[n] > most[t - 1]) {
            most[t - 1] = depth[n];
            deepest[t - 1] = n;
        }
    for (std::size_t t = 0; t < order.size(); ++t) {
        const Sum& s = sums[order[t]];
        Candidate c;
        const auto at = shape.at(deepest[t]);
        c.atMm = volume.grid.toMm(result.coarse.toVoxels(Vec3(at[0], at[1], at[2])));
        const Vec3 low = result.coarse.toVoxels(Vec3(s.low[0], s.low[1], s.low[2]));
        const Vec3 high = result.coarse.toVoxels(Vec3(s.high[0], s.high[1], s.high[2]));
        const Vec3 half = 0.5 * result.coarse.spacingMm;
        c.boundsMm.extend(low.cwiseProduct(volume.grid.spacingMm) - half);
        c.boundsMm.extend(high.cwiseProduct(volume.grid.spacingMm) + half);
        c.volumeMm3 = static_cast<double>(s.count) * result.coarse.spacingMm.prod();
        c.touchesBorder = s.touches;
        result.teeth.push_back(c);
        result.hasNeighbour.push_back(s.hasNeighbour);
    }
    core::report(progress, 1);
    return result;
}

bool isToothLike(const Candidate& candidate) {
    constexpr double kMinMm3 = 60.0, kMaxMm3 = 2500.0, kMaxMm = 35.0, kMinThickMm = 3.0, kMinLongMm = 7.0;
    constexpr double kMinFilled = 0.15;  // of its box: a tooth that lies across the axes has a fifth
    const Vec3 size = candidate.boundsMm.size();
    const double shortest = size.minCoeff(), longest = size.maxCoeff();
    return candidate.volumeMm3 >= kMinMm3 && candidate.volumeMm3 <= kMaxMm3 && longest <= kMaxMm &&
           shortest >= kMinThickMm && longest >= kMinLongMm && candidate.volumeMm3 >= kMinFilled * size.prod();
}

std::vector<Candidate> findTeeth(const volume::Volume& volume, const Thresholds& thresholds,
                                 const core::Progress& progress) {
    return partTeeth(volume, thresholds, progress).teeth;
}

}  // namespace handpiece::segmentation
