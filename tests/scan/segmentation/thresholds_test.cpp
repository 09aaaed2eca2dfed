// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "handpiece/base/core/error.h"
#include "scan/segmentation/balls.h"
#include "support/random.h"

namespace handpiece::segmentation::thresholds_test {
namespace {

using test::Greys;

std::string problemOf(const std::function<void()>& action) {
    try {
        action();
    } catch (const core::Error& e) {
        return e.what();
    }
    return "no error";
}

volume::Volume filled(int size, const std::function<float()>& value) {
    volume::Volume v;
    v.grid.size = {size, size, size};
    v.grid.spacingMm = core::Vec3::Constant(0.2);
    v.values.resize(v.grid.count());
    for (float& x : v.values)
        x = value();
    return v;
}

TEST(Thresholds, PeaksAreFoundWithinTwoPercentOfTheStepThroughBlurAndNoise) {
    const Greys g;
    for (const double noise : {0.0, 0.03, 0.05}) {
        test::ScanSettings s;
        s.noise = noise;
        const Thresholds t = findThresholds(test::scanOf(test::ballsGrey, s, test::seed()));
        const float near = 0.02f * (g.enamel - g.outside);
        EXPECT_NEAR(t.outside, g.outside, near) << noise;
        EXPECT_NEAR(t.dentine, g.dentine, near) << noise;
        EXPECT_NEAR(t.enamel, g.enamel, near) << noise;
        EXPECT_NEAR(t.toothFrom, 0.5f * (g.outside + g.dentine), near) << noise;
        EXPECT_NEAR(t.enamelFrom, 0.5f * (g.dentine + g.enamel), near) << noise;
        EXPECT_TRUE(std::isinf(t.restorationFrom)) << noise;
    }
}

TEST(Thresholds, TheOutsideNeedNotBeTheDarkest) {
    const auto grey = [](const core::Vec3& p) {
        const double r = p.norm();
        return r < 1.6 ? 130.0f : (r < 3.0 ? 823.0f : (r < 4.0 ? 1187.0f : 396.0f));
    };
    const Thresholds t = findThresholds(test::scanOf(grey, {}, 1));
    EXPECT_NEAR(t.outside, 396, 15);
    EXPECT_NEAR(t.pulp, 130, 60);
    EXPECT_NEAR(t.dentine, 823, 15);
    EXPECT_NEAR(t.enamel, 1187, 15);
}

TEST(Thresholds, ScansWithoutAToothSaySo) {
    std::mt19937_64 generator(test::seed());
    std::normal_distribution<float> normal(0, 100);
    for (const auto& value :
         std::vector<std::function<float()>>{[] { return 5.0f; }, [&] { return -1000 + normal(generator); },
                                             [&] { return static_cast<float>(generator() % 1000); }}) {
        const volume::Volume v = filled(40, value);
        EXPECT_NE(problemOf([&] { (void)findThresholds(v); }).find("empty segmentation"), std::string::npos);
        EXPECT_NE(problemOf([&] { (void)segment(v); }).find("empty segmentation"), std::string::npos);
    }
    EXPECT_NE(problemOf([&] { (void)segment({}); }).find("no voxels"), std::string::npos);
}

TEST(Teeth, PlatesSpecksAndSkullsAreNone) {
    const auto isTooth = [](double x, double y, double z, double mm3) {
        Candidate c;
        c.boundsMm.extend(core::Vec3::Zero());
        c.boundsMm.extend(core::Vec3(x, y, z));
        c.volumeMm3 = mm3;
        return isToothLike(c);
    };
    EXPECT_TRUE(isTooth(11.7, 10.4, 20.7, 966));  // molar
    EXPECT_TRUE(isTooth(4.5, 4.0, 14.0, 100));    // milk incisor
    EXPECT_TRUE(isTooth(14, 14, 14, 560));        // canine across the axes
    EXPECT_TRUE(isTooth(10, 9, 8, 400));          // crown, cut off by the border
    EXPECT_FALSE(isTooth(12, 4, 2, 42));          // pieces of skull, out of a head's CT
    EXPECT_FALSE(isTooth(9, 7, 2, 32));
    EXPECT_FALSE(isTooth(30, 28, 25, 900));    // a curved plate
    EXPECT_FALSE(isTooth(90, 60, 40, 40000));  // a jaw
}

TEST(Teeth, TwoThatTouchArePartedAndEachCanBeChosen) {
    const Greys g;
    // Two that overlap by a tenth of a millimetre; the left one is larger.
    const core::Vec3 left(-3.4, 0, 0), right(3.4, 0, 0);
    const auto grey = [&](const core::Vec3& p) {
        const double a = (p - left).norm(), b = (p - right).norm();
        if (a < 2.6 || b < 2.4) return g.dentine;
        return a < 3.6 || b < 3.3 ? g.enamel : g.outside;
    };
    test::ScanSettings s;
    s.halfMm = {8, 4.6, 4.6};
    s.noise = 0.03;
    const volume::Volume v = test::scanOf(grey, s, test::seed());
    const std::vector<Candidate> teeth = findTeeth(v, findThresholds(v));
    ASSERT_EQ(teeth.size(), 2u);
    EXPECT_GT(teeth[0].volumeMm3, teeth[1].volumeMm3);
    EXPECT_LT((teeth[0].atMm - left).norm(), 2.0);
    EXPECT_LT((teeth[1].atMm - right).norm(), 2.0);
    EXPECT_FALSE(teeth[0].touchesBorder);
    for (const auto& [centre, radius] : {std::pair(left, 3.6), std::pair(right, 3.3)}) {
        Settings settings;
        settings.toothAtMm = centre;
        const Region region = segment(v, settings);
        double volume = 0;
        for (const double mm3 : volumesMm3(region))
            volume += mm3;
        EXPECT_NEAR(volume / test::ballMm3(radius), 1, 0.04);
        EXPECT_FALSE(region.notes.empty());
        // Nothing of the other one's far side.
        const core::Vec3 other = centre == left ? right : left;
        const core::Vec3 at = region.grid.toVoxels(other);
        const bool holdsOther = at.minCoeff() >= 0 && at.x() < region.grid.size[0] - 1;
        if (holdsOther) {
            EXPECT_GT(region.outer.distanceMm[region.grid.index(static_cast<int>(at.x()), static_cast<int>(at.y()),
                                                                static_cast<int>(at.z()))],
                      0);
        }
    }
    Settings nowhere;
    nowhere.toothAtMm = core::Vec3(0, 4.4, 4.4);
    EXPECT_NE(problemOf([&] { (void)segment(v, nowhere); }).find("there is no tooth at"), std::string::npos);
}

}  // namespace
}  // namespace handpiece::segmentation::thresholds_test
