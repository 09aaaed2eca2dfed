// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// An ear for tests: levels, tones and clicks by plain sums, sharing nothing with what is tested.

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace handpiece::test {

inline double rms(const std::vector<double>& x, std::size_t begin, std::size_t end) {
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i)
        sum += x[i] * x[i];
    return std::sqrt(sum / static_cast<double>(end - begin));
}
inline double rms(const std::vector<double>& x) {
    return rms(x, 0, x.size());
}
inline double db(double ratio) {
    return 20.0 * std::log10(std::max(ratio, 1e-12));
}

/// Strength of one frequency, Hann window: amplitude of a sine of it.
inline double tone(const std::vector<double>& x, double hz, double rateHz = 48000.0) {
    std::complex<double> sum = 0.0;
    const auto n = static_cast<double>(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double at = static_cast<double>(i), window = 1.0 - std::cos(2.0 * std::numbers::pi * (at + 0.5) / n);
        sum += x[i] * window * std::polar(1.0, -2.0 * std::numbers::pi * hz * at / rateHz);
    }
    return 2.0 * std::abs(sum) / n;
}

/// The strongest frequency within `share` of `nearHz`.
inline double peakNear(const std::vector<double>& x, double nearHz, double share) {
    const double step = 0.25 * 48000.0 / static_cast<double>(x.size());
    double best = 0.0, at = 0.0;
    for (double hz = nearHz * (1.0 - share); hz <= nearHz * (1.0 + share); hz += step)
        if (const double strength = tone(x, hz); strength > best) {
            best = strength;
            at = hz;
        }
    return at;
}

/// The click of a signal that is low in pitch: the height of the jump that would leave the largest sixth difference
/// found in it. A step of h leaves 10 h (the largest binomial of differences of a step); a sine of f leaves
/// (2 sin(pi f / rate))^6, 1e-8 of itself at 300 Hz.
inline double click(const std::vector<double>& x, std::size_t begin = 0, std::size_t end = ~std::size_t{0}) {
    double worst = 0.0;
    for (std::size_t i = std::max<std::size_t>(6, begin); i < std::min(end, x.size()); ++i)
        worst = std::max(worst, std::abs(x[i] - 6 * x[i - 1] + 15 * x[i - 2] - 20 * x[i - 3] + 15 * x[i - 4] -
                                         6 * x[i - 5] + x[i - 6]));
    return worst / 10.0;
}

}  // namespace handpiece::test
