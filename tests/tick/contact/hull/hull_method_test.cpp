// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/hull/hull_method.h"

#include <gtest/gtest.h>

#include "base/geometry/convex_shapes.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/convex_hull.h"
#include "support/realtime_trap.h"

namespace handpiece::contact::hull_method_test {
namespace {

using core::Pose;
using core::Vec3;
using test::uniform;

geometry::TriangleMesh hullMesh(const std::vector<Vec3>& points) {
    return geometry::ConvexHull{std::span<const Vec3>(points)}.mesh();
}

// The paper's plane: a grid of 13 x 13 points, closed into a slab 1 mm thick. Its top is z = 0.
geometry::TriangleMesh slab() {
    std::vector<Vec3> points;
    for (int x = -6; x <= 6; ++x)
        for (int y = -6; y <= 6; ++y)
            for (int side = 0; side < 2; ++side)
                points.emplace_back(0.5 * x, 0.5 * y, -side);
    return hullMesh(points);
}
geometry::TriangleMesh roundBur() {
    return hullMesh(test::roundEndedCylinder(0.5, 4.0));
}

Pose tilted(const Vec3& at) {
    return {at, core::Quat(Eigen::AngleAxisd(0.26, Vec3(1, 0.3, 0).normalized()))};
}

TEST(HullMethod, onAPlaneDepthIsHowFarTheLowestVertexIsBelowIt) {
    const auto method = makeHullMethod(slab(), roundBur());
    for (const double z : {-0.3, -0.1, -1e-4, 0.0, 1e-4, 0.2, 3.0}) {
        const Depth d = method->depth({Vec3(0.1, 0.2, z), core::Quat::Identity()});
        EXPECT_EQ(d.status, Status::ok);
        EXPECT_NEAR(d.depthMm, -z, 1e-10);
        EXPECT_NEAR((d.normal - Vec3::UnitZ()).norm(), 0.0, 1e-9);
        EXPECT_NEAR(d.toothPointMm.z(), 0.0, 1e-9);
        EXPECT_EQ(d.tissue, cases::Tissue::enamel);
    }
}

TEST(HullMethod, followsEveryStepDownTo10nm) {
    const auto method = makeHullMethod(slab(), roundBur());
    for (const bool isTilted : {false, true})
        for (const double stepMm : {0.1, 0.05, 0.01, 0.005, 0.001, 0.0005, 0.0001, 0.00001}) {
            double last = 0.0;
            for (int k = 0; k < 6; ++k) {
                const Vec3 at(0.137, -0.211, -0.013 - k * stepMm);
                const double depth = method->depth(isTilted ? tilted(at) : Pose{at, core::Quat::Identity()}).depthMm;
                if (k > 0) {
                    EXPECT_NEAR(depth - last, stepMm, 0.1 * stepMm) << stepMm << " mm, step " << k;
                }
                last = depth;
            }
        }
}

TEST(HullMethod, movingByDepthAlongTheNormalMakesThemTouch) {
    std::mt19937_64 generator(test::seed());
    const geometry::TriangleMesh tooth = hullMesh(test::bumpySphere(4000, 5.0, 0.1)), bur = roundBur();
    const auto method = makeHullMethod(tooth, bur), fresh = makeHullMethod(tooth, bur);
    for (int i = 0; i < 300; ++i) {
        Pose pose{uniform(generator, 4, 6.5) * test::randomDirection(generator), test::randomRotation(generator)};
        const Depth d = method->depth(pose);
        ASSERT_EQ(d.status, Status::ok);
        fresh->reset();
        EXPECT_NEAR(fresh->depth(pose).depthMm, d.depthMm, 1e-9);
        pose.positionMm += d.depthMm * d.normal;
        EXPECT_NEAR(method->depth(pose).depthMm, 0.0, 1e-8);
    }
}

TEST(HullMethod, feelsTheHullOverAHollow) {
    // A bowl is felt as filled: that is what the paper's method does.
    geometry::TriangleMesh bowl = slab();
    bowl.vertices.push_back(Vec3(0, 0, -0.8));
    const auto method = makeHullMethod(bowl, roundBur());
    EXPECT_NEAR(method->depth({Vec3(0, 0, -0.2), core::Quat::Identity()}).depthMm, 0.2, 1e-9);
}

TEST(HullMethod, neitherAllocatesNorLocks) {
    if (!test::RealtimeTrap::isActive()) GTEST_SKIP() << "the sanitizers own malloc: the trap is off";
    std::mt19937_64 generator(test::seed());
    const auto method = makeHullMethod(hullMesh(test::bumpySphere(4000, 5.0, 0.1)), roundBur());
    std::vector<Pose> poses;
    for (int i = 0; i < 200; ++i)
        poses.push_back({uniform(generator, 0, 7) * test::randomDirection(generator), test::randomRotation(generator)});
    PatchSet patches;
    ConstraintSet constraints;
    const test::RealtimeTrap trap;
    for (const Pose& pose : poses) {
        (void)method->depth(pose);
        method->patches(pose, patches);
        (void)method->constraints(pose, 1.0, constraints);
    }
    EXPECT_EQ(trap.total(), 0u);
}

// A ball in the middle of a ball: all ways out are about equally short, the worst case for EPA.
TEST(HullMethod, aFullPolytopeStillGivesALowerBound) {
    const auto method =
        makeHullMethod(hullMesh(test::bumpySphere(20000, 5.0, 0.0)), hullMesh(test::bumpySphere(500, 1.0, 0.0)));
    const Depth d = method->depth({});
    EXPECT_EQ(d.status, Status::truncated);
    EXPECT_GT(d.depthMm, 5.7);
    EXPECT_LT(d.depthMm, 6.0);
    EXPECT_NEAR(d.normal.norm(), 1.0, 1e-12);
}

TEST(HullMethod, refusesPosesAndMeshesWithoutSense) {
    const auto method = makeHullMethod(slab(), roundBur(), cases::Tissue::dentine);
    const Depth d = method->depth({Vec3(0, 0, std::nan("")), core::Quat::Identity()});
    EXPECT_EQ(d.status, Status::invalidPose);
    EXPECT_EQ(d.depthMm, -std::numeric_limits<double>::infinity());
    EXPECT_NEAR(method->depth({Vec3(0, 0, -0.1), core::Quat::Identity()}).depthMm, 0.1, 1e-9)
        << "still sound afterwards";
    EXPECT_THROW((void)makeHullMethod({}, roundBur()), core::Error);
    EXPECT_THROW((void)makeHullMethod(slab(), {{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {{0, 1, 2}}}),
                 core::Error);
}

TEST(HullMethod, reportsOnePatchAndOneConstraint) {
    const auto method = makeHullMethod(slab(), roundBur(), cases::Tissue::dentine);
    PatchSet patches;
    method->patches({Vec3(0, 0, -0.1), core::Quat::Identity()}, patches);
    ASSERT_EQ(patches.patches.size(), 1u);
    EXPECT_EQ(patches.patches[0].tissue, cases::Tissue::dentine);
    ConstraintSet constraints;
    EXPECT_EQ(method->constraints({Vec3(0, 0, 0.1), core::Quat::Identity()}, 0.2, constraints), Status::ok);
    ASSERT_EQ(constraints.size(), 1u);
    EXPECT_NEAR(constraints[0].gapMm, 0.1, 1e-9);
    EXPECT_EQ(method->constraints({Vec3(0, 0, 0.3), core::Quat::Identity()}, 0.2, constraints), Status::ok);
    EXPECT_TRUE(constraints.empty());
}

}  // namespace
}  // namespace handpiece::contact::hull_method_test
