// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "handpiece/assess/agreement/agreement.h"
#include "handpiece/base/core/portable_math.h"

namespace handpiece::agreement {
namespace {

/// Of a positive number: Stirling's series with 8 terms above 10, where its error is under 1e-16; below by recurrence.
double logGamma(double x) {
    double product = 1.0;
    for (; x < 10.0; x += 1.0)
        product *= x;
    constexpr double kTerms[] = {1.0 / 12,   -1.0 / 360,      1.0 / 1260, -1.0 / 1680,
                                 1.0 / 1188, -691.0 / 360360, 1.0 / 156,  -3617.0 / 122400};
    double series = 0.0, power = 1.0 / x;
    for (const double term : kTerms) {
        series += term * power;
        power /= x * x;
    }
    constexpr double kHalfLogTwoPi = 0.91893853320467274178;
    return (x - 0.5) * core::log(x) - x + kHalfLogTwoPi + series - core::log(product);
}

/// Continued fraction of the incomplete beta function by Lentz's method (Numerical Recipes, 6.4); for x under
/// (a + 1) / (a + b + 2).
double betaFraction(double a, double b, double x) {
    constexpr double kTiny = 1e-300;
    const auto held = [](double v) { return std::abs(v) < kTiny ? kTiny : v; };
    double c = 1.0, d = 1.0 / held(1.0 - (a + b) * x / (a + 1.0)), h = d;
    for (int m = 1; m <= 10000; ++m) {
        const double n = m, even = n * (b - n) * x / ((a + 2 * n - 1.0) * (a + 2 * n));
        d = 1.0 / held(1.0 + even * d);
        c = held(1.0 + even / c);
        h *= d * c;
        const double odd = -(a + n) * (a + b + n) * x / ((a + 2 * n) * (a + 2 * n + 1.0));
        d = 1.0 / held(1.0 + odd * d);
        c = held(1.0 + odd / c);
        const double step = d * c;
        h *= step;
        if (std::abs(step - 1.0) < 1e-15) break;
    }
    return h;
}

/// Regularised incomplete beta function; `rest` is 1 - x, given apart so that small ones are kept.
double betaShare(double a, double b, double x, double rest) {
    if (x <= 0.0) return 0.0;
    if (rest <= 0.0) return 1.0;
    const double front =
        core::exp(logGamma(a + b) - logGamma(a) - logGamma(b) + a * core::log(x) + b * core::log(rest));
    if (x < (a + 1.0) / (a + b + 2.0)) return front * betaFraction(a, b, x) / a;
    return 1.0 - front * betaFraction(b, a, rest) / b;
}

/// Where a rising function comes to `share`, above 0.
template <class Below>
double solve(double share, const Below& below) {
    double low = 0.0, high = 1.0;
    while (below(high) < share && high < 1e300)
        low = high, high *= 2.0;
    for (int i = 0; i < 2000 && high - low > 0.0; ++i) {
        const double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high) break;
        (below(middle) < share ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

}  // namespace

double studentBelow(double x, double degrees) {
    const double squared = x * x;
    const double tail =
        0.5 * betaShare(0.5 * degrees, 0.5, degrees / (degrees + squared), squared / (degrees + squared));
    return x > 0.0 ? 1.0 - tail : tail;
}

double studentAt(double share, double degrees) {
    if (share < 0.5) return -studentAt(1.0 - share, degrees);
    return solve(share, [&](double x) { return studentBelow(x, degrees); });
}

double fisherBelow(double x, double degrees1, double degrees2) {
    if (x <= 0.0) return 0.0;
    const double whole = degrees1 * x + degrees2;
    return betaShare(0.5 * degrees1, 0.5 * degrees2, degrees1 * x / whole, degrees2 / whole);
}

double fisherAt(double share, double degrees1, double degrees2) {
    return solve(share, [&](double x) { return fisherBelow(x, degrees1, degrees2); });
}

}  // namespace handpiece::agreement
