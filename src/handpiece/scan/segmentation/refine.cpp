// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "handpiece/base/core/parallel.h"
#include "handpiece/scan/segmentation/work.h"

namespace handpiece::segmentation {

namespace {
constexpr int kRounds = 7, kMaxRounds = 14, kVariedRounds = 10;
constexpr double kWideBlur = 1.2;      ///< voxels: above it surfaces start further off and need more rounds
constexpr float kMinContrast = 0.12f;  ///< of the step from outside to dentine: below it grey values say nothing
constexpr float kReach = 1.6f;         ///< voxels beside a surface that are moved
constexpr float kAside = 0.7f;         ///< voxels: further out than this nothing of the tooth fills a voxel
constexpr double kSqrtPi = 1.7724538509055159;

/// One inner tissue as the model of the scan sees it.
struct Layer {
    Field* inside;
    float* level;
    bool isOpen;  ///< the level is fitted too
};

/// Standard deviation of the blur [voxels]: how far the outer surface's profile lies from a step. `work.outer` must be
/// a distance; only places with one tissue behind them count, and, where `seen` is not empty, only those that it shows
/// free: others have bone or gum before them.
double blurOf(const Work& work, const Field& seen) {
    const Shape& shape = work.shape;
    const Thresholds& t = work.levels;
    constexpr int kBins = 24;
    constexpr float kWindow = 2.4f, kAlone = 2.0f;  // voxels: samples, and how far any other surface is
    constexpr double kAhead = 3;
    const float free = t.outside + 0.12f * (t.dentine - t.outside);
    std::vector<double> sum(kBins, 0.0), count(kBins, 0.0);
    for (int k = 3; k + 3 < shape.size[2]; ++k)
        for (int j = 3; j + 3 < shape.size[1]; ++j)
            for (int i = 3; i + 3 < shape.size[0]; ++i) {
                const std::size_t at = shape.index(i, j, k);
                const float d = work.outer[at];
                if (d <= -kWindow || d >= kWindow) continue;
                const bool isDentine = work.dentine[at] > kAlone;
                if (!isDentine && work.dentine[at] > -kAlone) continue;
                if (!work.caries.empty() && work.caries[at] > -kAlone) continue;
                if (!work.pulp.empty() && work.pulp[at] > -kAlone) continue;
                if (!work.restoration.empty() && work.restoration[at] > -kAlone) continue;
                if (!seen.empty()) {
                    const core::Vec3 n = gradient(shape, work.outer, i, j, k).normalized();
                    const core::Vec3 before = core::Vec3(i, j, k) - (d + kAhead) * n;
                    if (!(sample(shape, seen, before) < free && sample(shape, seen, before - n) < free)) continue;
                }
                const float level = isDentine ? t.dentine : t.enamel;
                const double share = (work.raw[at] - t.outside) / (level - t.outside);
                const int bin = static_cast<int>((d + kWindow) / (2 * kWindow) * kBins);
                sum[static_cast<std::size_t>(bin)] += share;
                count[static_cast<std::size_t>(bin)] += 1;
            }
    double area = 0;
    for (int b = 0; b < kBins; ++b) {
        const auto n = static_cast<std::size_t>(b);
        if (count[n] < 20) return work.sigma;
        const double mean = sum[n] / count[n];
        const double d = ((b + 0.5) / kBins * 2 - 1) * static_cast<double>(kWindow);
        area += (d > 0 ? 1 - mean : mean) * 2 * static_cast<double>(kWindow) / kBins;
    }
    // A step blurred by sigma leaves an area of 2 sigma / sqrt(2 pi); a voxel's own width is modelled apart.
    const double whole = area * 2.5066 / 2;
    return std::clamp(std::sqrt(std::max(0.0, whole * whole - 1.0 / 12)), 0.35, 2.5);
}

/// The scan as the surfaces would give it: grey levels by how far each tissue fills a voxel, before blur.
void compose(const Work& work, const std::vector<Layer>& layers, Field& out) {
    out.resize(work.shape.count());
    const Thresholds& t = work.levels;
    core::parallelFor(out.size(), 1 << 15, [&](std::size_t from, std::size_t to) {
        for (std::size_t n = from; n < to; ++n)
            out[n] = t.enamel;
        for (const Layer& layer : layers) {
            const float* inside = layer.inside->data();
            const float level = *layer.level;
            for (std::size_t n = from; n < to; ++n)
                out[n] += coverage(inside[n]) * (level - out[n]);
        }
        for (std::size_t n = from; n < to; ++n) {
            const float outside = work.around.empty() ? t.outside : work.around[n];
            out[n] = outside + coverage(work.outer[n]) * (out[n] - outside);
        }
    });
}

/// Goes on with what lies around the tooth up to its surface and a little into it: grey values there are mixed.
void spreadAround(Work& work) {
    Mask unknown(work.shape.count());
    for (std::size_t n = 0; n < unknown.size(); ++n)
        unknown[n] = work.outer[n] < -kAside ? 0 : (work.outer[n] < 2.5f ? 1 : 2);
    spreadInto(work.shape, work.around, unknown);
}

/// By how much a tissue is brighter than the model says, well inside it.
float levelError(const Work& work, const Field& inside, const Field& difference) {
    double sum = 0, count = 0;
    for (std::size_t n = 0; n < inside.size(); ++n)
        if (inside[n] > 0.8f && work.outer[n] > 2) sum += static_cast<double>(difference[n]), count += 1;
    return count < 20 ? 0.0f : static_cast<float>(sum / count);
}

/// Dentine's and enamel's levels likewise; what is thin never shows its own grey, but its share of the blur is known.
void fitHardTissues(Work& work, const Field& difference) {
    double enamel = 0, enamelCount = 0, dentine = 0, dentineCount = 0;
    for (std::size_t n = 0; n < difference.size(); ++n) {
        if (work.outer[n] < 1.5f) continue;
        const auto isNear = [&](const Field& inside) { return !inside.empty() && inside[n] > -1.5f; };
        if (isNear(work.pulp) || isNear(work.caries) || isNear(work.restoration)) continue;
        if (work.dentine[n] > 1.2f && work.outer[n] > 2)
            dentine += static_cast<double>(difference[n]), dentineCount += 1;
        if (work.dentine[n] < -1.0f) enamel += static_cast<double>(difference[n]), enamelCount += 1;
    }
    Thresholds& t = work.levels;
    if (dentineCount > 200) t.dentine += static_cast<float>(dentine / dentineCount);
    if (!std::isfinite(t.enamelFrom)) {
        t.enamel = t.dentine;
        return;
    }
    if (enamelCount > 200) t.enamel += static_cast<float>(enamel / enamelCount);
    t.enamelFrom = 0.5f * (t.dentine + t.enamel);
}

/// Bone and gum around the tooth: one grey level does not stand for the outside.
bool isGroundVaried(const Work& work) {
    const Thresholds& t = work.levels;
    return work.groundLevel > t.outside + 0.05f * (t.dentine - t.outside);
}

/// Moves every surface by what the blurred difference says, each by its own contrast.
void move(Work& work, const std::vector<Layer>& layers, const Field& pull, float gain) {
    const Thresholds& t = work.levels;
    const float least = kMinContrast * (t.dentine - t.outside);
    core::parallelFor(pull.size(), 1 << 14, [&](std::size_t from, std::size_t to) {
        for (std::size_t n = from; n < to; ++n) {
            if (work.outer[n] <= -kReach) continue;
            float level = t.enamel;
            for (const Layer& layer : layers) {
                float& inside = (*layer.inside)[n];
                const float c = coverage(inside);
                if (std::abs(inside) < kReach && work.outer[n] > 0) {
                    const float contrast = *layer.level - level;
                    if (std::abs(contrast) > least)
                        inside +=
                            std::clamp(gain * pull[n] / contrast, -0.35f, 0.35f) * std::min(1.0f, work.outer[n] + 0.3f);
                }
                level += c * (*layer.level - level);
            }
            if (std::abs(work.outer[n]) < kReach && !work.held[n]) {
                const float contrast = level - (work.around.empty() ? t.outside : work.around[n]);
                if (contrast > least) work.outer[n] += std::clamp(gain * pull[n] / contrast, -0.35f, 0.35f);
            }
        }
    });
}

/// Evens a surface out a little, where it is one.
void even(const Shape& shape, Field& inside, Field& scratch, float share) {
    scratch = inside;
    forRows(shape, [&](int j, int k) {
        if (j == 0 || k == 0 || j + 1 == shape.size[1] || k + 1 == shape.size[2]) return;
        for (int i = 1; i + 1 < shape.size[0]; ++i) {
            const std::size_t at = shape.index(i, j, k);
            if (std::abs(inside[at]) > 2) continue;
            const float mean =
                (scratch[at - 1] + scratch[at + 1] + scratch[at - shape.rowStride()] + scratch[at + shape.rowStride()] +
                 scratch[at - shape.sliceStride()] + scratch[at + shape.sliceStride()]) /
                6;
            inside[at] += share * (mean - scratch[at]);
        }
    });
}
}  // namespace

void refine(Work& work, const core::Progress& progress) {
    Thresholds& t = work.levels;
    std::vector<Layer> layers{{&work.dentine, &t.dentine, false}};
    if (!work.pulp.empty()) layers.push_back({&work.pulp, &t.pulp, false});
    if (!work.caries.empty()) layers.push_back({&work.caries, &work.cariesLevel, true});
    if (!work.restoration.empty()) layers.push_back({&work.restoration, &work.restorationLevel, true});
    const float brightest =
        work.restoration.empty() ? t.enamel + 0.5f * (t.enamel - t.outside) : work.restorationLevel * 1.2f;
    Field& difference = work.damped;  // no stage after this one needs it
    const bool isVaried = isGroundVaried(work);
    Field seen;
    if (isVaried) {
        seen = work.damped;
        work.around = seen;
        spreadAround(work);
    }
    int rounds = isVaried ? kVariedRounds : kRounds;
    for (int round = 0; round < rounds; ++round) {
        if (round == 3 && work.sigma > kWideBlur) rounds = kMaxRounds;
        core::report(progress, static_cast<double>(round) / rounds);
        if (round < 4) work.sigma = blurOf(work, seen);
        compose(work, layers, difference);
        blur(work.shape, difference, difference, work.scratch, work.sigma);
        core::parallelFor(difference.size(), 1 << 15, [&](std::size_t from, std::size_t to) {
            for (std::size_t n = from; n < to; ++n) {
                // What is around is as it must be for its blur to look like the scan.
                if (isVaried && work.outer[n] < -kAside) work.around[n] += seen[n] - difference[n];
                difference[n] = work.outer[n] <= -kBand ? 0.0f : std::min(work.raw[n], brightest) - difference[n];
            }
        });
        if (round > 0)
            for (const Layer& layer : layers)
                if (layer.isOpen) *layer.level += levelError(work, *layer.inside, difference);
        if (round > 0 && work.areLevelsOpen) fitHardTissues(work, difference);
        core::report(progress, (round + 0.4) / rounds);
        blur(work.shape, difference, difference, work.scratch, work.sigma);
        const double gain = 0.7 * 2 * std::sqrt(work.sigma * work.sigma + 1.0 / 24) * kSqrtPi;
        move(work, layers, difference, static_cast<float>(gain));
        core::report(progress, (round + 0.7) / rounds);
        even(work.shape, work.outer, work.scratch, 0.06f);
        redistance(work.shape, work.outer, kBand);
        for (const Layer& layer : layers) {
            even(work.shape, *layer.inside, work.scratch, 0.06f);
            redistance(work.shape, *layer.inside, kBand);
        }
        if (isVaried) spreadAround(work);
    }
    core::report(progress, 1);
}

}  // namespace handpiece::segmentation
