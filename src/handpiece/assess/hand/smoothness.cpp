// SPDX-License-Identifier: Apache-2.0
#include "handpiece/assess/hand/smoothness.h"

#include <bit>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "handpiece/base/core/portable_math.h"

namespace handpiece::hand {

std::optional<double> spectralArcLength(std::span<const double> speed, double rateHz,
                                        const ArcLengthSettings& settings) {
    constexpr std::size_t kMostSamples = std::size_t{1} << 16;
    if (speed.size() < 4 || speed.size() > kMostSamples || !(rateHz > 0.0)) return {};
    double most = 0.0;
    for (const double v : speed) {
        if (!std::isfinite(v)) return {};
        most += std::abs(v);
    }
    if (!(most > 0.0)) return {};

    const std::size_t points = std::bit_ceil(speed.size()) << settings.padding;
    const double stepHz = rateHz / static_cast<double>(points);
    const std::size_t last =
        std::min(points / 2, static_cast<std::size_t>(std::floor(settings.cutOffHz / stepHz + 1e-9)));
    std::vector<double> cosine(points), sine(points);
    for (std::size_t i = 0; i < points; ++i) {
        const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(points);
        cosine[i] = core::cos(angle);
        sine[i] = core::sin(angle);
    }
    // Few of the frequencies are asked for: summed one by one.
    std::vector<double> magnitude(last + 1);
    double greatest = 0.0;
    for (std::size_t k = 0; k <= last; ++k) {
        double real = 0.0, imaginary = 0.0;
        for (std::size_t i = 0, turn = 0; i < speed.size(); ++i, turn = (turn + k) & (points - 1)) {
            real += speed[i] * cosine[turn];
            imaginary += speed[i] * sine[turn];
        }
        magnitude[k] = std::sqrt(real * real + imaginary * imaginary);
        greatest = std::max(greatest, magnitude[k]);
    }
    std::size_t from = magnitude.size(), to = 0;
    for (std::size_t k = 0; k <= last; ++k) {
        magnitude[k] /= greatest;
        if (magnitude[k] < settings.threshold) continue;
        from = std::min(from, k);
        to = k;
    }
    if (from >= to) return {};
    const double along = 1.0 / static_cast<double>(to - from);
    double length = 0.0;
    for (std::size_t k = from; k < to; ++k) {
        const double up = magnitude[k + 1] - magnitude[k];
        length += std::sqrt(along * along + up * up);
    }
    return -length;
}

}  // namespace handpiece::hand
