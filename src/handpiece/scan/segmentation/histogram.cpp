// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/segmentation/histogram.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"

namespace handpiece::segmentation {

using core::Vec3;

core::Error nothingFound(const std::string& why) {
    return core::Error("empty segmentation: " + why, "scan",
                       "choose the series that shows the tooth, or give thresholds by hand")
        .as("scan-empty", {why});
}

Coarse coarsen(const volume::Volume& volume, double spacingMm, const core::Progress& progress) {
    Coarse coarse;
    const volume::Grid& grid = volume.grid;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double own = grid.spacingMm[static_cast<int>(axis)];
        coarse.factor[axis] = std::clamp(static_cast<int>(std::lround(spacingMm / own)), 1, grid.size[axis]);
        coarse.shape.size[axis] = grid.size[axis] / coarse.factor[axis];
        coarse.spacingMm[static_cast<int>(axis)] = own * coarse.factor[axis];
    }
    coarse.values.assign(coarse.shape.count(), 0);
    const float share = 1.0f / static_cast<float>(coarse.factor[0] * coarse.factor[1] * coarse.factor[2]);
    core::parallelFor(static_cast<std::size_t>(coarse.shape.size[2]), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k) {
            core::report(progress, 0.5);
            for (int dk = 0; dk < coarse.factor[2]; ++dk)
                for (int j = 0; j < coarse.shape.size[1]; ++j) {
                    float* out = &coarse.values[coarse.shape.index(0, j, static_cast<int>(k))];
                    for (int dj = 0; dj < coarse.factor[1]; ++dj) {
                        const float* in = &volume.values[grid.index(0, j * coarse.factor[1] + dj,
                                                                    static_cast<int>(k) * coarse.factor[2] + dk)];
                        for (int i = 0; i < coarse.shape.size[0]; ++i)
                            for (int di = 0; di < coarse.factor[0]; ++di)
                                out[i] += share * *in++;
                    }
                }
        }
    });
    return coarse;
}

std::vector<Peak> findPeaks(const Shape& shape, const Field& values) {
    // Between two tissues every grey in between occurs: voxels that differ from their neighbours count for little, so
    // that peaks stand apart.
    Field steps(values.size(), -1.0f);
    forRows(shape, [&](int j, int k) {
        if (j == 0 || k == 0 || j + 1 >= shape.size[1] || k + 1 >= shape.size[2]) return;
        for (int i = 1; i + 1 < shape.size[0]; ++i)
            steps[shape.index(i, j, k)] = static_cast<float>(gradient(shape, values, i, j, k).norm());
    });
    std::vector<float> sorted;
    const std::size_t stride = 1 + values.size() / 400000;
    for (std::size_t n = 0; n < values.size(); n += stride)
        if (steps[n] >= 0 && std::isfinite(values[n])) sorted.push_back(steps[n]);
    if (sorted.size() < 100) throw nothingFound("the scan is too small");
    std::sort(sorted.begin(), sorted.end());

    std::vector<float> greys;
    for (std::size_t n = 0; n < values.size(); n += stride)
        if (std::isfinite(values[n])) greys.push_back(values[n]);
    std::sort(greys.begin(), greys.end());
    const float low = greys[greys.size() / 2000], high = greys[greys.size() - 1 - greys.size() / 2000];
    if (!(high > low)) return {{low, 1.0}};
    // Without noise nearly all is flat: then a little slope counts as flat too.
    const float limit = std::max(sorted[sorted.size() * 6 / 10], 0.015f * (high - low));
    constexpr int kBins = 1024;
    std::vector<double> bins(kBins, 0.0), sums(kBins, 0.0);
    double all = 0;
    for (std::size_t n = 0; n < values.size(); ++n) {
        if (!(steps[n] >= 0) || !std::isfinite(values[n])) continue;
        const double where = (values[n] - low) / (high - low) * (kBins - 1);
        const double ratio = steps[n] / limit;
        const double weight = 1.0 / (1.0 + ratio * ratio * ratio * ratio);
        all += weight;
        if (where < 0 || where > kBins - 1) continue;
        bins[static_cast<std::size_t>(where + 0.5)] += weight;
    }
    // A kernel as wide as the noise that is left; peaks must stand out of the saddles beside them.
    const double noiseBins = 0.5 * limit / (high - low) * kBins;
    const double sigma = std::clamp(noiseBins, 4.0, 24.0);
    std::vector<double> smooth(kBins, 0.0);
    const int radius = static_cast<int>(3 * sigma);
    double norm = 0;
    for (int d = -radius; d <= radius; ++d)
        norm += core::exp(-0.5 * d * d / (sigma * sigma));
    for (int b = 0; b < kBins; ++b)
        for (int d = -radius; d <= radius; ++d)
            if (b + d >= 0 && b + d < kBins)
                smooth[static_cast<std::size_t>(b)] +=
                    bins[static_cast<std::size_t>(b + d)] * core::exp(-0.5 * d * d / (sigma * sigma)) / norm;
    std::vector<int> tops, saddles;
    for (int b = 0; b < kBins; ++b) {
        const double v = smooth[static_cast<std::size_t>(b)];
        const double left = b > 0 ? smooth[static_cast<std::size_t>(b - 1)] : -1;
        const double right = b + 1 < kBins ? smooth[static_cast<std::size_t>(b + 1)] : -1;
        if (v > left && v >= right && v > 1e-6 * all) tops.push_back(b);
    }
    const auto lowest = [&](int a, int b) {
        int best = a;
        for (int n = a; n <= b; ++n)
            if (smooth[static_cast<std::size_t>(n)] < smooth[static_cast<std::size_t>(best)]) best = n;
        return best;
    };
    constexpr double kStandOut = 1.25;
    for (bool merged = true; merged && tops.size() > 1;) {
        merged = false;
        std::size_t worst = 0;
        double least = kStandOut;
        for (std::size_t t = 0; t + 1 < tops.size(); ++t) {
            const double saddle = smooth[static_cast<std::size_t>(lowest(tops[t], tops[t + 1]))];
            const double a = smooth[static_cast<std::size_t>(tops[t])],
                         b = smooth[static_cast<std::size_t>(tops[t + 1])];
            const double ratio = std::min(a, b) / std::max(saddle, 1e-300);
            if (ratio < least) {
                least = ratio;
                worst = a < b ? t : t + 1;
                merged = true;
            }
        }
        if (merged) tops.erase(tops.begin() + static_cast<std::ptrdiff_t>(worst));
    }
    std::vector<Peak> peaks;
    for (std::size_t t = 0; t < tops.size(); ++t) {
        const int from = t == 0 ? 0 : lowest(tops[t - 1], tops[t]);
        const int to = t + 1 == tops.size() ? kBins - 1 : lowest(tops[t], tops[t + 1]);
        double mass = 0, moment = 0, core = 0;
        const int reach = std::max(2, static_cast<int>(sigma));
        for (int b = from; b <= to; ++b)
            mass += bins[static_cast<std::size_t>(b)];
        for (int b = std::max(from, tops[t] - reach); b <= std::min(to, tops[t] + reach); ++b) {
            core += bins[static_cast<std::size_t>(b)];
            moment += bins[static_cast<std::size_t>(b)] * b;
        }
        const double centre = core > 0 ? moment / core : tops[t];
        if (mass > 2e-4 * all)
            peaks.push_back({low + static_cast<float>(centre / (kBins - 1)) * (high - low), mass / all});
    }
    return peaks;
}

namespace {
/// The commonest peak along the scan's faces: what surrounds the tooth, be it darkest or not.
std::size_t outsidePeak(const Coarse& coarse, const std::vector<Peak>& peaks) {
    std::vector<double> votes(peaks.size(), 0.0);
    const Shape& shape = coarse.shape;
    for (int k = 0; k < shape.size[2]; ++k)
        for (int j = 0; j < shape.size[1]; ++j)
            for (int i = 0; i < shape.size[0]; ++i) {
                const bool face = i == 0 || j == 0 || k == 0 || i + 1 == shape.size[0] || j + 1 == shape.size[1] ||
                                  k + 1 == shape.size[2];
                if (!face) continue;
                const float v = coarse.values[shape.index(i, j, k)];
                std::size_t best = 0;
                for (std::size_t p = 1; p < peaks.size(); ++p)
                    if (std::abs(peaks[p].value - v) < std::abs(peaks[best].value - v)) best = p;
                votes[best] += 1;
            }
    // What is common all through the scan counts too: a cropped scan's faces may lie in the jaw.
    std::size_t best = 0;
    double most = -1, total = 0;
    for (const double v : votes)
        total += v;
    for (std::size_t p = 0; p + 1 < peaks.size(); ++p) {
        const double score = votes[p] / total + 0.5 * peaks[p].mass;
        if (score > most) most = score, best = p;
    }
    return best;
}

constexpr float kHiding = 0.04f;  ///< of the step from the darkest peak to the brightest: such noise may hide peaks

/// Which peaks stand for the outside, dentine and enamel; enamel 0: no two hard tissues were told apart.
struct HardPeaks {
    std::size_t outside = 0, dentine = 0, enamel = 0;
};
HardPeaks hardPeaks(const Coarse& coarse, const std::vector<Peak>& peaks) {
    HardPeaks found;
    if (peaks.size() < 2) return found;
    found.outside = outsidePeak(coarse, peaks);
    const float outside = peaks[found.outside].value;
    // Enamel is the brightest thing of which there is enough; dentine the next below. Metal is too little or too far
    // up; bone and caries are darker than dentine.
    for (std::size_t e = peaks.size() - 1; e > found.outside + 1; --e)
        for (std::size_t d = e - 1; d > found.outside; --d) {
            const double ratio = (peaks[e].value - outside) / (peaks[d].value - outside);
            if (ratio < 1.25 || ratio > 2.7) continue;
            if (peaks[e].mass < 0.04 * peaks[d].mass || peaks[d].mass < 0.3 * peaks[e].mass) continue;
            found.dentine = d, found.enamel = e;
            return found;
        }
    return found;
}

/// The peak inside dark places that the tooth encloses, or the outside's.
float pulpPeak(const Coarse& coarse, const Thresholds& t) {
    const Shape& shape = coarse.shape;
    Mask tooth(shape.count());
    for (std::size_t n = 0; n < tooth.size(); ++n)
        tooth[n] = coarse.values[n] > t.toothFrom;
    const double spacing = coarse.spacingMm.maxCoeff();
    const int closing = std::max(1, static_cast<int>(std::lround(0.6 / spacing)));
    Mask wall = tooth;
    for (int n = 0; n < closing; ++n)
        wall = dilated(shape, wall);
    Mask open(wall.size());
    for (std::size_t n = 0; n < open.size(); ++n)
        open[n] = !wall[n];
    const Parts parts = connectedParts(shape, open);
    std::vector<std::uint8_t> touches(parts.counts.size(), 0);
    for (std::size_t n = 0; n < open.size(); ++n) {
        const auto [i, j, k] = shape.at(n);
        if (i == 0 || j == 0 || k == 0 || i + 1 == shape.size[0] || j + 1 == shape.size[1] || k + 1 == shape.size[2])
            touches[parts.of[n]] = 1;
    }
    std::vector<float> inside;
    for (std::size_t n = 0; n < open.size(); ++n)
        if (parts.of[n] != 0 && !touches[parts.of[n]]) inside.push_back(coarse.values[n]);
    if (inside.size() < 4) return t.outside;
    std::nth_element(inside.begin(), inside.begin() + static_cast<std::ptrdiff_t>(inside.size() / 2), inside.end());
    return inside[inside.size() / 2];
}
}  // namespace

Thresholds findThresholds(const volume::Volume& volume, const core::Progress& progress) {
    if (volume.values.size() != volume.grid.count() || volume.values.empty())
        throw nothingFound("the scan has no voxels");
    core::report(progress, 0);
    // Blocks of two voxels or more: less noise, and never more than some millions of them.
    const double spacing = volume.grid.spacingMm.minCoeff();
    double block = 2 * spacing;
    while (static_cast<double>(volume.grid.count()) * core::pow(spacing / block, 3) > 2.5e6)
        block += spacing;
    if (spacing >= 0.15) block = spacing;
    const Coarse coarse = coarsen(volume, block, core::part(progress, 0, 0.6));
    // Noise may hide a peak between two others: averaging shows it, but costs what is thin. So only where it is needed.
    std::vector<Peak> peaks = findPeaks(coarse.shape, coarse.values);
    HardPeaks found = hardPeaks(coarse, peaks);
    const bool isNoisy =
        peaks.size() > 1 && noiseOf(coarse.shape, coarse.values) > kHiding * (peaks.back().value - peaks.front().value);
    for (const double sigma : {0.8, 1.2}) {
        if (found.enamel != 0 && !(isNoisy && sigma < 1)) break;
        core::report(progress, 0.7);
        Field even, scratch;
        blur(coarse.shape, coarse.values, even, scratch, sigma);
        std::vector<Peak> others = findPeaks(coarse.shape, even);
        const HardPeaks again = hardPeaks(coarse, others);
        if (again.enamel == 0 || (found.enamel != 0 && others.size() <= peaks.size())) continue;
        peaks.swap(others);
        found = again;
    }
    core::report(progress, 0.8);
    if (peaks.size() < 2) throw nothingFound("all grey values belong together, there is nothing in the scan");
    const std::size_t outside = found.outside, enamel = found.enamel;
    std::size_t dentine = found.dentine;
    if (outside + 1 >= peaks.size()) throw nothingFound("nothing is brighter than the surroundings");

    Thresholds t;
    t.outside = peaks[outside].value;
    t.restorationFrom = std::numeric_limits<float>::infinity();
    if (enamel == 0) {  // one hard tissue alone
        dentine = outside + 1;
        for (std::size_t p = outside + 1; p < peaks.size(); ++p)
            if (peaks[p].mass > peaks[dentine].mass) dentine = p;
    }
    t.dentine = peaks[dentine].value;
    float below = t.outside;
    for (std::size_t p = outside + 1; p < dentine; ++p)
        if (peaks[p].mass > 0.3 * peaks[dentine].mass) below = peaks[p].value;  // bone
    t.toothFrom = 0.5f * (below + t.dentine);
    if (enamel != 0) {
        t.enamel = peaks[enamel].value;
        t.enamelFrom = 0.5f * (t.dentine + t.enamel);
        const float step = t.enamel - t.outside;
        for (std::size_t p = enamel + 1; p < peaks.size(); ++p)
            if (peaks[p].value > t.enamel + 0.2f * step) {
                t.restorationFrom = 0.5f * (t.enamel + peaks[p].value);
                break;
            }
        // A small filling makes no peak: what lies far above enamel is one.
        std::size_t above = 0;
        const float far = t.enamel + 0.6f * step;
        for (const float v : coarse.values)
            above += v > far ? 1 : 0;
        if (std::isinf(t.restorationFrom) && static_cast<double>(above) * coarse.spacingMm.prod() > 0.3)
            t.restorationFrom = t.enamel + 0.4f * step;
    } else {
        t.enamel = t.dentine;
        t.enamelFrom = std::numeric_limits<float>::infinity();
    }
    t.pulp = pulpPeak(coarse, t);
    core::report(progress, 1);
    return t;
}

}  // namespace handpiece::segmentation
