// SPDX-License-Identifier: Apache-2.0
// Quanta that a scintillator counts, and how its light spreads.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/split_mix.h"
#include "handpiece/senses/radiograph/radiograph.h"

namespace handpiece::radiograph {
namespace {

/// In (0, 1).
double uniform(std::uint64_t bits) {
    return (static_cast<double>(bits >> 12) + 0.5) * 0x1p-52;
}

/// A Poisson number of this mean: products of uniform numbers where few are expected (Knuth), else a rounded normal
/// one, whose skew of 1 / sqrt(mean) is lost there.
double poisson(double mean, std::uint64_t key) {
    constexpr double kFew = 40.0;
    if (mean < kFew) {
        const double limit = core::exp(-mean);
        double product = 1.0;
        for (std::uint64_t n = 0;; ++n) {
            product *= uniform(core::splitMix(key + n));
            if (product <= limit) return static_cast<double>(n);
        }
    }
    const double radius = std::sqrt(-2.0 * core::log(uniform(core::splitMix(key))));
    const double normal = radius * core::cos(2.0 * std::numbers::pi * uniform(core::splitMix(key + 1)));
    return std::max(0.0, std::floor(mean + std::sqrt(mean) * normal + 0.5));
}

/// Along rows or columns, with the border's values beyond it.
void blurLines(std::vector<float>& signal, std::size_t lines, std::size_t count, std::size_t lineStep, std::size_t step,
               const std::vector<double>& weights) {
    const auto reach = static_cast<std::ptrdiff_t>(weights.size() / 2), last = static_cast<std::ptrdiff_t>(count) - 1;
    core::parallelFor(lines, 16, [&](std::size_t begin, std::size_t end) {
        std::vector<double> line(count);
        for (std::size_t l = begin; l < end; ++l) {
            float* values = &signal[l * lineStep];
            for (std::size_t n = 0; n < count; ++n)
                line[n] = static_cast<double>(values[n * step]);
            for (std::ptrdiff_t n = 0; n <= last; ++n) {
                double sum = 0.0;
                for (std::ptrdiff_t w = -reach; w <= reach; ++w)
                    sum += weights[static_cast<std::size_t>(w + reach)] *
                           line[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(n + w, 0, last))];
                values[static_cast<std::size_t>(n) * step] = static_cast<float>(sum);
            }
        }
    });
}

}  // namespace

void detect(Exposure& exposure, const Settings& settings) {
    check(settings);
    if (settings.quanta > 0.0) {
        const std::uint64_t seed = core::splitMix(settings.seed);
        core::parallelFor(exposure.signal.size(), 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t p = begin; p < end; ++p)
                exposure.signal[p] = static_cast<float>(
                    poisson(settings.quanta * static_cast<double>(exposure.signal[p]), core::splitMix(seed ^ (p + 1))) /
                    settings.quanta);
        });
    }
    const double sigma = settings.blurUm / settings.pixelUm;
    if (sigma <= 0.0) return;
    const int reach = static_cast<int>(std::ceil(4.0 * sigma));
    std::vector<double> weights(static_cast<std::size_t>(2 * reach + 1));
    double sum = 0.0;
    for (int w = -reach; w <= reach; ++w) {
        const double x = w / sigma;
        weights[static_cast<std::size_t>(w + reach)] = core::exp(-0.5 * x * x);
        sum += weights[static_cast<std::size_t>(w + reach)];
    }
    for (double& w : weights)
        w /= sum;
    const auto width = static_cast<std::size_t>(exposure.width), height = static_cast<std::size_t>(exposure.height);
    blurLines(exposure.signal, height, width, width, 1, weights);
    blurLines(exposure.signal, width, height, 1, width, weights);
}

}  // namespace handpiece::radiograph
