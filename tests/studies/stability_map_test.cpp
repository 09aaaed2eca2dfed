// SPDX-License-Identifier: Apache-2.0
#include "studies/stability_map.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"

namespace handpiece::studies::stability_map_test {
namespace {

TEST(StabilityMap, withTheControllerEveryLoopHolds) {
    StabilitySweep sweep = quickStabilitySweep();
    sweep.tissues = {cases::Tissue::enamel};
#ifdef HANDPIECE_SANITIZED
    sweep.motions = {LoopMotion::touch};
    sweep.rateHz = {1000};
#endif
    const std::vector<StabilityRow> rows = stabilityMap(sweep);
    for (const LoopMotion motion : sweep.motions) {
        int all = 0, off = 0, on = 0;
        for (const StabilityRow& r : rows) {
            if (r.motion != motion) continue;
            ++all;
            off += r.off.holds;
            on += r.on.holds;
            EXPECT_TRUE(r.on.holds) << nameOf(motion) << ", " << cases::properties(r.tissue).name << ", "
                                    << r.stiffnessNPerMm << " N/mm, " << r.hand << " hand, " << r.delayS << " s, "
                                    << r.rateHz << " Hz: " << r.on.marginNmm << " N mm";
            EXPECT_GT(r.on.ticks, 0u) << nameOf(motion) << ": nothing was touched";
            if (motion == LoopMotion::cut) {
                EXPECT_GT(r.on.removedMm3, 0.0);
            }
        }
        std::printf("  %s: %d of %d hold without the controller, %d with\n", std::string(nameOf(motion)).c_str(), off,
                    all, on);
        EXPECT_LT(off, all) << "the map shows where the bare loop is not passive";
    }
}

TEST(StabilityMap, holdsWhileTheHandPullsAwayFasterThanTheForceFalls) {
    // The hand leads and the force falls behind it, late: a tracker that takes the fall for a brake believes the arm
    // slow and lets too much through.
    StabilitySweep sweep;
    sweep.motions = {LoopMotion::touch};
    sweep.tissues = {cases::Tissue::enamel, cases::Tissue::restoration};
    sweep.stiffnessNPerMm = {0.9, 1.0, 1.1, 1.2, 1.4};
    sweep.hands = {device::handByName("normal"), device::handByName("stiff")};
    sweep.frictionN = {0.2, 0.26, 0.3};
    sweep.delayS = {0.003};
    sweep.rateHz = {1000};
    int bare = 0;
    const std::vector<StabilityRow> rows = stabilityMap(sweep);
    for (const StabilityRow& r : rows) {
        bare += r.off.holds;
        EXPECT_TRUE(r.on.holds) << cases::properties(r.tissue).name << ", " << r.stiffnessNPerMm << " N/mm, " << r.hand
                                << " hand, " << r.frictionN << " N: " << r.on.marginNmm << " N mm";
        EXPECT_LT(10 * r.on.engaged, r.on.ticks) << "it is left alone most of the time";
    }
    std::printf("  pulled away: %d of %zu hold without the controller\n", bare, rows.size());
    EXPECT_LT(bare, static_cast<int>(rows.size()));
}

TEST(StabilityMap, isTheSameAtAnyThreadCountAndCanBeCancelled) {
    StabilitySweep sweep = quickStabilitySweep();
    sweep.motions = {LoopMotion::touch};
    sweep.tissues = {cases::Tissue::enamel};
    sweep.rateHz = {1000};
    const std::string all = stabilityCsv(stabilityMap(sweep));
    core::setThreadCount(1);
    EXPECT_EQ(stabilityCsv(stabilityMap(sweep)), all);
    core::setThreadCount(0);
    EXPECT_THROW((void)stabilityMap(sweep, [](double) { return false; }), core::Error);
    sweep.hands.clear();
    EXPECT_THROW((void)stabilityMap(sweep), core::Error);
}

}  // namespace
}  // namespace handpiece::studies::stability_map_test
