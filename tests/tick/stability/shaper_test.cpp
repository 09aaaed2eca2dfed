// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/stability/shaper.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>

#include "handpiece/base/core/error.h"
#include "support/random.h"
#include "support/realtime_trap.h"

namespace handpiece::stability::shaper_test {
namespace {

using core::Vec3;

constexpr double kPeriodS = 1e-3;

/// Nothing but what a test switches on.
ShaperSettings plain() {
    ShaperSettings s;
    s.passivityController = false;
    s.thermalBudget = false;
    return s;
}

TEST(Thermal, warmsAsTheExponentialSaysUntilTheKnee) {
    ThermalBudget budget;
    budget.set(3.3, 0.88, 60.0);
    const double aim = (3.3 / 0.88) * (3.3 / 0.88);
    for (int i = 1; i <= 3000; ++i) {
        budget.spend(3.3, kPeriodS);
        ASSERT_NEAR(budget.heat(), aim * (1.0 - std::exp(-i * kPeriodS / 60.0)), 1e-9);
        ASSERT_EQ(budget.scale(), 1.0);
    }
    // 3.3 N until the knee: -tau ln(1 - 0.8 / 14.06) = 3.5 s.
    EXPECT_NEAR(-60.0 * std::log(1.0 - ThermalBudget::kKnee / aim), 3.51, 0.01);
}

TEST(Thermal, holdsTheContinuousForceForEverAndMoreForSeconds) {
    ShaperSettings settings = plain();
    settings.thermalBudget = true;
    Shaper shaper(settings);
    double least = 1.0, lastScale = 1.0, largestStep = 0.0, sent = 0.0;
    for (int i = 0; i < 600 * 100; ++i) {  // ten minutes at 100 Hz
        sent = shaper.shape(Vec3::Zero(), Vec3(0, 0, 3.3), 0.01, i == 0).norm();
        if (i * 0.01 < 3.4) {
            ASSERT_NEAR(sent, 3.3, 1e-12) << i;
        }
        ASSERT_LE(shaper.status().heat, 1.0);
        largestStep = std::max(largestStep, std::abs(shaper.status().thermalScale - lastScale));
        lastScale = shaper.status().thermalScale;
        least = std::min(least, lastScale);
    }
    EXPECT_LT(sent, 0.89);
    EXPECT_GT(sent, 0.75);
    EXPECT_LT(largestStep, 0.01) << "it comes down smoothly";
    // Cooled, it is all there again.
    for (int i = 0; i < 300 * 100; ++i)
        sent = shaper.shape(Vec3::Zero(), Vec3::Zero(), 0.01, false).norm();
    EXPECT_EQ(shaper.shape(Vec3::Zero(), Vec3(0, 0, 3.3), 0.01, false).norm(), 3.3);

    // Just above what can be held for ever, for an hour, and just below.
    Shaper above(settings), below(settings);
    for (int i = 0; i < 3600 * 10; ++i) {
        sent = above.shape(Vec3::Zero(), Vec3(1.0, 0, 0), 0.1, i == 0).norm();
        (void)below.shape(Vec3::Zero(), Vec3(0.7, 0, 0), 0.1, i == 0);
    }
    EXPECT_LT(sent, 0.88);
    EXPECT_EQ(below.status().thermalScale, 1.0f);
}

TEST(Friction, isGivenBackAlongTheMotionAndNotAtRest) {
    ShaperSettings settings = plain();
    settings.frictionCompensation = true;
    settings.frictionN = 0.26;
    settings.encoderStepMm = 0.0;
    Shaper shaper(settings);
    Vec3 force;
    for (int i = 0; i < 200; ++i)
        force = shaper.shape(Vec3(0.1 * i, 0, 0), Vec3::Zero(), kPeriodS, i == 0);  // 100 mm/s
    EXPECT_NEAR(force.x(), 0.6 * 0.26, 0.001);
    EXPECT_EQ(force.y(), 0.0);
    for (int i = 0; i < 200; ++i)
        force = shaper.shape(Vec3(19.9, 0, 0), Vec3::Zero(), kPeriodS, false);
    EXPECT_LT(force.norm(), 1e-6);
    // Within the bound: with the controller and no contact it has no energy to give.
    settings.passivityController = true;
    Shaper bound(settings);
    double work = 0.0;
    for (int i = 0; i < 2000; ++i) {
        work += 0.1 * force.x();
        force = bound.shape(Vec3(0.1 * i, 0, 0), Vec3::Zero(), kPeriodS, i == 0);
    }
    EXPECT_LE(work, 1e-3);
}

TEST(Shaper, scalesAndNeverExceedsTheLargestForce) {
    ShaperSettings settings = plain();
    settings.forceScale = 0.5;
    Shaper half(settings);
    EXPECT_TRUE(half.shape(Vec3::Zero(), Vec3(0, 1, 0), kPeriodS, true).isApprox(Vec3(0, 0.5, 0)));
    settings = ShaperSettings{};
    settings.frictionCompensation = true;
    settings.frictionN = 0.26;
    settings.forceScale = 2.0;
    Shaper all(settings);
    std::mt19937_64 random(test::seed());
    Vec3 x = Vec3::Zero();
    for (int i = 0; i < 20000; ++i) {
        x += test::uniform(random, 0.0, 0.2) * test::randomDirection(random);
        const Vec3 wanted = test::uniform(random, 0.0, 20.0) * test::randomDirection(random);
        const bool fresh = test::uniform(random, 0.0, 1.0) < 0.01;
        const Vec3 sent = all.shape(x, wanted, test::uniform(random, 1e-4, 3e-3), fresh);
        ASSERT_TRUE(sent.allFinite());
        ASSERT_LE(sent.norm(), settings.maxForceN * (1.0 + 1e-12));
    }
}

TEST(Shaper, nonsenseIsNoForceAndLeavesItWell) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    Shaper shaper{ShaperSettings{}};
    (void)shaper.shape(Vec3::Zero(), Vec3::Zero(), kPeriodS, true);
    EXPECT_EQ(shaper.shape(Vec3(nan, 0, 0), Vec3(0, 0, 1), kPeriodS, false).norm(), 0.0);
    EXPECT_EQ(shaper.shape(Vec3::Zero(), Vec3(0, inf, 1), kPeriodS, false).norm(), 0.0);
    for (const double period : {0.0, -1.0, nan, inf, 10.0, 1e-9})
        EXPECT_TRUE(shaper.shape(Vec3::Zero(), Vec3(0, 0, 1), period, false).allFinite()) << period;
    // Pressed into a wall it gives force as ever.
    double z = 0.0;
    Vec3 sent = Vec3::Zero();
    for (int i = 0; i < 200; ++i) {
        z -= 0.01;
        sent = shaper.shape(Vec3(0, 0, z), Vec3(0, 0, -0.5 * z), kPeriodS, i == 0);
    }
    EXPECT_NEAR(sent.z(), 1.0, 1e-9);
    EXPECT_TRUE(std::isfinite(shaper.status().energyNmm));
    EXPECT_TRUE(std::isfinite(shaper.status().heat));
}

TEST(Shaper, keepsTheTicksLaw) {
    if (!test::RealtimeTrap::isActive()) GTEST_SKIP() << "the sanitizers own malloc";
    ShaperSettings settings;
    settings.frictionCompensation = true;
    settings.frictionN = 0.26;
    settings.delayS = PassivityController::kMaxDelayS;
    Shaper shaper(settings);
    const test::RealtimeTrap trap;
    double z = 0.0;
    for (int i = 0; i < 4000; ++i) {
        z = 0.3 * std::sin(0.05 * i);
        (void)shaper.shape(Vec3(0.001 * i, 0, z), Vec3(0, 0, std::max(0.0, -5.0 * z)), 1.25e-4, i % 1000 == 0);
        if (i == 2000) shaper.setSettings(settings);
    }
    EXPECT_EQ(trap.total(), 0u);
    EXPECT_GT(shaper.status().engaged, 0u);
}

TEST(Shaper, costsLittle) {
    for (const auto& [delay, period] : {std::pair{0.002, 1e-3}, std::pair{0.003, 1.25e-4}}) {
        ShaperSettings settings;
        settings.delayS = delay;
        Shaper shaper(settings);
        for (const bool hard : {false, true}) {
            constexpr int kTicks = 20000;
            const auto start = std::chrono::steady_clock::now();
            for (int i = 0; i < kTicks; ++i) {
                const double z = hard ? 0.3 * std::sin(400.0 * period * i) : -0.5 - 0.1 * std::sin(20.0 * period * i);
                (void)shaper.shape(Vec3(0, 0, z), Vec3(0, 0, std::max(0.0, -(hard ? 5.0 : 0.5) * z)), period, i == 0);
            }
            const double ns =
                std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count();
            std::printf("  %.0f Hz, delay up to %.0f ms, %s: %.0f ns\n", 1.0 / period, 1e3 * delay,
                        hard ? "limiting" : "at rest", ns / kTicks);
            EXPECT_LT(ns / kTicks, 50000.0);
        }
    }
}

TEST(Shaper, refusesSettingsThatAreNone) {
    EXPECT_NO_THROW(validate(ShaperSettings{}));
    const auto refused = [](auto change) {
        ShaperSettings s;
        change(s);
        EXPECT_THROW(validate(s), core::Error);
    };
    refused([](ShaperSettings& s) { s.forceScale = 2.1; });
    refused([](ShaperSettings& s) { s.maxForceN = 0.0; });
    refused([](ShaperSettings& s) { s.frictionShare = 1.0; });
    refused([](ShaperSettings& s) { s.delayS = 0.011; });
    refused([](ShaperSettings& s) { s.massKg = std::numeric_limits<double>::quiet_NaN(); });
    refused([](ShaperSettings& s) { s.thermalTauS = 0.0; });
}

}  // namespace
}  // namespace handpiece::stability::shaper_test
