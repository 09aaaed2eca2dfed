// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/bur_frame.h"

#include <gtest/gtest.h>

#include "handpiece/model/instrument/shapes.h"
#include "support/random.h"

namespace handpiece::contact::bur_frame_test {
namespace {

using core::Vec3;

TEST(BurFrame, isThePoseToTheBit) {
    std::mt19937_64 g(test::seed());
    for (int i = 0; i < 2000; ++i) {
        const core::Pose pose{5.0 * test::randomDirection(g), test::randomRotation(g)};
        const BurFrame frame(pose);
        EXPECT_EQ(frame.tip, pose.positionMm);
        // Whoever turns the shank's axis alone gets the same numbers: a recorded session holds that.
        EXPECT_EQ(frame.z, pose.orientation * Vec3::UnitZ());
        const Vec3 p = 5.0 * test::randomDirection(g);
        EXPECT_LT((frame.toBur * (p - frame.tip) - pose.applyInverse(p)).norm(), 1e-14);
        EXPECT_LT((frame.onAxis(3.0) - pose.apply(Vec3(0, 0, 3.0))).norm(), 1e-14);
    }
}

TEST(BurFrame, itsBoxHoldsTheBurClosely) {
    std::mt19937_64 g(test::seed());
    const instrument::Bur bur = instrument::makeBur("cylinder-flat:1.0x4.0");
    for (int i = 0; i < 200; ++i) {
        const core::Pose pose{5.0 * test::randomDirection(g), test::randomRotation(g)};
        const core::Box box = BurFrame(pose).boxAround(bur.lengthMm(), bur.maxRadiusMm(), 0.0);
        core::Box points;
        for (const Vec3& v : bur.mesh().vertices)
            points.extend(pose.apply(v));
        constexpr double kMeshMm = 0.02;  // chords of the bur's mesh
        EXPECT_TRUE((points.min.array() >= box.min.array() - 1e-9).all());
        EXPECT_TRUE((points.max.array() <= box.max.array() + 1e-9).all());
        EXPECT_LT((points.min - box.min).maxCoeff(), kMeshMm);
        EXPECT_LT((box.max - points.max).maxCoeff(), kMeshMm);
    }
}

}  // namespace
}  // namespace handpiece::contact::bur_frame_test
