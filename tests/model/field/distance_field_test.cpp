// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/field/distance_field.h"

#include <gtest/gtest.h>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "support/random.h"

namespace handpiece::field::distance_field_test {
namespace {

using core::Box;
using core::Vec3;
using test::uniform;

constexpr double kRadius = 2.0;
double sphere(const Vec3& p) {
    return p.norm() - kRadius;
}
double box(const Vec3& p) {
    const Vec3 q = p.cwiseAbs() - Vec3(1.5, 1.0, 0.7);
    return q.cwiseMax(0.0).norm() + std::min(0.0, q.maxCoeff());
}
double torus(const Vec3& p) {
    return std::hypot(std::hypot(p.x(), p.y()) - 2.0, p.z()) - 0.8;
}

DistanceField sphereField(double voxelMm, const FieldSettings& bands = {}) {
    FieldSettings settings = bands;
    settings.voxelMm = voxelMm;
    return DistanceField::fromFunction(Box{Vec3::Constant(-2.3), Vec3::Constant(2.3)}, settings, sphere);
}

Vec3 randomPoint(std::mt19937_64& g, double extent) {
    return {uniform(g, -extent, extent), uniform(g, -extent, extent), uniform(g, -extent, extent)};
}

TEST(DistanceField, EveryPointOfTheBandLiesInABrickAndIsAccurate) {
    std::mt19937_64 g(test::seed());
    const DistanceField field = sphereField(0.05);
    for (int i = 0; i < 20000; ++i) {
        const Vec3 p = test::randomDirection(g) * (kRadius + uniform(g, -0.3, 0.1));
        ASSERT_TRUE(field.isFine(p));
        // Trilinear interpolation of |p| errs by h^2 / (4 r) at most.
        EXPECT_NEAR(field.distance(p), sphere(p), 0.05 * 0.05 / (4 * 1.7) + 1e-6);
        EXPECT_NEAR(field.normal(p).dot(p.normalized()), 1.0, 1e-4);
    }
}

TEST(DistanceField, AwayFromTheBandTheSignIsRightAndTheMagnitudeALowerBound) {
    std::mt19937_64 g(test::seed());
    for (const auto& shape : {sphere, box, torus}) {
        const DistanceField field =
            DistanceField::fromFunction(Box{Vec3::Constant(-3.2), Vec3::Constant(3.2)}, {}, shape);
        int coarse = 0;
        for (int i = 0; i < 20000; ++i) {
            const Vec3 p = randomPoint(g, 6.0);
            if (field.isFine(p)) continue;
            ++coarse;
            const double truth = shape(p), got = field.distance(p);
            EXPECT_LE(std::abs(got), std::abs(truth)) << p.transpose();
            EXPECT_GE(got * truth, 0.0);
            EXPECT_EQ(field.normal(p), Vec3::Zero());
        }
        EXPECT_GT(coarse, 5000);
    }
}

TEST(DistanceField, OutsideTheGridAtLeastTheDistanceToItsBox) {
    std::mt19937_64 g(test::seed());
    const DistanceField field = sphereField(0.1);
    const Box grid = field.bounds();
    for (int i = 0; i < 5000; ++i) {
        const Vec3 p = randomPoint(g, 20.0);
        const double toBox = (p - p.cwiseMax(grid.min).cwiseMin(grid.max)).norm();
        if (toBox == 0.0) continue;
        EXPECT_GE(field.distance(p), toBox * (1.0 - 1e-12));
        EXPECT_LE(field.distance(p), sphere(p) + 1e-3);
        EXPECT_EQ(field.tissueAt(p), cases::Tissue::none);
        EXPECT_FALSE(field.isFine(p));
    }
    EXPECT_EQ(field.distance(Vec3(0, std::nan(""), 0)), std::numeric_limits<double>::infinity());
    EXPECT_NEAR(field.distance(Vec3(1e300, 0, 0)), 1e300, 1e288);
    EXPECT_FALSE(field.isFine(Vec3(0, std::nan(""), 0)));
}

TEST(DistanceField, RepeatedNodesAreEqualBitForBitAndTheFieldIsContinuous) {
    const DistanceField field = sphereField(0.05);
    const FieldView v = field.view();
    std::size_t compared = 0;
    for (int z = 0; z < v.bricks[2]; ++z)
        for (int y = 0; y < v.bricks[1]; ++y)
            for (int x = 0; x + 1 < v.bricks[0]; ++x) {
                const std::int32_t a = v.brickIndex[x + v.bricks[0] * (y + v.bricks[1] * z)];
                const std::int32_t b = v.brickIndex[x + 1 + v.bricks[0] * (y + v.bricks[1] * z)];
                if (a < 0 || b < 0) continue;
                for (int j = 0; j < kBrickNodes; ++j)
                    for (int k = 0; k < kBrickNodes; ++k, ++compared)
                        ASSERT_EQ(v.values[a * kBrickValues + 8 + 9 * j + 81 * k],
                                  v.values[b * kBrickValues + 9 * j + 81 * k]);
            }
    EXPECT_GT(compared, 10000u);
    std::mt19937_64 g(test::seed());
    for (int i = 0; i < 20000; ++i) {
        const Vec3 p = test::randomDirection(g) * (kRadius + uniform(g, -0.25, 0.05)),
                   q = p + 1e-6 * test::randomDirection(g);
        EXPECT_LT(std::abs(field.distance(p) - field.distance(q)), 2e-6);
        EXPECT_LT((field.normal(p) - field.normal(q)).norm(), 1e-3);
    }
}

TEST(DistanceField, InterpolationErrorFallsWithTheSquareOfTheVoxel) {
    double error[3] = {};
    const double voxel[3] = {0.1, 0.05, 0.025};
    for (int k = 0; k < 3; ++k) {
        std::mt19937_64 g(test::seed());
        const DistanceField field = sphereField(voxel[k]);
        for (int i = 0; i < 20000; ++i) {
            const Vec3 p = test::randomDirection(g) * (kRadius + uniform(g, -0.05, 0.05));
            error[k] = std::max(error[k], std::abs(field.distance(p) - sphere(p)));
        }
    }
    EXPECT_NEAR(error[0] / error[1], 4.0, 0.6);
    EXPECT_NEAR(error[1] / error[2], 4.0, 0.6);
}

TEST(DistanceField, VolumeAndAreaOfClosedForms) {
    const double r3 = std::pow(kRadius, 3), r2 = kRadius * kRadius;
    for (const double voxel : {0.1, 0.05, 0.025}) {
        const DistanceField field = sphereField(voxel);
        // Linear pieces in a convex shape: short by h^2 / (2 r^2), a tenth of a per cent where a voxel is a twentieth
        // of r.
        const double bound = 0.6 * voxel * voxel / r2 + 1e-5;
        EXPECT_NEAR(field.volumeMm3() / (4.0 / 3.0 * M_PI * r3), 1.0, bound);
        EXPECT_NEAR(field.areaMm2() / (4.0 * M_PI * r2), 1.0, bound);
    }
    const Box around{Vec3::Constant(-3.2), Vec3::Constant(3.2)};
    const DistanceField ring = DistanceField::fromFunction(around, {}, torus);
    EXPECT_NEAR(ring.volumeMm3() / (2.0 * M_PI * M_PI * 2.0 * 0.8 * 0.8), 1.0, 1e-3);
    EXPECT_NEAR(ring.areaMm2() / (4.0 * M_PI * M_PI * 2.0 * 0.8), 1.0, 1e-3);
    const DistanceField brick = DistanceField::fromFunction(around, {}, box);
    // A voxel rounds the edges off: 25.6 mm of edge at 50 um, by less than h^2 / 2 of section and h of width.
    EXPECT_NEAR(brick.volumeMm3(), 8.0 * 1.5 * 1.0 * 0.7, 25.6 * 0.05 * 0.05 / 2.0);
    EXPECT_NEAR(brick.areaMm2(), 8.0 * (1.5 * 1.0 + 1.0 * 0.7 + 0.7 * 1.5), 25.6 * 0.05);
}

TEST(DistanceField, TissueOfTheNearestNode) {
    const auto layers = [](const Vec3& p) { return p.norm() > 1.9 ? cases::Tissue::enamel : cases::Tissue::dentine; };
    const DistanceField field =
        DistanceField::fromFunction(Box{Vec3::Constant(-2.3), Vec3::Constant(2.3)}, {}, sphere, layers);
    std::mt19937_64 g(test::seed());
    for (int i = 0; i < 5000; ++i) {
        const Vec3 d = test::randomDirection(g);
        EXPECT_EQ(field.tissueAt(d * uniform(g, 1.95, 2.1)), cases::Tissue::enamel);
        EXPECT_EQ(field.tissueAt(d * uniform(g, 0.0, 1.85)), cases::Tissue::dentine);
    }
    EXPECT_EQ(field.tissueAt(Vec3(2.29, 2.29, 2.29)), cases::Tissue::none);
    EXPECT_EQ(sphereField(0.1).tissueAt(Vec3::Zero()), cases::Tissue::enamel);
}

TEST(DistanceField, TheSameBitsAtAnyThreadCount) {
    core::setThreadCount(1);
    const std::uint64_t one = sphereField(0.1).stateHash();
    core::setThreadCount(3);
    const DistanceField field = sphereField(0.1);
    core::setThreadCount(0);
    EXPECT_EQ(field.stateHash(), one);
    EXPECT_NE(sphereField(0.11).stateHash(), one);
    EXPECT_EQ(field.volumeMm3(), sphereField(0.1).volumeMm3());
}

TEST(DistanceField, SettingsThatMakeNoGridAreRefused) {
    const Box small{Vec3::Constant(-1.0), Vec3::Constant(1.0)};
    for (const double voxel : {0.0, -0.1, std::nan(""), 1e-7}) {
        FieldSettings settings;
        settings.voxelMm = voxel;
        EXPECT_THROW((void)DistanceField::fromFunction(small, settings, sphere), core::Error) << voxel;
    }
    FieldSettings settings;
    settings.bandInMm = -1.0;
    EXPECT_THROW((void)DistanceField::fromFunction(small, settings, sphere), core::Error);
    EXPECT_THROW((void)DistanceField::fromFunction(Box{}, {}, sphere), core::Error);
}

TEST(DistanceField, CancelledWorkStops) {
    const auto stop = [](double fraction) { return fraction < 0.3; };
    EXPECT_THROW(
        (void)DistanceField::fromFunction(Box{Vec3::Constant(-2.3), Vec3::Constant(2.3)}, {}, sphere, {}, stop),
        core::Error);
}

}  // namespace
}  // namespace handpiece::field::distance_field_test
