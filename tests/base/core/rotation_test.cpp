// SPDX-License-Identifier: Apache-2.0
// Against Eigen's own, which are the same formulas with the C library's angles.
#include "handpiece/base/core/rotation.h"

#include <gtest/gtest.h>

#include <numbers>

#include "support/random.h"

namespace handpiece::core::rotation_test {
namespace {

TEST(Rotation, isEigens) {
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 2000; ++i) {
        const Quat a = test::randomRotation(generator), far = test::randomRotation(generator);
        const Vec3 axis = test::randomDirection(generator);
        const double rad = test::uniform(generator, -7.0, 7.0), share = test::uniform(generator, 0.0, 1.0);
        EXPECT_LT((rotationAbout(axis, rad).coeffs() - Quat(Eigen::AngleAxisd(rad, axis)).coeffs()).norm(), 1e-15);
        const Quat near = a * rotationAbout(axis, 1e-7 * rad);
        for (const Quat& b : {far, near, a, Quat(-a.coeffs())}) {
            EXPECT_NEAR(angleBetween(a, b), a.angularDistance(b), 1e-15);
            EXPECT_LT((interpolated(a, share, b).coeffs() - a.slerp(share, b).coeffs()).norm(), 1e-8);
            EXPECT_NEAR(angleBetween(a, interpolated(a, share, b)), share * angleBetween(a, b), 1e-8);
        }
    }
}

TEST(Rotation, halfATurn) {
    EXPECT_EQ(angleBetween(Quat(1, 0, 0, 0), Quat(0, 0, 1, 0)), std::numbers::pi);
    EXPECT_NEAR(angleBetween(rotationAbout(Vec3::UnitX(), std::numbers::pi / 2.0), Quat::Identity()),
                std::numbers::pi / 2.0, 1e-15);
}

}  // namespace
}  // namespace handpiece::core::rotation_test
