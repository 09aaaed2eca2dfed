// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/portable_math.h"

#include <gtest/gtest.h>
#include <mpfr.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "support/random.h"

namespace handpiece::core::portable_math_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTiny = std::numeric_limits<double>::denorm_min();

struct Exact {
    mpfr_t value;
    Exact() { mpfr_init2(value, 300); }
    ~Exact() { mpfr_clear(value); }
    Exact(const Exact&) = delete;
    Exact& operator=(const Exact&) = delete;
};

/// How far `found` is from `exact`, in units of the last place of the latter. Beyond the largest double: of infinity.
double unitsOff(double found, mpfr_srcptr exact) {
    const double nearest = mpfr_get_d(exact, MPFR_RNDN);
    if (std::isinf(nearest) || std::isnan(nearest) || std::isinf(found) || std::isnan(found))
        return found == nearest || (std::isnan(found) && std::isnan(nearest)) ? 0.0 : kInfinity;
    const int exponent = mpfr_zero_p(exact) ? -1074 : static_cast<int>(mpfr_get_exp(exact)) - 53;
    Exact off;
    mpfr_sub_d(off.value, exact, found, MPFR_RNDN);
    mpfr_mul_2si(off.value, off.value, -std::max(exponent, -1074), MPFR_RNDN);
    return std::abs(mpfr_get_d(off.value, MPFR_RNDN));
}

/// The worst of many arguments, `draw`n at random; told when the test fails, and held to `bound`.
template <typename Own, typename Reference>
void holdTo(double bound, int count, const std::function<double(std::mt19937_64&)>& draw, Own own,
            Reference reference) {
    std::mt19937_64 generator(test::seed());
    Exact exact;
    double worst = 0.0, where = 0.0;
    for (int i = 0; i < count; ++i) {
        const double x = draw(generator);
        mpfr_set_d(exact.value, x, MPFR_RNDN);
        reference(exact.value, exact.value);
        if (const double off = unitsOff(own(x), exact.value); off > worst) worst = off, where = x;
    }
    std::printf("worst error %.4f units at %a\n", worst, where);
    EXPECT_LE(worst, bound) << "at " << where;
}
template <typename Own, typename Reference>
void holdTwoTo(double bound, int count, const std::function<std::pair<double, double>(std::mt19937_64&)>& draw, Own own,
               Reference reference) {
    std::mt19937_64 generator(test::seed());
    Exact a, b, exact;
    double worst = 0.0;
    std::pair<double, double> where;
    for (int i = 0; i < count; ++i) {
        const auto [x, y] = draw(generator);
        mpfr_set_d(a.value, x, MPFR_RNDN);
        mpfr_set_d(b.value, y, MPFR_RNDN);
        reference(exact.value, a.value, b.value);
        if (const double off = unitsOff(own(x, y), exact.value); off > worst) worst = off, where = {x, y};
    }
    std::printf("worst error %.4f units at %a %a\n", worst, where.first, where.second);
    EXPECT_LE(worst, bound) << "at " << where.first << " " << where.second;
}

/// Every exponent alike, every sign, subnormals included.
double anyDouble(std::mt19937_64& generator) {
    for (;;)
        if (const double x = std::bit_cast<double>(generator()); std::isfinite(x)) return x;
}
double withExponent(std::mt19937_64& generator, int low, int high) {
    const double x =
        std::ldexp(test::uniform(generator, 1.0, 2.0), std::uniform_int_distribution<int>(low, high)(generator));
    return generator() % 2 == 0 ? x : -x;
}
/// Some places from a multiple of a quarter of a turn, up to the largest.
double nearQuarter(std::mt19937_64& generator) {
    Exact x;
    mpfr_const_pi(x.value, MPFR_RNDN);
    mpfr_div_2ui(x.value, x.value, 1, MPFR_RNDN);
    mpfr_mul_d(x.value, x.value,
               std::floor(std::ldexp(test::uniform(generator, 1.0, 2.0),
                                     std::uniform_int_distribution<int>(0, 52)(generator))),
               MPFR_RNDN);
    double at = mpfr_get_d(x.value, MPFR_RNDN);
    for (std::uint64_t step = generator() % 4; step > 0; --step)
        at = std::nextafter(at, generator() % 2 == 0 ? 0.0 : kInfinity);
    return at;
}
double angle(std::mt19937_64& generator) {
    switch (generator() % 4) {
        case 0:
            return anyDouble(generator);
        case 1:
            return nearQuarter(generator);
        case 2:
            return test::uniform(generator, -10.0, 10.0);
        default:
            return withExponent(generator, -30, 70);
    }
}
const auto rounded = [](auto function) {
    return [function](mpfr_ptr out, mpfr_srcptr in) { function(out, in, MPFR_RNDN); };
};
constexpr int kCount = 40000;

TEST(PortableMath, anglesOfEverySize) {
    // 6381956970095103 * 2^797 is the double nearest to a multiple of pi / 2.
    EXPECT_EQ(cos(std::ldexp(6381956970095103.0, 797)), -4.6871659242546277e-19);
    holdTo(
        0.8, kCount, angle, [](double x) { return sin(x); }, rounded(mpfr_sin));
    holdTo(
        0.8, kCount, angle, [](double x) { return cos(x); }, rounded(mpfr_cos));
    holdTo(
        1.1, kCount, angle, [](double x) { return tan(x); }, rounded(mpfr_tan));
}

TEST(PortableMath, arcs) {
    const auto cosine = [](std::mt19937_64& generator) {
        switch (generator() % 3) {
            case 0:
                return test::uniform(generator, -1.0, 1.0);
            case 1:
                return std::copysign(1.0 - std::abs(withExponent(generator, -53, -2)),
                                     test::uniform(generator, -1.0, 1.0));
            default:
                return withExponent(generator, -1074, -1);
        }
    };
    holdTo(
        0.51, kCount, cosine, [](double x) { return acos(x); }, rounded(mpfr_acos));
    const auto slope = [](std::mt19937_64& generator) {
        return generator() % 2 == 0 ? anyDouble(generator) : withExponent(generator, -10, 10);
    };
    holdTo(
        0.51, kCount, slope, [](double x) { return atan(x); }, rounded(mpfr_atan));
    const auto place = [](std::mt19937_64& generator) -> std::pair<double, double> {
        if (generator() % 2 == 0) return {anyDouble(generator), anyDouble(generator)};
        const double x = anyDouble(generator);
        return {x * test::uniform(generator, -2.0, 2.0), x * std::ldexp(1.0, static_cast<int>(generator() % 80) - 40)};
    };
    holdTwoTo(
        0.51, kCount,
        [&](std::mt19937_64& generator) {
            for (;;)
                if (const auto at = place(generator); std::isfinite(at.first) && std::isfinite(at.second)) return at;
        },
        [](double y, double x) { return atan2(y, x); },
        [](mpfr_ptr out, mpfr_srcptr y, mpfr_srcptr x) { mpfr_atan2(out, y, x, MPFR_RNDN); });
}

TEST(PortableMath, exponentials) {
    const auto power = [](std::mt19937_64& generator) {
        return generator() % 2 == 0 ? test::uniform(generator, -708.0, 710.0) : withExponent(generator, -60, 8);
    };
    holdTo(
        0.55, kCount, power, [](double x) { return exp(x); }, rounded(mpfr_exp));
    const auto tiny = [](std::mt19937_64& generator) { return test::uniform(generator, -746.0, -708.0); };
    holdTo(
        1.0, kCount / 10, tiny, [](double x) { return exp(x); }, rounded(mpfr_exp));
    const auto positive = [](std::mt19937_64& generator) {
        if (generator() % 2 == 0) return std::abs(anyDouble(generator));
        return 1.0 + withExponent(generator, -52, -1);
    };
    holdTo(
        0.51, kCount, positive, [](double x) { return log(x); }, rounded(mpfr_log));
    const auto base = [](std::mt19937_64& generator) -> std::pair<double, double> {
        const double x = generator() % 2 == 0 ? std::abs(anyDouble(generator)) : 1.0 + withExponent(generator, -52, -1);
        return {x, test::uniform(generator, -708.0, 709.0) / std::log(x == 1.0 ? 2.0 : x)};
    };
    const auto raise = [](mpfr_ptr out, mpfr_srcptr x, mpfr_srcptr y) { mpfr_pow(out, x, y, MPFR_RNDN); };
    holdTwoTo(
        0.65, kCount, base, [](double x, double y) { return pow(x, y); }, raise);
    const auto plain = [](std::mt19937_64& generator) -> std::pair<double, double> {
        return {test::uniform(generator, 0.0, 100.0), std::floor(test::uniform(generator, -12.0, 13.0)) / 2.0};
    };
    holdTwoTo(
        0.65, kCount, plain, [](double x, double y) { return pow(x, y); }, raise);
}

TEST(PortableMath, lengths) {
    const auto sides = [](std::mt19937_64& generator) -> std::pair<double, double> {
        const double x = std::ldexp(anyDouble(generator), -2);
        return {x, std::ldexp(x, static_cast<int>(generator() % 60) - 30) * test::uniform(generator, 0.0, 1.0)};
    };
    holdTwoTo(
        1.5, kCount,
        [&](std::mt19937_64& generator) {
            for (;;)
                if (const auto at = sides(generator); std::isfinite(at.second)) return at;
        },
        [](double x, double y) { return hypot(x, y); },
        [](mpfr_ptr out, mpfr_srcptr x, mpfr_srcptr y) { mpfr_hypot(out, x, y, MPFR_RNDN); });
    std::mt19937_64 generator(test::seed());
    Exact x, y, z;
    double worst = 0.0;
    for (int i = 0; i < kCount; ++i) {
        std::array<double, 3> at{sides(generator).first, 0.0, 0.0};
        for (std::size_t k : {1, 2})
            at[k] = std::ldexp(at[0], static_cast<int>(generator() % 60) - 30) * test::uniform(generator, 0.0, 1.0);
        if (!std::isfinite(at[1]) || !std::isfinite(at[2])) continue;
        std::shuffle(at.begin(), at.end(), generator);
        mpfr_set_d(x.value, at[0], MPFR_RNDN);
        mpfr_set_d(y.value, at[1], MPFR_RNDN);
        mpfr_set_d(z.value, at[2], MPFR_RNDN);
        mpfr_hypot(x.value, x.value, y.value, MPFR_RNDN);
        mpfr_hypot(x.value, x.value, z.value, MPFR_RNDN);
        const double off = unitsOff(hypot(at[0], at[1], at[2]), x.value);
        worst = std::max(worst, off);
        ASSERT_LE(off, 2.0) << at[0] << " " << at[1] << " " << at[2];
    }
    std::printf("worst error %.4f units\n", worst);
    EXPECT_EQ(hypot(2.0, 3.0, 6.0), 7.0);
    EXPECT_EQ(hypot(0x2p1000, 0x3p1000, 0x6p1000), 0x7p1000);
    EXPECT_EQ(hypot(-0x1p-1070, 0.0, 0.0), 0x1p-1070);
}

/// Of numbers that are none, of both zeros, of both ends: as the C library, whose special values the standard names.
TEST(PortableMath, specialValuesAreThoseOfC) {
    std::vector<double> values;
    for (const double x : {0.0, kTiny, 0x1p-1022, 1e-300, 0.25, 0.5, 1.0, std::nextafter(1.0, 2.0), 1.5, 2.0, 3.0, 4.5,
                           700.0, 1000.0, 0x1p52, 0x1p53 + 2.0, 1e300, std::numeric_limits<double>::max(), kInfinity})
        values.insert(values.end(), {x, -x});
    values.push_back(kNan);
    const auto same = [](double own, double libc) {
        if (std::isnan(own) || std::isnan(libc)) return std::isnan(own) && std::isnan(libc);
        return own == libc ? std::signbit(own) == std::signbit(libc)
                           : std::isfinite(own) && std::abs(own - libc) <= std::max(kTiny, 4e-16 * std::abs(libc));
    };
    for (const double x : values) {
        EXPECT_TRUE(same(sin(x), std::sin(x))) << x;
        EXPECT_TRUE(same(cos(x), std::cos(x))) << x;
        EXPECT_TRUE(same(tan(x), std::tan(x))) << x;
        EXPECT_TRUE(same(acos(x), std::acos(x))) << x;
        EXPECT_TRUE(same(atan(x), std::atan(x))) << x;
        EXPECT_TRUE(same(exp(x), std::exp(x))) << x;
        EXPECT_TRUE(same(log(x), std::log(x))) << x;
        for (const double y : values) {
            EXPECT_TRUE(same(atan2(x, y), std::atan2(x, y))) << x << " " << y;
            EXPECT_TRUE(same(pow(x, y), std::pow(x, y))) << x << " " << y;
            EXPECT_TRUE(same(hypot(x, y), std::hypot(x, y))) << x << " " << y << " " << hypot(x, y);
        }
    }
}

}  // namespace
}  // namespace handpiece::core::portable_math_test
