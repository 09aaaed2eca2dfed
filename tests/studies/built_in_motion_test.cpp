// SPDX-License-Identifier: Apache-2.0
#include "studies/built_in_motion.h"

#include <gtest/gtest.h>

#include "handpiece/base/core/error.h"
#include "tick/force/analytic_methods.h"

namespace handpiece::studies::built_in_motion_test {
namespace {

using core::Pose;
using core::Quat;
using core::Vec3;

constexpr double kBall = 3.0, kRadius = 0.5;

TEST(FirstTouch, findsABallWhereTwoRadiiSay) {
    test::AnalyticMethod method(test::ball(kBall), kRadius, 4.0);
    for (const double x : {0.0, 1.0, 2.5, 3.2}) {
        const auto touch = firstTouch(method, {Vec3(x, 0, 6), Quat::Identity()}, {0, 0, -3}, 20);
        ASSERT_TRUE(touch);
        const double sum = kBall + kRadius;
        EXPECT_NEAR(touch->positionMm.z(), std::sqrt(sum * sum - x * x) - kRadius, 1e-3) << x;
    }
    EXPECT_FALSE(firstTouch(method, {Vec3(4, 0, 6), Quat::Identity()}, {0, 0, -1}, 20));
    EXPECT_FALSE(firstTouch(method, {Vec3(0, 0, 6), Quat::Identity()}, {0, 0, -1}, 1));
    EXPECT_THROW((void)firstTouch(method, Pose{}, Vec3::Zero(), 1), core::Error);
}

TEST(BuiltInMotion, everyOneStartsClearOfTheToothAndIsFeasible) {
    test::AnalyticMethod method(test::ball(kBall), kRadius, 4.0);
    core::Box box{Vec3::Constant(-kBall), Vec3::Constant(kBall)};
    for (const BuiltInMotion& m : builtInMotions()) {
        SCOPED_TRACE(m.name);
        const device::Motion motion = motionByName(m.name, method, box);
        EXPECT_NEAR(method.depth(motion.at(0).burInTooth).depthMm, -1.0, m.name == "drag" ? 0.4 : 1e-3);
        double deepest = -10.0;
        for (double t = 0; t <= motion.durationS(); t += 0.01) {
            deepest = std::max(deepest, method.depth(motion.at(t).burInTooth).depthMm);
        }
        if (m.name == "hold") {
            EXPECT_LT(deepest, 0.0);
        } else {
            EXPECT_GT(deepest, 1.0);
        }
    }
}

TEST(BuiltInMotion, refusesNamesPlacesAndOptionsThatAreNone) {
    test::AnalyticMethod method(test::ball(kBall), kRadius, 4.0);
    core::Box box{Vec3::Constant(-kBall), Vec3::Constant(kBall)};
    EXPECT_THROW((void)motionByName("dance", method, box), core::Error);
    EXPECT_THROW((void)motionByName("drop", method, core::Box{}), core::Error);
    MotionOptions beside;
    beside.offsetMm = {10, 0};
    EXPECT_THROW((void)motionByName("drop", method, box, beside), core::Error);
    MotionOptions still;
    still.speedMmS = 0;
    EXPECT_THROW((void)motionByName("drop", method, box, still), core::Error);
}

}  // namespace
}  // namespace handpiece::studies::built_in_motion_test
