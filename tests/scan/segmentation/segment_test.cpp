// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/segmentation/segment.h"

#include <gtest/gtest.h>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "scan/segmentation/balls.h"
#include "support/random.h"

namespace handpiece::segmentation::segment_test {
namespace {

using cases::Tissue;
using test::errorsFromBall;
using test::share;
using test::solidOf;
using test::volumeOf;

struct Imaging {
    double blurVoxels, noise, volumeShare;  ///< off by this share at most
};
class Balls : public testing::TestWithParam<Imaging> {};

TEST_P(Balls, SurfacesLieWithinAQuarterVoxelAndVolumesAreKept) {
    test::ScanSettings s;
    s.blurVoxels = GetParam().blurVoxels;
    s.noise = GetParam().noise;
    const Region region = segment(test::scanOf(test::ballsGrey, s, test::seed()));
    const Solid* dentine = solidOf(region, Tissue::dentine);
    const Solid* pulp = solidOf(region, Tissue::pulp);
    ASSERT_TRUE(dentine != nullptr && pulp != nullptr);
    EXPECT_EQ(solidOf(region, Tissue::caries), nullptr);
    for (const auto& [distances, radius] :
         {std::pair(&region.outer.distanceMm, test::kEnamelMm), std::pair(&dentine->distanceMm, test::kDentineMm),
          std::pair(&pulp->distanceMm, test::kPulpMm)}) {
        const std::vector<double> errors = errorsFromBall(region.grid, *distances, radius);
        EXPECT_LT(share(errors, 0.5), 0.25) << radius;
        EXPECT_LT(share(errors, 0.95), 0.8) << radius;
        EXPECT_LT(errors.back(), 2.0) << radius;
    }
    using test::ballMm3;
    const double pulpMm3 = ballMm3(test::kPulpMm), dentineMm3 = ballMm3(test::kDentineMm) - pulpMm3;
    const double enamelMm3 = ballMm3(test::kEnamelMm) - ballMm3(test::kDentineMm);
    EXPECT_NEAR(volumeOf(region, Tissue::enamel) / enamelMm3, 1, GetParam().volumeShare);
    EXPECT_NEAR(volumeOf(region, Tissue::dentine) / dentineMm3, 1, GetParam().volumeShare);
    EXPECT_NEAR(volumeOf(region, Tissue::pulp) / pulpMm3, 1, 0.05);
    EXPECT_NEAR(region.blurMm / s.spacingMm, GetParam().blurVoxels, 0.2);
}
INSTANTIATE_TEST_SUITE_P(BlurAndNoise, Balls,
                         testing::Values(Imaging{0.5, 0.0, 0.02}, Imaging{1.0, 0.0, 0.02}, Imaging{1.5, 0.0, 0.05},
                                         Imaging{0.7, 0.03, 0.02}, Imaging{1.0, 0.05, 0.02}));

TEST(Segment, NoSkinOfDentineLiesOnEnamelAndNoneOfEnamelOnDentine) {
    test::ScanSettings s;
    s.noise = 0.03;
    const Region region = segment(test::scanOf(test::cappedGrey, s, test::seed()));
    const Solid* dentine = solidOf(region, Tissue::dentine);
    ASSERT_NE(dentine, nullptr);
    int skin = 0, cap = 0, edge = 0;
    for (int k = 0; k < region.grid.size[2]; ++k)
        for (int j = 0; j < region.grid.size[1]; ++j)
            for (int i = 0; i < region.grid.size[0]; ++i) {
                const std::size_t at = region.grid.index(i, j, k);
                if (region.outer.distanceMm[at] >= 0) continue;
                const core::Vec3 p = region.grid.toMm(core::Vec3(i, j, k));
                const bool isEnamel = dentine->distanceMm[at] >= 0;
                // Where the cap is more than three voxels thick or one voxel away from any.
                if (p.z() > 2.5 && p.norm() > 3.5 && !isEnamel) ++skin;
                if (p.z() < -1.2 && isEnamel) ++cap;
                ++edge;
            }
    EXPECT_EQ(skin, 0);
    EXPECT_EQ(cap, 0);
    EXPECT_GT(edge, 10000);
    // Its edge runs out to nothing: what is thinner than a voxel is partly lost.
    // The cap is what of one ball lies outside another: a lens taken off. V = pi (R + r - d)^2 (...) / 12 d, R = r.
    const double R = test::kEnamelMm, d = 1.0;
    const double lens = std::numbers::pi * (2 * R - d) * (2 * R - d) * (d * d + 4 * d * R) / (12 * d);
    EXPECT_NEAR(volumeOf(region, Tissue::enamel) / (test::ballMm3(R) - lens), 1, 0.08);
}

TEST(Segment, SolidsAreNestedClampedAndDistances) {
    const Region region = segment(test::scanOf(test::ballsGrey, {}, 1));
    const double h = region.grid.spacingMm.x();
    EXPECT_DOUBLE_EQ(h, 0.2);
    const Solid &dentine = *solidOf(region, Tissue::dentine), &pulp = *solidOf(region, Tissue::pulp);
    double worst = 0;
    for (std::size_t n = 0; n < region.grid.count(); ++n) {
        EXPECT_GE(dentine.distanceMm[n], region.outer.distanceMm[n]);
        EXPECT_GE(pulp.distanceMm[n], dentine.distanceMm[n]);
        EXPECT_LE(std::abs(region.outer.distanceMm[n]), 3.0001 * h);
    }
    // At least three voxels of margin, and a slope of one beside the surface.
    for (int k = 0; k < region.grid.size[2]; ++k)
        for (int j = 0; j < region.grid.size[1]; ++j)
            for (int i = 0; i < region.grid.size[0]; ++i) {
                const float distance = region.outer.distanceMm[region.grid.index(i, j, k)];
                const bool isMargin = std::min({i, j, k}) < 3 || i + 3 >= region.grid.size[0] ||
                                      j + 3 >= region.grid.size[1] || k + 3 >= region.grid.size[2];
                if (isMargin) {
                    ASSERT_GT(distance, 0);
                }
                const double truth = region.grid.toMm(core::Vec3(i, j, k)).norm() - test::kEnamelMm;
                if (std::abs(truth) < 2 * h) worst = std::max(worst, std::abs(truth - static_cast<double>(distance)));
            }
    EXPECT_LT(worst, 0.5 * h);
    const volume::Labels labels = labelsOf(region);
    const core::Vec3 centre = region.grid.toVoxels(core::Vec3::Zero());
    const auto at = [&](double x) {
        return labels.values[region.grid.index(static_cast<int>(std::lround(centre.x() + x / h)),
                                               static_cast<int>(std::lround(centre.y())),
                                               static_cast<int>(std::lround(centre.z())))];
    };
    EXPECT_EQ(at(0), 4);
    EXPECT_EQ(at(2), 3);
    EXPECT_EQ(at(3.5), 2);
    EXPECT_EQ(at(4.5), 0);
}

TEST(Segment, APulpOpenAtTheApexIsClosedAndFilled) {
    const test::Greys g;
    const auto grey = [&](const core::Vec3& p) {
        const double r = p.norm(), across = std::hypot(p.x(), p.y());
        if (r < test::kPulpMm || (p.z() < 0 && across < 0.3)) return g.outside;  // dried out: as dark as the air
        return p.z() > 0 ? test::ballsGrey(p) : (r < test::kEnamelMm ? g.dentine : g.outside);
    };
    test::ScanSettings s;
    s.noise = 0.03;
    s.spacingMm = 0.15;
    const Region region = segment(test::scanOf(grey, s, test::seed()));
    const Solid* pulp = solidOf(region, Tissue::pulp);
    ASSERT_NE(pulp, nullptr);
    const double canal = std::numbers::pi * 0.09 * (test::kEnamelMm - test::kPulpMm);
    EXPECT_NEAR(volumeOf(region, Tissue::pulp) / (test::ballMm3(test::kPulpMm) + canal), 1, 0.08);
    double whole = 0;
    for (const double mm3 : volumesMm3(region))
        whole += mm3;
    EXPECT_NEAR(whole / test::ballMm3(test::kEnamelMm), 1, 0.02);
}

TEST(Segment, AnisotropicAndCoarserSpacingsGiveTheSameTooth) {
    volume::Volume v = test::scanOf(test::ballsGrey, {}, 1);
    // Every second slice left out.
    volume::Volume sparse;
    sparse.grid = v.grid;
    sparse.grid.size[2] = v.grid.size[2] / 2;
    sparse.grid.spacingMm.z() *= 2;
    for (int k = 0; k < sparse.grid.size[2]; ++k)
        sparse.values.insert(
            sparse.values.end(), v.values.begin() + static_cast<std::ptrdiff_t>(v.grid.index(0, 0, 2 * k)),
            v.values.begin() + static_cast<std::ptrdiff_t>(v.grid.index(0, 0, 2 * k) + v.grid.index(0, 0, 1)));
    const Region region = segment(sparse);
    EXPECT_DOUBLE_EQ(region.grid.spacingMm.z(), 0.2);
    EXPECT_NEAR(volumeOf(region, Tissue::enamel) / (test::ballMm3(4) - test::ballMm3(3)), 1, 0.05);
    Settings coarser;
    coarser.spacingMm = 0.3;
    const Region coarse = segment(v, coarser);
    EXPECT_DOUBLE_EQ(coarse.grid.spacingMm.x(), 0.3);
    EXPECT_NEAR(volumeOf(coarse, Tissue::enamel) / (test::ballMm3(4) - test::ballMm3(3)), 1, 0.05);
}

TEST(Segment, TheSameBytesAtAnyThreadCountAndCancelled) {
    test::ScanSettings s;
    s.noise = 0.05;
    const volume::Volume v = test::scanOf(test::ballsGrey, s, test::seed());
    core::setThreadCount(1);
    const Region one = segment(v);
    core::setThreadCount(0);
    const Region many = segment(v);
    EXPECT_EQ(one.outer.distanceMm, many.outer.distanceMm);
    ASSERT_EQ(one.solids.size(), many.solids.size());
    for (std::size_t n = 0; n < one.solids.size(); ++n)
        EXPECT_EQ(one.solids[n].distanceMm, many.solids[n].distanceMm);
    for (const double limit : {0.0, 0.3, 0.7})
        EXPECT_THROW((void)segment(v, {}, [&](double done) { return done < limit; }), core::Error) << limit;
}

}  // namespace
}  // namespace handpiece::segmentation::segment_test
