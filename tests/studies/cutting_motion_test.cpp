// SPDX-License-Identifier: Apache-2.0
#include "studies/cutting_motion.h"

#include <gtest/gtest.h>

#include "base/geometry/meshes.h"
#include "handpiece/base/core/error.h"
#include "tick/force/analytic_methods.h"

namespace handpiece::studies::cutting_motion_test {
namespace {

using core::Vec3;

constexpr double kBall = 3.0, kRadius = 0.4;

CuttingScene ballScene() {
    CuttingScene scene;
    scene.toothBounds = {Vec3::Constant(-kBall), Vec3::Constant(kBall)};
    scene.decay = {test::boxMesh(Vec3(-0.9, -0.7, 1.2), Vec3(0.9, 0.7, 2.6))};
    scene.outerMm = test::ball(kBall);
    scene.burRadiusMm = kRadius;
    return scene;
}

struct Extent {
    double deepest = -10.0;
    core::Box box;
};
Extent sweep(contact::Method& method, const device::Motion& motion) {
    Extent e;
    for (double t = 0; t <= motion.durationS(); t += 0.02) {
        const device::TimedPose p = motion.at(t);
        const double depth = method.depth(p.burInTooth).depthMm;
        e.deepest = std::max(e.deepest, depth);
        if (depth > 0.0) e.box.extend(p.burInTooth.positionMm);
    }
    return e;
}

TEST(CuttingMotion, everyOneStartsClearCutsWithThePedalDownAndEndsClear) {
    test::AnalyticMethod method(test::ball(kBall), kRadius, 4.0);
    for (const BuiltInMotion& m : cuttingMotions()) {
        SCOPED_TRACE(m.name);
        CuttingOptions options;
        options.heightMm = 0.0;
        options.pedal = 0.75;
        const device::Motion motion = cuttingMotionByName(m.name, method, ballScene(), options);
        EXPECT_LT(method.depth(motion.at(0).burInTooth).depthMm, -0.5);
        EXPECT_LT(method.depth(motion.at(motion.durationS()).burInTooth).depthMm, -0.5);
        EXPECT_EQ(motion.at(motion.durationS()).pedal, 0.0);
        for (double t = 0; t <= motion.durationS(); t += 0.02)
            if (method.depth(motion.at(t).burInTooth).depthMm > 0.0) {
                ASSERT_EQ(motion.at(t).pedal, 0.75) << t;
            }
        EXPECT_GT(sweep(method, motion).deepest, 0.7);
    }
}

TEST(CuttingMotion, cavitiesHaveTheSizeAskedFor) {
    test::AnalyticMethod method(test::ball(kBall), kRadius, 4.0);
    CuttingOptions options;
    options.depthMm = 1.0;
    options.lengthMm = 3.0;
    options.isthmusMm = 1.4;
    const Extent cavity = sweep(method, cuttingMotionByName("class-one", method, ballScene(), options));
    EXPECT_NEAR(cavity.box.size().x() + 2 * kRadius, 3.0, 0.02);
    EXPECT_NEAR(cavity.box.size().y() + 2 * kRadius, 1.4, 0.02);
    EXPECT_NEAR(cavity.box.min.z(), kBall - 1.0, 1e-3);

    const Extent decay = sweep(method, cuttingMotionByName("excavate", method, ballScene()));
    EXPECT_NEAR(decay.box.size().x() + 2 * kRadius, 1.8, 0.5);  // a ball cuts no corners: it goes a little beyond
    EXPECT_NEAR(decay.box.min.z(), 1.2, 0.3);

    const Extent plunge = sweep(method, cuttingMotionByName("plunge", method, ballScene()));
    EXPECT_NEAR(plunge.deepest, 1.5, 2e-3);
}

TEST(CuttingMotion, refusesWhatCannotBeCut) {
    test::AnalyticMethod method(test::ball(kBall), kRadius, 4.0);
    const auto refuses = [&](std::string_view name, const CuttingScene& scene, const CuttingOptions& options) {
        EXPECT_THROW((void)cuttingMotionByName(name, method, scene, options), core::Error) << name;
    };
    refuses("dance", ballScene(), {});
    CuttingOptions narrow;
    narrow.isthmusMm = 0.7;
    refuses("class-one", ballScene(), narrow);
    CuttingScene sound = ballScene();
    sound.decay.clear();
    refuses("excavate", sound, {});
    CuttingOptions beside;
    beside.offsetMm = {9.0, 0.0};
    refuses("plunge", ballScene(), beside);
    CuttingOptions foot;
    foot.pedal = 1.5;
    refuses("plunge", ballScene(), foot);
    CuttingOptions high;
    high.heightMm = 20.0;
    refuses("crown-shoulder", ballScene(), high);
}

}  // namespace
}  // namespace handpiece::studies::cutting_motion_test
