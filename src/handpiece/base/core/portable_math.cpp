// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/portable_math.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

namespace handpiece::core {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();

/// An unevaluated sum of two doubles, the lower one below the last place of the higher: some 105 bits (Dekker 1971).
struct Pair {
    double high, low = 0.0;
    [[nodiscard]] double rounded() const { return high + low; }
};

/// a + b without an error, for |a| >= |b| or a = 0.
Pair orderedSum(double a, double b) {
    const double s = a + b;
    return {s, b - (s - a)};
}
Pair sum(double a, double b) {
    const double s = a + b, t = s - a;
    return {s, (a - (s - t)) + (b - t)};
}
/// a * b without an error, for magnitudes from 2^-480 to 2^480.
Pair product(double a, double b) {
    const auto upperHalf = [](double v) {
        const double t = 134217729.0 * v;
        return t - (t - v);
    };
    const double p = a * b, a1 = upperHalf(a), a2 = a - a1, b1 = upperHalf(b), b2 = b - b1;
    return {p, ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2};
}
Pair operator-(Pair a) {
    return {-a.high, -a.low};
}
Pair operator+(Pair a, Pair b) {
    const Pair s = sum(a.high, b.high);
    return orderedSum(s.high, s.low + (a.low + b.low));
}
Pair operator*(Pair a, Pair b) {
    const Pair p = product(a.high, b.high);
    return orderedSum(p.high, p.low + (a.high * b.low + a.low * b.high));
}
Pair operator/(Pair a, Pair b) {
    const double q = a.high / b.high;
    const Pair p = product(q, b.high);
    return orderedSum(q, (((a.high - p.high) - p.low) + (a.low - q * b.low)) / b.high);
}
Pair squareRoot(Pair a) {
    if (!(a.high > 0.0)) return {0.0};
    const double s = std::sqrt(a.high);
    const Pair p = product(s, s);
    return orderedSum(s, ((a.high - p.high) - p.low + a.low) / (2.0 * s));
}

/// c0 + c1 x + c2 x^2 ...
double polynomial(double, double c) {
    return c;
}
template <typename... More>
double polynomial(double x, double c, More... more) {
    return c + x * polynomial(x, more...);
}

/// 2^n for a normal result.
double powerOfTwo(int n) {
    return std::bit_cast<double>(static_cast<std::uint64_t>(1023 + n) << 52U);
}

constexpr Pair kPi{0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53}, kHalfPi{0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54},
    kThird{1.0 / 3.0, 0x1.5555555555555p-56};

/// An angle as `quarters` of a turn, of which only the last two bits count, and a rest within 45 degrees and a little.
struct Reduced {
    int quarters;
    Pair rest;
};

/// For rad >= 2^20: the bits of rad * 2 / pi that matter, in whole numbers (Payne and Hanek 1983).
Reduced reduceLarge(double rad) {
    static constexpr std::array<std::uint32_t, 38> kTwoOverPi = {
        0xa2f9836e, 0x4e441529, 0xfc2757d1, 0xf534ddc0, 0xdb629599, 0x3c439041, 0xfe5163ab, 0xdebbc561,
        0xb7246e3a, 0x424dd2e0, 0x06492eea, 0x09d1921c, 0xfe1deb1c, 0xb129a73e, 0xe88235f5, 0x2ebb4484,
        0xe99c7026, 0xb45f7e41, 0x3991d639, 0x835339f4, 0x9c845f8b, 0xbdf9283b, 0x1ff897ff, 0xde05980f,
        0xef2f118b, 0x5a0a6d1f, 0x6d367ecf, 0x27cb09b7, 0x4f463f66, 0x9e5fea2d, 0x7527bac7, 0xebe5f17b,
        0x3d0739f7, 0x8a5292ea, 0x6bfb5fb1, 0x1f8d5d08, 0x56033046, 0xfc7b6bab};
    const auto bits = std::bit_cast<std::uint64_t>(rad);
    const std::uint64_t mantissa = (bits & ((1ULL << 52U) - 1)) | (1ULL << 52U);
    const int exponent = static_cast<int>(bits >> 52U) - 1075;  // rad = mantissa * 2^exponent
    // Words before the first make whole turns. The product of seven words and the mantissa, lowest limb first; its unit
    // is 2^(exponent - 32 (first + 7)).
    const int first = std::max(0, (exponent - 2) / 32);
    std::array<std::uint32_t, 9> limbs{};
    for (std::size_t i = 0; i < 7; ++i) {
        const std::uint64_t word = kTwoOverPi[static_cast<std::size_t>(first) + 6 - i];
        std::uint64_t carry = 0;
        for (std::size_t j = 0; j < 2; ++j) {
            carry += word * ((mantissa >> (32 * j)) & 0xffffffffU) + limbs[i + j];
            limbs[i + j] = static_cast<std::uint32_t>(carry);
            carry >>= 32U;
        }
        limbs[i + 2] = static_cast<std::uint32_t>(carry);
    }
    // Shifted so that the two bits before the point stand on top of the upmost of seven limbs.
    const int top = 32 * (first + 7) - exponent + 2;  // in bits from the bottom
    std::array<std::uint32_t, 7> turn{};
    for (int i = 0; i < 7; ++i) {
        const int from = top - 32 * (7 - i);
        const auto limb = [&](int k) -> std::uint64_t {
            return k >= 0 && k < 9 ? limbs[static_cast<std::size_t>(k)] : 0U;
        };
        const int word = from >= 0 ? from / 32 : -((31 - from) / 32), shift = from - 32 * word;
        turn[static_cast<std::size_t>(i)] = static_cast<std::uint32_t>((limb(word) | limb(word + 1) << 32U) >> shift);
    }
    // Rounded to the nearest quarter, what is over can be negative: then all its bits are turned round.
    const std::uint32_t quarters = (turn[6] + (1U << 29U)) >> 30U;
    turn[6] -= quarters << 30U;
    const bool isNegative = turn[6] >> 31U;
    Pair over{0.0};
    for (std::size_t i = 0; i < 7; ++i)
        over = sum(static_cast<double>(isNegative ? ~turn[i] : turn[i]) * powerOfTwo(32 * static_cast<int>(i) - 222),
                   0.0) +
               over;
    return {static_cast<int>(quarters), (isNegative ? -over : over) * kHalfPi};
}

/// For rad >= 0, finite.
Reduced reduce(double rad) {
    if (rad >= 0x1p20) return reduceLarge(rad);
    const double n = std::floor(rad * 0x1.45f306dc9c883p-1 + 0.5);
    if (n == 0.0) return {0, {rad}};
    // pi / 2 in parts of 33 bits, whose products with n < 2^20 are exact, and a last one (Cody and Waite 1980).
    const Pair a = sum(rad - n * 0x1.921fb544p+0, -n * 0x1.0b4611a6p-34), b = sum(a.high, -n * 0x1.3198a2ep-69),
               c = sum(b.high, -n * 0x1.b839a252049c1p-104);
    return {static_cast<int>(n), orderedSum(c.high, a.low + (b.low + c.low))};
}

/// Taylor's series within 45 degrees, the last term below 2^-58 of the sum.
Pair sineSeries(Pair r) {
    const double z = r.high * r.high;
    const double more = r.high * z *
                        polynomial(z, -1 / 6.0, 1 / 120.0, -1 / 5040.0, 1 / 362880.0, -1 / 39916800.0, 1 / 6227020800.0,
                                   -1 / 1307674368000.0, 1 / 355687428096000.0);
    return orderedSum(r.high, r.low * (1.0 - 0.5 * z) + more);
}
Pair cosineSeries(Pair r) {
    const double z = r.high * r.high, c = 1.0 - 0.5 * z;
    const double more = z * z *
                        polynomial(z, 1 / 24.0, -1 / 720.0, 1 / 40320.0, -1 / 3628800.0, 1 / 479001600.0,
                                   -1 / 87178291200.0, 1 / 20922789888000.0);
    return orderedSum(c, ((1.0 - c) - 0.5 * z) + (more - r.high * r.low));
}

/// For rad >= 0, finite: the sine `quarters` of a turn farther on.
double sineAhead(double rad, int quarters) {
    const Reduced reduced = reduce(rad);
    const int q = reduced.quarters + quarters;
    const double value = ((q & 1) != 0 ? cosineSeries(reduced.rest) : sineSeries(reduced.rest)).rounded();
    return (q & 2) != 0 ? -value : value;
}

/// The angle of (x, y) from the x axis, both from 0 to 2^500 and not both below 2^-480.
Pair arc(Pair y, Pair x) {
    static constexpr std::array<Pair, 9> kArcOfEighths = {{{0.0, 0.0},
                                                           {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
                                                           {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
                                                           {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
                                                           {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
                                                           {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
                                                           {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
                                                           {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
                                                           {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}}};
    const bool isSteep = y.high > x.high;
    if (isSteep) std::swap(x, y);
    // atan(t) = atan(k) + atan((t - k) / (1 + t k)), with k the nearest eighth.
    const auto eighths = static_cast<std::size_t>(8.0 * (y.high / x.high) + 0.5);
    Pair u;
    if (eighths == 0) {
        u = y / x;
    } else {
        const Pair k{0.125 * static_cast<double>(eighths)};
        u = (y + -(x * k)) / (x + y * k);
    }
    const double z = u.high * u.high;
    const double more = u.high * z * polynomial(z, -1 / 3.0, 1 / 5.0, -1 / 7.0, 1 / 9.0, -1 / 11.0, 1 / 13.0);
    const Pair a = kArcOfEighths[eighths] + (u + Pair{more});
    return isSteep ? kHalfPi + -a : a;
}

/// For a finite x > 0.
Pair logarithm(double x) {
    int exponent = 0;
    if (x < std::numeric_limits<double>::min()) {
        x *= 0x1p54;
        exponent = -54;
    }
    // x = 2^exponent m, with m between sqrt(1/2) and sqrt(2).
    constexpr std::uint64_t kRootOfHalf = 0x3fe6a09e667f3bcdU;
    const std::uint64_t above = std::bit_cast<std::uint64_t>(x) - kRootOfHalf;
    exponent += static_cast<int>(static_cast<std::int64_t>(above) >> 52U);
    const double m = std::bit_cast<double>((above & ((1ULL << 52U) - 1)) + kRootOfHalf);
    // log(m) = 2 (s + s^3 / 3 + ...), s = (m - 1) / (m + 1).
    const Pair s = Pair{m - 1.0} / sum(m, 1.0), z = s * s;
    const double more = z.high * polynomial(z.high, 1 / 5.0, 1 / 7.0, 1 / 9.0, 1 / 11.0, 1 / 13.0, 1 / 15.0, 1 / 17.0,
                                            1 / 19.0, 1 / 21.0, 1 / 23.0, 1 / 25.0);
    const Pair half = s + s * (z * (kThird + Pair{more}));
    const Pair whole = sum(exponent * 0x1.62e42fefa38p-1, exponent * 0x1.ef35793c7673p-45);
    return whole + Pair{2.0 * half.high, 2.0 * half.low};
}

double exponential(Pair x) {
    if (x.high > 710.0) return kInfinity;
    if (x.high < -746.0) return 0.0;
    // ln 2 in parts of 42 bits, whose products with n are exact.
    const double n = std::floor(x.high * 0x1.71547652b82fep+0 + 0.5);
    const Pair a = sum(x.high - n * 0x1.62e42fefa38p-1, -n * 0x1.ef35793c76p-45), r = orderedSum(a.high, a.low + x.low);
    const Pair z = r * r;
    const double more = r.high * z.high *
                        polynomial(r.high, 1 / 6.0, 1 / 24.0, 1 / 120.0, 1 / 720.0, 1 / 5040.0, 1 / 40320.0,
                                   1 / 362880.0, 1 / 3628800.0, 1 / 39916800.0, 1 / 479001600.0, 1 / 6227020800.0);
    const Pair e = Pair{1.0} + (r + Pair{0.5 * z.high, 0.5 * z.low + more});
    // In two steps: 2^n itself can be too large or too small.
    const int half = static_cast<int>(n) / 2;
    return e.rounded() * powerOfTwo(half) * powerOfTwo(static_cast<int>(n) - half);
}

}  // namespace

double sin(double rad) noexcept {
    if (!std::isfinite(rad)) return kNan;
    return std::abs(rad) < 0x1p-27 ? rad : std::copysign(1.0, rad) * sineAhead(std::abs(rad), 0);
}

double cos(double rad) noexcept {
    return std::isfinite(rad) ? sineAhead(std::abs(rad), 1) : kNan;
}

double tan(double rad) noexcept {
    if (!std::isfinite(rad)) return kNan;
    if (std::abs(rad) < 0x1p-27) return rad;
    const auto [quarters, rest] = reduce(std::abs(rad));
    const Pair sine = sineSeries(rest), cosine = cosineSeries(rest);
    return std::copysign(1.0, rad) * ((quarters & 1) != 0 ? -cosine / sine : sine / cosine).rounded();
}

double acos(double x) noexcept {
    if (!(std::abs(x) <= 1.0)) return kNan;
    const Pair a = arc(squareRoot(sum(1.0, -x) * sum(1.0, x)), {std::abs(x)});
    return (x < 0.0 ? kPi + -a : a).rounded();
}

double atan(double x) noexcept {
    return atan2(x, 1.0);
}

double atan2(double y, double x) noexcept {
    if (std::isnan(x) || std::isnan(y)) return kNan;
    double up = std::abs(y), along = std::abs(x);
    if (const double most = std::max(up, along); most == kInfinity) {
        up = up == kInfinity ? 1.0 : 0.0;
        along = along == kInfinity ? 1.0 : 0.0;
    } else if (most > 0x1p490) {
        up *= 0x1p-600;
        along *= 0x1p-600;
    } else if (most < 0x1p-400) {
        up *= 0x1p600;
        along *= 0x1p600;
    }
    const bool isBehind = std::signbit(x);
    if (up == 0.0 && along == 0.0) return std::copysign(isBehind ? kPi.high : 0.0, y);
    // The series' second term does not show; and what follows would lose bits of a very small y.
    if (up < 0x1p-30 * along && !isBehind) return y / x;
    const Pair a = arc({up}, {along});
    return std::copysign((isBehind ? kPi + -a : a).rounded(), y);
}

double exp(double x) noexcept {
    return std::isnan(x) ? kNan : exponential({x});
}

double log(double x) noexcept {
    if (!(x >= 0.0)) return kNan;
    if (x == 0.0 || x == kInfinity) return x == 0.0 ? -kInfinity : kInfinity;
    return logarithm(x).rounded();
}

double pow(double x, double y) noexcept {
    if (y == 0.0 || x == 1.0) return 1.0;
    if (std::isnan(x) || std::isnan(y)) return kNan;
    const double size = std::abs(x);
    if (std::abs(y) == kInfinity) return size == 1.0 ? 1.0 : (size > 1.0) == (y > 0.0) ? kInfinity : 0.0;
    const double sign = std::signbit(x) && std::abs(std::fmod(y, 2.0)) == 1.0 ? -1.0 : 1.0;
    if (size == 0.0 || size == kInfinity) return sign * ((size == 0.0) == (y < 0.0) ? kInfinity : 0.0);
    if (x < 0.0 && std::floor(y) != y) return kNan;
    const Pair l = logarithm(size);
    const double power = l.high * y;
    if (power == 0.0) return sign;
    if (std::abs(power) > 800.0) return sign * (power > 0.0 ? kInfinity : 0.0);
    return sign * exponential(l * Pair{y});
}

double scaledHypot(double x, double y, double z) noexcept {
    const double most = std::max({std::abs(x), std::abs(y), std::abs(z)});
    if (std::isinf(x) || std::isinf(y) || std::isinf(z)) return kInfinity;
    if (!(most > 0.0) || std::isnan(x) || std::isnan(y) || std::isnan(z)) return std::abs(x + y + z);
    const double to = most < 1.0 ? 0x1p600 : 0x1p-600;
    const double a = x * to, b = y * to, c = z * to;
    return std::sqrt(a * a + b * b + c * c) / to;
}

}  // namespace handpiece::core
