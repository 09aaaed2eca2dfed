// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "handpiece/base/core/error.h"
#include "scan/segmentation/balls.h"

namespace handpiece::segmentation::labels_test {
namespace {

using cases::Tissue;
using core::Vec3;
using test::solidOf;
using test::volumeOf;

/// Balls with a carious cone and a canal that is open below; pulp is 0, as files have it.
volume::Labels ballLabels(double spacingMm) {
    volume::Labels labels;
    const int half = static_cast<int>(std::ceil(4.1 / spacingMm));
    labels.grid.size = {2 * half + 1, 2 * half + 1, 2 * half + 1};
    labels.grid.spacingMm = Vec3::Constant(spacingMm);
    labels.grid.originMm = Vec3::Constant(-half * spacingMm);
    labels.values.resize(labels.grid.count());
    for (int k = 0; k < labels.grid.size[2]; ++k)
        for (int j = 0; j < labels.grid.size[1]; ++j)
            for (int i = 0; i < labels.grid.size[0]; ++i) {
                const Vec3 p = labels.grid.toMm(Vec3(i, j, k));
                const double r = p.norm(), across = std::hypot(p.x(), p.y());
                std::uint8_t label = r < test::kDentineMm || p.z() < 0 ? 3 : 2;
                if (r < test::kPulpMm || (p.z() < 0 && across < 0.25) || r > test::kEnamelMm) label = 0;
                if (label != 0 && (p - Vec3(0, 2.2, 2.2)).norm() < 0.7) label = 1;
                labels.values[labels.grid.index(i, j, k)] = label;
            }
    return labels;
}

TEST(SegmentLabels, AreTakenAsTheyAreAndTheirOpenPulpIsFilled) {
    const volume::Labels labels = ballLabels(0.12);
    const Region region = segmentLabels(labels);
    std::array<double, 4> told{};
    for (const std::uint8_t label : labels.values)
        told.at(label) += labels.grid.voxelMm3();
    EXPECT_NEAR(volumeOf(region, Tissue::caries) / told[1], 1, 0.04);
    EXPECT_NEAR(volumeOf(region, Tissue::enamel) / told[2], 1, 0.01);
    EXPECT_NEAR(volumeOf(region, Tissue::dentine) / told[3], 1, 0.01);
    EXPECT_GT(volumeOf(region, Tissue::pulp), test::ballMm3(test::kPulpMm));
    // Every labelled voxel keeps its label at its centre.
    const volume::Labels back = labelsOf(region);
    std::size_t different = 0;
    for (int k = 0; k < labels.grid.size[2]; ++k)
        for (int j = 0; j < labels.grid.size[1]; ++j)
            for (int i = 0; i < labels.grid.size[0]; ++i) {
                const std::uint8_t label = labels.values[labels.grid.index(i, j, k)];
                const Vec3 at = back.grid.toVoxels(labels.grid.toMm(Vec3(i, j, k)));
                const std::uint8_t found = back.values[back.grid.index(static_cast<int>(std::lround(at.x())),
                                                                       static_cast<int>(std::lround(at.y())),
                                                                       static_cast<int>(std::lround(at.z())))];
                if (label != 0 && found != label) ++different;
            }
    EXPECT_EQ(different, 0u);
    // And no staircase is left: the ball's surface is nearer to its sphere than voxels are.
    const std::vector<double> errors = test::errorsFromBall(region.grid, region.outer.distanceMm, test::kEnamelMm,
                                                            [](const Vec3& p) { return p.z() > 0.5; });
    EXPECT_LT(test::share(errors, 0.5), 0.2);
    EXPECT_LT(errors.back(), 1.0);
}

TEST(SegmentLabels, ACoarserSpacingKeepsTheVolumes) {
    const Region region = segmentLabels(ballLabels(0.06), [] {
        Settings settings;
        settings.spacingMm = 0.15;
        return settings;
    }());
    EXPECT_DOUBLE_EQ(region.grid.spacingMm.x(), 0.15);
    const double shell = 0.5 * (test::ballMm3(test::kEnamelMm) - test::ballMm3(test::kDentineMm));
    EXPECT_NEAR(volumeOf(region, Tissue::enamel) / shell, 1, 0.03);
}

TEST(SegmentLabels, NothingOfAToothIsAnError) {
    volume::Labels labels = ballLabels(0.3);
    for (std::uint8_t& label : labels.values)
        label = label != 0 ? 6 : 0;
    EXPECT_THROW((void)segmentLabels(labels), core::Error);
    EXPECT_THROW((void)segmentLabels({}), core::Error);
    labels.grid.spacingMm = Vec3::Constant(1.0);
    EXPECT_THROW((void)segmentLabels(labels), core::Error);
}

}  // namespace
}  // namespace handpiece::segmentation::labels_test
