// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/device/motion.h"

#include <gtest/gtest.h>

#include <limits>

#include "handpiece/base/core/error.h"

namespace handpiece::device::motion_test {
namespace {

using core::Pose;
using core::Quat;
using core::Vec3;

Pose at(const Vec3& p) {
    return {p, Quat::Identity()};
}

TEST(Motion, goesStraightBetweenPosesAndHoldsOutside) {
    const Quat turned(Eigen::AngleAxisd(1.0, Vec3::UnitX()));
    const Motion m({{1.0, at({0, 0, 0}), 0.0}, {3.0, {Vec3(4, 0, -2), turned}, 1.0}});
    EXPECT_EQ(m.at(0.0).burInTooth.positionMm, Vec3(0, 0, 0));
    EXPECT_LT((m.at(1.5).burInTooth.positionMm - Vec3(1, 0, -0.5)).norm(), 1e-12);
    EXPECT_NEAR(m.at(2.0).burInTooth.orientation.angularDistance(Quat::Identity()), 0.5, 1e-9);
    EXPECT_NEAR(m.at(2.0).pedal, 0.5, 1e-12);
    EXPECT_EQ(m.at(9.0).burInTooth.positionMm, Vec3(4, 0, -2));
    EXPECT_EQ(m.durationS(), 3.0);
    EXPECT_TRUE(m.at(2.3).burInTooth.isValid());
}

TEST(Motion, builtInOnesKeepTheirSpeedAndEndWhereTheySay) {
    const Pose start = at({1, 2, 3});
    const Motion down = drop(start, {0, 0, -2}, 4.0, 8.0, 0.5);
    EXPECT_NEAR(down.durationS(), 1.0, 1e-12);
    EXPECT_LT((down.at(0.25).burInTooth.positionMm - Vec3(1, 2, 1)).norm(), 1e-12);
    EXPECT_LT((down.at(1.0).burInTooth.positionMm - Vec3(1, 2, -1)).norm(), 1e-12);

    EXPECT_EQ(press(start, {0, 0, -1}, 1.0, 5.0, 0.1).at(9).burInTooth.positionMm, start.positionMm);
    EXPECT_LT((slide(start, {0, 0, -1}, 1.0, {2, 0, 0}, 5.0).at(9).burInTooth.positionMm - Vec3(3, 2, 3)).norm(),
              1e-12);
    EXPECT_EQ(hold(start, 2.0).durationS(), 2.0);

    const Motion dragged = drag({{0, 0, 1}, {1, 0, 0}, {2, 0, 1}}, Quat::Identity(), {0, 0, -1}, 0.5, 2.0, 10.0);
    EXPECT_EQ(dragged.at(0).burInTooth.positionMm, Vec3(0, 0, 3));
    double lowest = 10;
    for (double t = 0; t < dragged.durationS(); t += 1e-3)
        lowest = std::min(lowest, dragged.at(t).burInTooth.positionMm.z());
    EXPECT_NEAR(lowest, -0.5, 0.01);

    const Motion circle = closedLoop(start, {0, 0, 1}, {1, 0, 1}, 0.15, 3.0, 2);
    EXPECT_NEAR(circle.durationS(), 2 * 2 * 3.14159265 * 0.15 / 3.0, 1e-4);
    EXPECT_LT((circle.at(circle.durationS()).burInTooth.positionMm - start.positionMm).norm(), 1e-12);
    const Vec3 centre = start.positionMm - Vec3(0, 0, 0.15);
    for (double t = 0; t < circle.durationS(); t += 0.01) {
        EXPECT_NEAR((circle.at(t).burInTooth.positionMm - centre).norm(), 0.15, 1e-5);
    }
}

TEST(Motion, refusesWhatCannotBeFollowed) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(Motion({}), core::Error);
    EXPECT_THROW(Motion({{nan, Pose{}, 0}}), core::Error);
    EXPECT_THROW(Motion({{0, at({nan, 0, 0}), 0}}), core::Error);
    EXPECT_THROW(Motion({{0, {Vec3::Zero(), Quat(2, 0, 0, 0)}, 0}}), core::Error);
    EXPECT_THROW(Motion({{0, Pose{}, 0}, {0, Pose{}, 0}}), core::Error);
    EXPECT_THROW(Motion({{0, Pose{}, 1.5}}), core::Error);
    EXPECT_THROW((void)drop(Pose{}, Vec3::Zero(), 1, 1, 0), core::Error);
    EXPECT_THROW((void)drop(Pose{}, Vec3::UnitX(), 1, 0, 0), core::Error);
    EXPECT_THROW((void)drop(Pose{}, Vec3::UnitX(), -1, 1, 0), core::Error);
    EXPECT_THROW((void)closedLoop(Pose{}, Vec3::UnitX(), Vec3::UnitX(), 1, 1, 1), core::Error);
    EXPECT_THROW((void)closedLoop(Pose{}, Vec3::UnitX(), Vec3::UnitY(), 1, 1, 0), core::Error);
    EXPECT_THROW((void)drag({Vec3::Zero()}, Quat::Identity(), Vec3::UnitX(), 1, 1, 1), core::Error);
}

}  // namespace
}  // namespace handpiece::device::motion_test
