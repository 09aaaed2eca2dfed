// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/vec.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace handpiece::core::vec_test {
namespace {

TEST(Pose, inverseUndoesIt) {
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 100; ++i) {
        const Pose pose{10.0 * test::randomDirection(generator), test::randomRotation(generator)};
        const Vec3 p = 5.0 * test::randomDirection(generator);
        EXPECT_LT((pose.applyInverse(pose.apply(p)) - p).norm(), 1e-13);
        EXPECT_TRUE(pose.isValid());
    }
}

TEST(Pose, knowsWhenItIsNone) {
    Pose pose;
    pose.positionMm.x() = std::nan("");
    EXPECT_FALSE(pose.isValid());
    pose = Pose{};
    pose.orientation.coeffs() *= 1.01;
    EXPECT_FALSE(pose.isValid());
    pose = Pose{};
    pose.positionMm.z() = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(pose.isValid());
}

TEST(Box, growsRoundPoints) {
    Box box;
    EXPECT_TRUE(box.isEmpty());
    box.extend({1, 2, 3});
    box.extend({-1, 5, 0});
    EXPECT_FALSE(box.isEmpty());
    EXPECT_EQ(box.size(), Vec3(2, 3, 3));
    EXPECT_EQ(box.grown(1).min, Vec3(-2, 1, -1));
    EXPECT_EQ(box.centre(), Vec3(0, 3.5, 1.5));
}

}  // namespace
}  // namespace handpiece::core::vec_test
