// SPDX-License-Identifier: Apache-2.0
// Published data to four digits, definitions written out again, and what must be undefined.
#include "handpiece/assess/agreement/agreement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::agreement::agreement_test {
namespace {

constexpr double kFour = 0.5e-4;
using Marks = std::vector<std::optional<double>>;

// Shrout and Fleiss 1979, table 2: six targets, four judges.
const std::vector<double> kShroutFleiss = {9, 2, 5, 8, 6, 1, 3, 2, 8, 4, 6, 8, 7, 1, 2, 6, 10, 5, 6, 9, 6, 2, 4, 7};

// Krippendorff 2011: four observers, twelve units; here one row a unit.
Marks krippendorff() {
    constexpr double x = -1;
    const double byRater[4][12] = {{1, 2, 3, 3, 2, 1, 4, 1, 2, x, x, x},
                                   {1, 2, 3, 3, 2, 2, 4, 1, 2, 5, x, 3},
                                   {x, 3, 3, 3, 2, 3, 4, 2, 2, 5, 1, x},
                                   {1, 2, 3, 3, 2, 4, 4, 1, 2, 5, 1, x}};
    Marks marks;
    for (int item = 0; item < 12; ++item)
        for (const auto& rater : byRater)
            marks.push_back(rater[item] < 0 ? std::optional<double>() : rater[item]);
    return marks;
}

TEST(Icc, ShroutAndFleiss) {
    const Icc r = icc(kShroutFleiss, 4);
    EXPECT_NEAR(r.betweenItems, 11.24167, 1e-5);
    EXPECT_NEAR(r.withinItems, 6.26389, 1e-5);
    EXPECT_NEAR(r.betweenRaters, 32.48611, 1e-5);
    EXPECT_NEAR(r.error, 1.01944, 1e-5);
    const double expected[] = {.16574, .28976, .71484, .44280, .62005, .90932};
    const Estimate* got[] = {&r.one1, &r.two1, &r.three1, &r.oneK, &r.twoK, &r.threeK};
    for (int i = 0; i < 6; ++i)
        EXPECT_NEAR(*got[i]->value, expected[i], 1e-5) << i;
    // Intervals as printed by the R package psych's ICC() for the same data [R], to the digits it prints.
    const double limits[][3] = {{-.133, .72, 2}, {.019, .76, 2}, {.342, .95, 2},
                                {-.884, .91, 2}, {.071, .93, 2}, {.676, .99, 2}};
    for (int i = 0; i < 6; ++i) {
        EXPECT_NEAR(got[i]->interval->low, limits[i][0], 0.6e-3) << i;
        EXPECT_NEAR(got[i]->interval->high, limits[i][1], 0.6e-2) << i;
    }
}

TEST(Icc, WithoutVarianceIsUndefined) {
    const std::vector<double> same(12, 3.0);
    for (const Estimate& e : {icc(same, 3).one1, icc(same, 3).two1, icc(same, 3).threeK}) {
        EXPECT_FALSE(e.value);
        EXPECT_FALSE(e.reason.empty());
    }
    // All items alike, raters apart: nothing to tell items by.
    const std::vector<double> levels = {1, 2, 3, 1, 2, 3, 1, 2, 3};
    EXPECT_FALSE(icc(levels, 3).three1.value);
    EXPECT_FALSE(icc(levels, 3).oneK.value);
    EXPECT_FALSE(icc(std::vector<double>{1, 2}, 2).two1.value) << "one item";
    EXPECT_FALSE(icc(std::vector<double>{1, 2}, 1).two1.value) << "one rater";
    EXPECT_NE(test::errorOf([] { (void)icc(std::vector<double>{1, 2, 3}, 2); }), "");
    // To the bit alike: that is 1, and has no limits by F.
    const Icc agreed = icc(std::vector<double>{1, 1, 4, 4, 2, 2}, 2);
    EXPECT_DOUBLE_EQ(*agreed.two1.value, 1.0);
    EXPECT_FALSE(agreed.two1.interval);
}

TEST(Icc, ALevelShiftCostsAgreementAndNotConsistency) {
    std::mt19937_64 random(test::seed());
    for (int trial = 0; trial < 200; ++trial) {
        std::vector<double> marks;
        for (int i = 0; i < 12; ++i)
            for (int j = 0; j < 3; ++j)
                marks.push_back(10 * test::uniform(random, 0, 1) + i);
        const Icc before = icc(marks, 3);
        for (std::size_t i = 0; i < marks.size(); i += 3)
            marks[i] += 5;
        const Icc after = icc(marks, 3);
        EXPECT_NEAR(*after.three1.value, *before.three1.value, 1e-9);
        for (const Estimate* e : {&after.one1, &after.two1, &after.three1, &after.oneK, &after.twoK, &after.threeK}) {
            ASSERT_TRUE(e->interval);
            EXPECT_LE(e->interval->low, *e->value);
            EXPECT_GE(e->interval->high, *e->value);
        }
    }
}

TEST(Kappa, ReferenceData) {
    // The SAS documentation's example.
    const std::vector<std::size_t> sas = {0, 4, 1, 0, 8, 0, 0, 1, 5};
    const Estimate plain = kappa(sas, 3, Weights::none);
    EXPECT_NEAR(*plain.value, .4842, kFour);
    EXPECT_NEAR(*plain.standardError, .1380, kFour);
    EXPECT_NEAR(plain.interval->low, .2137, kFour);
    EXPECT_NEAR(plain.interval->high, .7547, kFour);
    const Estimate linear = kappa(sas, 3, Weights::linear);
    EXPECT_NEAR(*linear.value, .4701, kFour);
    EXPECT_NEAR(linear.interval->low, .1845, kFour);
    EXPECT_NEAR(linear.interval->high, .7558, kFour);
    EXPECT_NEAR(*kappa(sas, 3, Weights::quadratic).value, .45016, 1e-5);
    EXPECT_NEAR(*kappa(std::vector<std::size_t>{20, 5, 10, 15}, 2, Weights::none).value, .4, 1e-12);
}

TEST(Kappa, AnEmptyCategoryIsAPlaceOnTheScale) {
    const std::vector<std::size_t> three = {5, 2, 0, 1, 6, 1, 0, 1, 4};
    // The same marks on a scale with a step between the first and the second that nobody used.
    std::vector<std::size_t> four(16, 0);
    const std::size_t to[] = {0, 2, 3};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            four[to[i] * 4 + to[j]] = three[i * 3 + j];
    EXPECT_NEAR(*kappa(three, 3, Weights::none).value, *kappa(four, 4, Weights::none).value, 1e-12);
    EXPECT_GT(std::abs(*kappa(three, 3, Weights::linear).value - *kappa(four, 4, Weights::linear).value), 0.01);
    // Two categories: all weights say the same.
    const std::vector<std::size_t> two = {7, 2, 3, 9};
    EXPECT_NEAR(*kappa(two, 2, Weights::none).value, *kappa(two, 2, Weights::quadratic).value, 1e-12);
}

TEST(Kappa, WithoutVarianceIsUndefined) {
    for (const Weights weights : {Weights::none, Weights::linear, Weights::quadratic}) {
        const Estimate all = kappa(std::vector<std::size_t>{9, 0, 0, 0}, 2, weights);
        EXPECT_FALSE(all.value);
        EXPECT_NE(all.reason.find("variance"), std::string::npos);
        EXPECT_FALSE(kappa(std::vector<std::size_t>{0, 9, 0, 0}, 2, weights).value);
        EXPECT_FALSE(kappa(std::vector<std::size_t>{0, 0, 0, 0}, 2, weights).value);
        EXPECT_FALSE(kappa(std::vector<std::size_t>{9}, 1, weights).value);
    }
}

TEST(Kappa, StandardErrorIsThatOfDrawingAgain) {
    // Against the spread of kappa over tables drawn from the shares of one.
    const std::vector<std::size_t> counts = {40, 12, 3, 9, 55, 14, 2, 11, 54};
    for (const Weights weights : {Weights::none, Weights::linear, Weights::quadratic}) {
        const Estimate e = kappa(counts, 3, weights);
        std::mt19937_64 random(7);
        std::discrete_distribution<std::size_t> cell(counts.begin(), counts.end());
        double sum = 0, squares = 0;
        constexpr int kTrials = 4000;
        for (int t = 0; t < kTrials; ++t) {
            std::vector<std::size_t> again(9, 0);
            for (int i = 0; i < 200; ++i)
                ++again[cell(random)];
            const double k = *kappa(again, 3, weights).value;
            sum += k, squares += k * k;
        }
        const double mean = sum / kTrials, sd = std::sqrt(squares / kTrials - mean * mean);
        EXPECT_NEAR(sd / *e.standardError, 1.0, 0.06);
    }
}

TEST(Alpha, ReferenceData) {
    const Marks marks = krippendorff();
    const std::pair<Level, double> expected[] = {
        {Level::nominal, .743}, {Level::ordinal, .815}, {Level::interval, .849}, {Level::ratio, .797}};
    for (const auto& [level, value] : expected)
        EXPECT_NEAR(*krippendorffAlpha(marks, 4, level).value, value, 0.5e-3);
}

/// By definition, over all pairs of marks, not over coincidences: observed is the mean disagreement within items (each
/// by its marks), expected that of any two marks.
double alphaByPairs(const Marks& marks, std::size_t raters, const std::function<double(double, double)>& apart) {
    std::vector<double> all;
    double observed = 0;
    for (std::size_t i = 0; i < marks.size(); i += raters) {
        std::vector<double> own;
        for (std::size_t r = 0; r < raters; ++r)
            if (marks[i + r]) own.push_back(*marks[i + r]);
        if (own.size() < 2) continue;
        for (std::size_t a = 0; a < own.size(); ++a)
            for (std::size_t b = 0; b < own.size(); ++b)
                if (a != b) observed += apart(own[a], own[b]) / static_cast<double>(own.size() - 1);
        all.insert(all.end(), own.begin(), own.end());
    }
    double expected = 0;
    for (std::size_t a = 0; a < all.size(); ++a)
        for (std::size_t b = 0; b < all.size(); ++b)
            if (a != b) expected += apart(all[a], all[b]);
    const double n = static_cast<double>(all.size());
    return 1 - (observed / n) / (expected / (n * (n - 1)));
}

TEST(Alpha, AsByPairsOfRandomMarks) {
    std::mt19937_64 random(test::seed());
    for (int trial = 0; trial < 100; ++trial) {
        Marks marks(60);
        for (auto& m : marks)
            if (random() % 4 != 0) m = static_cast<double>(random() % 6);
        EXPECT_NEAR(*krippendorffAlpha(marks, 4, Level::nominal).value,
                    alphaByPairs(marks, 4, [](double a, double b) { return a == b ? 0.0 : 1.0; }), 1e-12);
        EXPECT_NEAR(*krippendorffAlpha(marks, 4, Level::interval).value,
                    alphaByPairs(marks, 4, [](double a, double b) { return (a - b) * (a - b); }), 1e-12);
        EXPECT_NEAR(
            *krippendorffAlpha(marks, 4, Level::ratio).value,
            alphaByPairs(marks, 4,
                         [](double a, double b) { return a + b > 0 ? (a - b) * (a - b) / ((a + b) * (a + b)) : 0.0; }),
            1e-12);
    }
}

TEST(Alpha, WithoutVarianceIsUndefined) {
    EXPECT_FALSE(krippendorffAlpha(Marks(8, 2.0), 2, Level::nominal).value);
    EXPECT_FALSE(krippendorffAlpha(Marks(8), 2, Level::nominal).value);
    EXPECT_FALSE(krippendorffAlpha(Marks{1.0, {}, {}, 2.0}, 2, Level::interval).value)
        << "nobody marked what another did";
    EXPECT_FALSE(krippendorffAlpha(Marks{-1.0, 1.0}, 2, Level::ratio).value);
    EXPECT_DOUBLE_EQ(*krippendorffAlpha(Marks{1.0, 1.0, 2.0, 2.0}, 2, Level::ordinal).value, 1.0);
}

TEST(BlandAltman, ReferenceData) {
    const std::vector<double> wright = {494, 395, 516, 434, 476, 557, 413, 442, 650,
                                        433, 417, 656, 267, 478, 178, 423, 427};
    const std::vector<double> mini = {512, 430, 520, 428, 500, 600, 364, 380, 658,
                                      445, 432, 626, 260, 477, 259, 350, 451};
    const BlandAltman b = blandAltman(wright, mini);
    EXPECT_NEAR(*b.bias, -2.118, 0.5e-3);
    EXPECT_NEAR(*b.spread, 38.765, 0.5e-3);
    // The table has them by 2 sd, as the paper of 1986 does.
    EXPECT_NEAR(*b.bias - 2 * *b.spread, -79.65, 0.5e-2);
    EXPECT_NEAR(*b.bias + 2 * *b.spread, 75.41, 0.5e-2);
    EXPECT_NEAR(*b.low, -2.1176 - 1.96 * 38.7651, 1e-3);
    EXPECT_NEAR(*b.high, -2.1176 + 1.96 * 38.7651, 1e-3);
    // The paper: bias -22.0 to 17.8 with t = 2.12 (there of 9.40 l/min standard error).
    EXPECT_NEAR(b.biasInterval->low, -22.0, 0.1);
    EXPECT_NEAR(b.biasInterval->high, 17.8, 0.1);
    EXPECT_LT(b.lowInterval->high, b.biasInterval->low);
    EXPECT_FALSE(blandAltman(std::vector<double>{1}, std::vector<double>{2}).bias);
    EXPECT_EQ(*blandAltman(std::vector<double>{1, 2, 3}, std::vector<double>{2, 3, 4}).spread, 0.0);
}

TEST(Distributions, TablesAndClosedForms) {
    // Printed tables.
    EXPECT_NEAR(studentAt(.975, 1), 12.7062, kFour);
    EXPECT_NEAR(studentAt(.975, 16), 2.1199, kFour);
    EXPECT_NEAR(studentAt(.025, 16), -2.1199, kFour);
    EXPECT_NEAR(fisherAt(.95, 5, 10), 3.3258, kFour);
    EXPECT_NEAR(fisherAt(.975, 5, 18), 3.3820, kFour);
    EXPECT_NEAR(fisherAt(.975, 18, 5), 6.3619, 2 * kFour);
    // Closed forms: t of one and two degrees, F of two in the numerator.
    for (const double x : {-30.0, -2.0, -0.1, 0.0, 0.3, 1.0, 7.0, 1e4}) {
        EXPECT_NEAR(studentBelow(x, 1), .5 + std::atan(x) / M_PI, 1e-12);
        EXPECT_NEAR(studentBelow(x, 2), .5 + x / (2 * std::sqrt(2 + x * x)), 1e-12);
        EXPECT_NEAR(fisherBelow(x, 2, 7), x > 0 ? 1 - std::pow(1 + 2 * x / 7, -3.5) : 0.0, 1e-12);
    }
    // The square of t is F, and what a share is at has that share.
    for (const double df : {1.0, 3.0, 5.7, 40.0, 900.0})
        for (const double share : {.6, .9, .975, .999}) {
            const double t = studentAt(share, df);
            EXPECT_NEAR(fisherBelow(t * t, 1, df), 2 * share - 1, 1e-11);
            EXPECT_NEAR(fisherBelow(fisherAt(share, df, 11.3), df, 11.3), share, 1e-12);
        }
}

TEST(Bootstrap, ComesFromItsSeedAtAnyNumberOfThreads) {
    const Marks marks = krippendorff();
    const auto statistic = [&](std::span<const std::size_t> places) {
        Marks again;
        for (const std::size_t item : places)
            again.insert(again.end(), marks.begin() + static_cast<std::ptrdiff_t>(4 * item),
                         marks.begin() + static_cast<std::ptrdiff_t>(4 * item + 4));
        return krippendorffAlpha(again, 4, Level::interval).value;
    };
    const std::uint64_t seed = seedOf(marks, 4);
    core::setThreadCount(1);
    const Bootstrap one = bootstrap(12, seed, 2000, statistic);
    core::setThreadCount(2);
    const Bootstrap two = bootstrap(12, seed, 2000, statistic);
    core::setThreadCount(0);
    ASSERT_TRUE(one.interval);
    EXPECT_EQ(one.interval->low, two.interval->low);
    EXPECT_EQ(one.interval->high, two.interval->high);
    EXPECT_LT(one.interval->low, .849);
    EXPECT_GT(one.interval->high, .849);
    Marks other = marks;
    other[0] = 2.0;
    EXPECT_NE(seedOf(other, 4), seed);
    EXPECT_EQ(seedOf(Marks{-0.0}, 1), seedOf(Marks{0.0}, 1));
    EXPECT_FALSE(bootstrap(12, seed, 100, [](auto) { return std::optional<double>(); }).interval);
    EXPECT_FALSE(bootstrap(1, seed, 100, [](auto) { return std::optional<double>(1.0); }).interval);
}

TEST(Bootstrap, CoversAMeanAsOftenAsItSays) {
    // 40 even numbers of mean 1/2 drawn anew: the interval of the mean has it in about 95 % of cases.
    int covered = 0;
    constexpr int kTrials = 400;
    std::mt19937_64 random(test::seed());
    for (int t = 0; t < kTrials; ++t) {
        std::vector<double> values(40);
        for (double& v : values)
            v = test::uniform(random, 0, 1);
        const Bootstrap b = bootstrap(values.size(), random(), 400, [&](std::span<const std::size_t> places) {
            double sum = 0;
            for (const std::size_t p : places)
                sum += values[p];
            return std::optional<double>(sum / static_cast<double>(places.size()));
        });
        covered += b.interval->low <= .5 && b.interval->high >= .5 ? 1 : 0;
    }
    EXPECT_GT(covered, .88 * kTrials);
    EXPECT_LT(covered, .99 * kTrials);
}

}  // namespace
}  // namespace handpiece::agreement::agreement_test
