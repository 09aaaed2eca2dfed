// SPDX-License-Identifier: Apache-2.0
// Standards against what numpy computes of the same numbers (standard_check.py), and against closed forms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "handpiece/assess/standard/standard.h"
#include "support/error_of.h"

namespace handpiece::standard::standard_test {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

TEST(AngoffTest, IsTheMeanOfTheJudgesWeightedPercents) {
    const std::vector<double> weights{6, 4};
    const std::vector<JudgeEstimates> estimates{
        {"a", {50.0, 80.0}}, {"b", {60.0, 40.0}}, {"c", {70.0, 90.0}}, {"d", {10.0, {}}}};
    const Angoff result = angoff(weights, estimates);
    // By hand: 62, 52, 78; mean 64, deviations -2, -12, 14: spread sqrt(344 / 2).
    ASSERT_THAT(result.judges, SizeIs(3));
    EXPECT_NEAR(result.judges[0].cutPercent, 62.0, 1e-12);
    EXPECT_NEAR(result.judges[1].cutPercent, 52.0, 1e-12);
    EXPECT_NEAR(*result.cutPercent, 64.0, 1e-12);
    EXPECT_NEAR(*result.spreadPercent, std::sqrt(172.0), 1e-12);
    EXPECT_NEAR(*result.standardErrorPercent, std::sqrt(172.0 / 3.0), 1e-12);
    // Student's t of two degrees has a closed form: a sqrt(2 / (1 - a^2)), a = 2 0.975 - 1.
    const double t = 0.95 * std::sqrt(2.0 / (1.0 - 0.95 * 0.95));
    EXPECT_NEAR(result.interval->high - *result.cutPercent, t * std::sqrt(172.0 / 3.0), 1e-9);
    EXPECT_THAT(result.unfinished, ElementsAre("d"));
    EXPECT_NEAR(*result.means[0], 47.5, 1e-12) << "of all who said one";
    EXPECT_NEAR(*result.means[1], 70.0, 1e-12);
}

TEST(AngoffTest, SaysNothingOfNobodyAndRefusesNonsense) {
    const std::vector<double> weights{1};
    EXPECT_FALSE(angoff(weights, {}).cutPercent);
    const std::vector<JudgeEstimates> one{{"a", {30.0}}};
    EXPECT_EQ(*angoff(weights, one).cutPercent, 30.0);
    EXPECT_FALSE(angoff(weights, one).spreadPercent) << "one judge has no spread";
    for (const double bad : {-0.1, 100.1, std::nan("")}) {
        const std::vector<JudgeEstimates> wrong{{"a", {bad}}};
        EXPECT_TRUE(test::errorFrom([&] { (void)angoff(weights, wrong); })) << bad;
    }
    const std::vector<JudgeEstimates> longer{{"a", {1.0, 2.0}}};
    EXPECT_TRUE(test::errorFrom([&] { (void)angoff(weights, longer); }));
    EXPECT_TRUE(test::errorFrom([&] { (void)angoff(std::vector<double>{0.0}, one); }));
    EXPECT_TRUE(test::errorFrom([&] { (void)angoff({}, {}); }));
}

const std::vector<RatedWork> kWorks{{1, 31}, {2, 48}, {2, 55}, {3, 61}, {3, 66}, {3, 58},
                                    {4, 74}, {4, 81}, {5, 88}, {5, 93}, {1, 40}, {2, 44.5}};

TEST(BorderlineTest, IsTheLeastSquaresLineAtTheBorderlineRating) {
    const Borderline result = borderlineRegression(kWorks, 2.0, 7, 20'000);
    // numpy's least squares of the same numbers: standard_check.py prints them.
    EXPECT_NEAR(result.slopePercent, 13.822709163346612, 1e-9);
    EXPECT_NEAR(result.interceptPercent, 21.308764940239048, 1e-9);
    EXPECT_NEAR(*result.cutPercent, 48.954183266932276, 1e-9);
    EXPECT_NEAR(result.rSquared, 0.9584916371567975, 1e-12);
    EXPECT_NEAR(result.residualPercent, 4.160188855658002, 1e-9);
    EXPECT_NEAR(*result.standardErrorPercent, 1.4620325190231456, 1e-9);
    // The middle 95 % of 200,000 cuts drawn by numpy, with another generator.
    ASSERT_TRUE(result.bootstrap.interval);
    EXPECT_NEAR(result.bootstrap.interval->low, 45.83333333333333, 0.25);
    EXPECT_NEAR(result.bootstrap.interval->high, 52.0, 0.25);
    const Borderline again = borderlineRegression(kWorks, 2.0, 7, 20'000);
    EXPECT_EQ(again.bootstrap.interval->low, result.bootstrap.interval->low) << "the same seed, the same bits";
    EXPECT_NE(borderlineRegression(kWorks, 2.0, 8, 20'000).bootstrap.interval->low, result.bootstrap.interval->low);
}

TEST(BorderlineTest, IsExactOnALineAndSaysWhyThereIsNone) {
    std::vector<RatedWork> line;
    for (int rating = 1; rating <= 5; ++rating)
        line.push_back({static_cast<double>(rating), 10.0 + 15.0 * rating});
    const Borderline exact = borderlineRegression(line, 2.0, 1);
    EXPECT_NEAR(*exact.cutPercent, 40.0, 1e-10);
    EXPECT_NEAR(exact.rSquared, 1.0, 1e-12);
    EXPECT_NEAR(exact.bootstrap.interval->high - exact.bootstrap.interval->low, 0.0, 1e-9);
    EXPECT_FALSE(borderlineRegression(std::span(line).first(2), 2.0, 1).cutPercent);
    EXPECT_FALSE(borderlineRegression({}, 2.0, 1).cutPercent);
    for (RatedWork& one : line)
        one.percent = 100.0 - one.percent;
    EXPECT_EQ(borderlineRegression(line, 2.0, 1).reason, "better ratings do not go with better scores");
    for (RatedWork& one : line)
        one.rating = 3.0;
    EXPECT_EQ(borderlineRegression(line, 2.0, 1).reason, "all works have the same rating");
}

}  // namespace
}  // namespace handpiece::standard::standard_test
