// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/stability/limits.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "handpiece/base/core/error.h"
#include "studies/passivity.h"

namespace handpiece::stability::limits_test {
namespace {

TEST(Limits, fallWithDelayAndRiseWithFriction) {
    DeviceFigures quick, slow, sticky;
    quick.delayS = 0.0;
    slow.delayS = 0.003;
    sticky.delayS = 0.003;
    sticky.frictionN = 0.26;
    const StableLimits a = limitsFor(quick), b = limitsFor(slow), c = limitsFor(sticky);
    std::printf("  no delay %.2f N/mm, 3 ms %.2f, 3 ms and 0.26 N of friction %.2f\n", a.stiffnessNPerMm,
                b.stiffnessNPerMm, c.stiffnessNPerMm);
    EXPECT_GT(a.stiffnessNPerMm, 2.0 * b.stiffnessNPerMm);
    EXPECT_GT(c.stiffnessNPerMm, 1.5 * b.stiffnessNPerMm);
    EXPECT_GT(b.stiffnessNPerMm, 0.2);
    EXPECT_DOUBLE_EQ(b.stiffnessNPerMm, 0.8 * b.foundNPerMm);
    EXPECT_LE(b.withoutDampingNPerMm, b.stiffnessNPerMm);
}

TEST(Limits, whatTheyAllowIsPassiveInTheFullLoopAndFarBeyondIsNot) {
    DeviceFigures figures;
    figures.delayS = 0.003;
    const StableLimits limits = limitsFor(figures);
    studies::PassivitySweep sweep;
    sweep.frictionN = {figures.frictionN};
    sweep.delayS = {figures.delayS};
    sweep.rateHz = {figures.rateHz};
    sweep.tissues = {cases::Tissue::enamel};
    sweep.capability.maxStiffnessNPerMm = limits.stiffnessNPerMm;
    sweep.capability.maxDampingNSPerMm = 1.0;
    sweep.parameters.dampingMultiplier =
        limits.dampingNSPerMm /
        sweep.parameters.tissues[static_cast<std::size_t>(cases::Tissue::enamel)].dampingNSPerMm;
    for (const studies::PassivityRow& row : studies::passivityMap(sweep)) {
        EXPECT_TRUE(row.holds) << row.hand << ": " << row.marginNmm;
        EXPECT_FALSE(row.growing) << row.hand;
    }
    sweep.capability.maxStiffnessNPerMm = 4.0 * limits.foundNPerMm;
    int bad = 0;
    for (const studies::PassivityRow& row : studies::passivityMap(sweep))
        bad += !row.holds || row.growing || row.rippleN > row.rippleBoundN;
    EXPECT_GT(bad, 0);
}

TEST(Limits, refuseFiguresThatAreNone) {
    DeviceFigures figures;
    figures.massKg = 0.0;
    EXPECT_THROW((void)limitsFor(figures), core::Error);
    figures = {};
    figures.rateHz = 1e6;
    EXPECT_THROW((void)limitsFor(figures), core::Error);
}

}  // namespace
}  // namespace handpiece::stability::limits_test
