// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/force/pose_guard.h"

#include <gtest/gtest.h>

#include <limits>

namespace handpiece::force::pose_guard_test {
namespace {

constexpr double kPeriodS = 1e-3, kFadeInS = 0.2;

core::Pose at(double z) {
    return {core::Vec3(0, 0, z), core::Quat::Identity()};
}

/// Ticks until the gain is down, held and up again after one bad look.
void expectDownHeldAndUp(PoseGuard& guard, const core::Pose& good) {
    int ticks = 0;
    for (; guard.gain() > 0.0; ++ticks)
        guard.look(good, false, kPeriodS, kFadeInS);
    EXPECT_LE(ticks, 10);
    for (; guard.faulted(); ++ticks) {
        EXPECT_EQ(guard.gain(), 0.0);
        guard.look(good, false, kPeriodS, kFadeInS);
    }
    EXPECT_TRUE(guard.startsAnew());
    EXPECT_NEAR(ticks, 50, 1);
    double last = -1.0;
    for (int i = 0; i < 250; ++i) {
        EXPECT_GE(guard.gain(), last);
        EXPECT_LE(guard.gain() - last, last < 0 ? 2.0 : 0.0051);
        last = guard.gain();
        guard.look(good, false, kPeriodS, kFadeInS);
    }
    EXPECT_EQ(guard.gain(), 1.0);
}

TEST(PoseGuard, believesGoodPosesAtOnce) {
    PoseGuard guard;
    guard.look(at(1.0), false, kPeriodS, kFadeInS);
    EXPECT_TRUE(guard.startsAnew());
    EXPECT_EQ(guard.gain(), 1.0);
    guard.look(at(2.0), false, kPeriodS, kFadeInS);
    EXPECT_FALSE(guard.startsAnew());
    EXPECT_EQ(guard.pose().positionMm.z(), 2.0);
}

TEST(PoseGuard, rampsDownAndFadesInAfterEachKindOfDoubt) {
    const core::Pose good = at(1.0);
    core::Pose notFinite = good, noRotation = good;
    notFinite.positionMm.x() = std::numeric_limits<double>::quiet_NaN();
    noRotation.orientation = core::Quat(2, 0, 0, 0);
    for (int kind = 0; kind < 4; ++kind) {
        SCOPED_TRACE(kind);
        PoseGuard guard;
        guard.look(good, false, kPeriodS, kFadeInS);
        switch (kind) {
            case 0:
                guard.look(notFinite, false, kPeriodS, kFadeInS);
                break;
            case 1:
                guard.look(noRotation, false, kPeriodS, kFadeInS);
                break;
            case 2:
                guard.look(good, true, kPeriodS, kFadeInS);
                break;
            default:
                guard.look(at(10'001.0), false, kPeriodS, kFadeInS);  // 10 m away
        }
        EXPECT_TRUE(guard.invalidNow());
        EXPECT_TRUE(guard.faulted());
        EXPECT_LT(guard.gain(), 1.0);
        EXPECT_EQ(guard.pose().positionMm.z(), 1.0);
        expectDownHeldAndUp(guard, kind == 3 ? at(10'001.0) : good);
    }
}

TEST(PoseGuard, holdsZeroWhileDoubtLasts) {
    PoseGuard guard;
    guard.look(at(0.0), false, kPeriodS, kFadeInS);
    for (int i = 0; i < 500; ++i) {
        guard.look(at(0.0), i % 40 == 0, kPeriodS, kFadeInS);  // good for 39 ms at a time: not enough
        if (i > 10) {
            EXPECT_EQ(guard.gain(), 0.0);
        }
    }
}

TEST(PoseGuard, neverHandsOnAPoseBeforeAGoodOne) {
    PoseGuard guard;
    core::Pose bad;
    bad.positionMm.y() = std::numeric_limits<double>::infinity();
    guard.look(bad, false, kPeriodS, kFadeInS);
    EXPECT_TRUE(guard.faulted());
    EXPECT_TRUE(guard.pose().isValid());
}

}  // namespace
}  // namespace handpiece::force::pose_guard_test
