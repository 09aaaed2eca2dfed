// SPDX-License-Identifier: Apache-2.0
// The field between its nodes against closed forms.
#include "handpiece/model/field/sharp_lookup.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <vector>

#include "support/random.h"

namespace handpiece::field::sharp_lookup_test {
namespace {

using core::Vec3;
using Distance = std::function<double(const Vec3&)>;

constexpr double kVoxelMm = 0.05;

DistanceField fieldOf(const Distance& distance) {
    FieldSettings settings;
    settings.voxelMm = kVoxelMm;
    settings.bandOutMm = 0.2;
    return DistanceField::fromFunction({Vec3::Constant(-1.5), Vec3::Constant(1.5)}, settings, distance);
}
Distance ballAt(const Vec3& centre, double radiusMm) {
    return [=](const Vec3& p) { return (p - centre).norm() - radiusMm; };
}
/// Random places within a micron of the surface, found by walking down the closed form.
std::vector<Vec3> surfacePoints(const Distance& distance, std::mt19937_64& random, std::size_t count) {
    std::vector<Vec3> points;
    while (points.size() < count) {
        Vec3 p(test::uniform(random, -1.1, 1.1), test::uniform(random, -1.1, 1.1), test::uniform(random, -1.1, 1.1));
        for (int i = 0; i < 30; ++i) {
            constexpr double kStep = 1e-5;
            Vec3 slope;
            for (int k = 0; k < 3; ++k)
                slope[k] = (distance(p + kStep * Vec3::Unit(k)) - distance(p - kStep * Vec3::Unit(k))) / (2.0 * kStep);
            if (std::abs(distance(p)) > 0.2) break;
            p -= distance(p) * slope / std::max(slope.squaredNorm(), 0.1);
        }
        if (std::abs(distance(p)) < 1e-3 && p.cwiseAbs().maxCoeff() < 1.2) points.push_back(p);
    }
    return points;
}
struct Errors {
    double medianMm, p99Mm, worstMm;
};
Errors errorsOf(const std::function<double(const Vec3&)>& told, const Distance& truth,
                const std::vector<Vec3>& points) {
    std::vector<double> errors;
    for (const Vec3& p : points)
        errors.push_back(std::abs(told(p) - truth(p)));
    std::sort(errors.begin(), errors.end());
    return {errors[errors.size() / 2], errors[errors.size() * 99 / 100], errors.back()};
}

TEST(SharpLookup, isOfTheThirdOrderOnARoundWall) {
    std::mt19937_64 random(test::seed());
    const Distance ball = ballAt({0.013, -0.02, 0.007}, 0.8);
    const DistanceField field = fieldOf(ball);
    SharpLookup sharp(field, core::simdLevel());
    const std::vector<Vec3> points = surfacePoints(ball, random, 3000);
    const Errors told = errorsOf([&](const Vec3& p) { return sharp.distance(p); }, ball, points);
    const Errors mixed = errorsOf([&](const Vec3& p) { return field.distance(p); }, ball, points);
    EXPECT_LT(told.worstMm, 5e-5);
    EXPECT_GT(mixed.medianMm, 20.0 * told.medianMm);
    for (const Vec3& p : points) {
        const Vec3 out = (p - Vec3(0.013, -0.02, 0.007)).normalized();
        EXPECT_GT(sharp.normal(p).dot(out), 0.9999);
    }
}

TEST(SharpLookup, tellsSlopeAndBendOfARoundWall) {
    std::mt19937_64 random(test::seed());
    const Vec3 centre(0.013, -0.02, 0.007);
    const Distance ball = ballAt(centre, 0.8);
    const DistanceField field = fieldOf(ball);
    SharpLookup sharp(field, core::simdLevel());
    const std::vector<Vec3> points = surfacePoints(ball, random, 2000);
    std::size_t smooth = 0;
    for (const Vec3& p : points) {
        SharpLookup::Wall wall;
        if (!sharp.wallAt(p, wall)) continue;
        ++smooth;
        const Vec3 out = (p - centre).normalized();
        const core::Mat3 bend = (core::Mat3::Identity() - out * out.transpose()) / (p - centre).norm();
        EXPECT_NEAR(wall.distanceMm, sharp.distance(p), 1e-7);
        EXPECT_LT((wall.slope - out).norm(), 1e-4);
        EXPECT_LT((wall.bendPerMm - bend).norm(), 0.02);
    }
    EXPECT_GT(smooth, points.size() * 9 / 10);
}

TEST(SharpLookup, tellsOfNoSmoothWallWhereTwoMeet) {
    std::mt19937_64 random(test::seed());
    const Vec3 side = test::randomDirection(random), other = side.unitOrthogonal();
    const Distance roof = [&](const Vec3& p) { return std::max(side.dot(p), (0.8 * other + 0.6 * side).dot(p)); };
    const DistanceField field = fieldOf(roof);
    SharpLookup sharp(field, core::simdLevel());
    for (int i = 0; i < 1000; ++i) {
        const Vec3 p = test::uniform(random, -1.2, 1.2) * side.cross(other) +
                       0.01 * test::uniform(random, 0.0, 1.0) * test::randomDirection(random);
        SharpLookup::Wall wall;
        EXPECT_FALSE(sharp.wallAt(p, wall)) << p.transpose();
    }
}

TEST(SharpLookup, keepsAnEdgeWhereTwoRoundWallsMeet) {
    std::mt19937_64 random(test::seed());
    for (int turn = 0; turn < 6; ++turn) {
        // What two round burs have left between them: the ridge stands out of the tooth.
        Vec3 side = test::randomDirection(random);
        const Distance first = ballAt(0.55 * side, 0.6),
                       second = ballAt(-0.5 * side + 0.1 * test::randomDirection(random), 0.55);
        const Distance ridge = [&](const Vec3& p) { return std::max({p.norm() - 1.1, -first(p), -second(p)}); };
        const DistanceField field = fieldOf(ridge);
        SharpLookup sharp(field, core::simdLevel());
        std::vector<Vec3> points = surfacePoints(ridge, random, 1500);
        std::erase_if(points, [&](const Vec3& p) { return std::abs(first(p) - second(p)) > 0.06; });
        ASSERT_GT(points.size(), 40u);
        const Errors told = errorsOf([&](const Vec3& p) { return sharp.distance(p); }, ridge, points);
        const Errors mixed = errorsOf([&](const Vec3& p) { return field.distance(p); }, ridge, points);
        EXPECT_LT(told.medianMm, 1e-4);
        EXPECT_LT(told.p99Mm, 0.5 * mixed.p99Mm);
    }
}

TEST(SharpLookup, keepsTheInnerCornerOfABox) {
    std::mt19937_64 random(test::seed());
    const core::Quat turn(test::randomRotation(random));
    const Distance cavity = [&](const Vec3& p) {
        const Vec3 q = (turn * p).cwiseAbs() - Vec3(0.6, 0.5, 0.7);
        return -(q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0));
    };
    const DistanceField field = fieldOf(cavity);
    SharpLookup sharp(field, core::simdLevel());
    const std::vector<Vec3> points = surfacePoints(cavity, random, 4000);
    const Errors told = errorsOf([&](const Vec3& p) { return sharp.distance(p); }, cavity, points);
    const Errors mixed = errorsOf([&](const Vec3& p) { return field.distance(p); }, cavity, points);
    EXPECT_LT(told.medianMm, 2e-6);
    EXPECT_LT(told.p99Mm, 0.6 * mixed.p99Mm);
}

TEST(SharpLookup, isTheSameToTheBitAtEveryInstructionSetAndFollowsAChange) {
    std::mt19937_64 random(test::seed());
    const Distance two = [](const Vec3& p) {
        return std::max((p - Vec3(0.3, 0, 0)).norm() - 0.9, p.z() + 0.1 * p.x());
    };
    DistanceField field = fieldOf(two);
    std::vector<SharpLookup> lookups;
    for (const core::SimdLevel level : {core::SimdLevel::base, core::SimdLevel::avx2, core::SimdLevel::avx512})
        if (level <= core::simdLevel()) lookups.emplace_back(field, level);
    const auto all = [&](const Vec3& p) {
        const double first = lookups.front().distance(p);
        for (SharpLookup& lookup : lookups) {
            const double d = lookup.distance(p);
            EXPECT_EQ(std::memcmp(&d, &first, sizeof d), 0) << p.transpose();
        }
        return first;
    };
    const Vec3 place(0.11, 0.07, -0.02);
    const double before = all(place);
    for (int i = 0; i < 4000; ++i)
        (void)all(
            {test::uniform(random, -1.7, 1.7), test::uniform(random, -1.7, 1.7), test::uniform(random, -1.7, 1.7)});
    // Eight at once, near one another and all over the field, as one by one.
    for (int i = 0; i < 1000; ++i) {
        const Vec3 middle(test::uniform(random, -1.6, 1.6), test::uniform(random, -1.6, 1.6),
                          test::uniform(random, -1.6, 1.6));
        const double spread = i % 3 == 0 ? 2.0 : i % 3 == 1 ? 0.1 : 0.01;
        std::vector<Vec3> places;
        for (int k = 0; k < 1 + i % 8; ++k)
            places.push_back(middle + spread * test::uniform(random, 0.0, 1.0) * test::randomDirection(random));
        for (SharpLookup& lookup : lookups) {
            std::vector<double> told(places.size());
            lookup.distances(places, told);
            for (std::size_t k = 0; k < places.size(); ++k)
                EXPECT_EQ(told[k], lookups.front().distance(places[k])) << places[k].transpose();
        }
        const Vec3 normal = lookups.front().normal(middle);
        for (SharpLookup& lookup : lookups)
            EXPECT_EQ(lookup.normal(middle), normal);
    }
    for (float& value : field.storage().values)
        value += 0.01f;
    ++field.storage().version;
    EXPECT_NEAR(all(place), before + 0.01, 1e-6);
}

}  // namespace
}  // namespace handpiece::field::sharp_lookup_test
