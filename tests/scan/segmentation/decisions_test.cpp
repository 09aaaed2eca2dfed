// SPDX-License-Identifier: Apache-2.0
// What a person decides: thresholds, marks, cut planes, lesions; and what cannot be done.
#include <gtest/gtest.h>

#include "handpiece/base/core/error.h"
#include "scan/segmentation/balls.h"
#include "support/random.h"

namespace handpiece::segmentation::decisions_test {
namespace {

using cases::Tissue;
using core::Vec3;
using test::solidOf;
using test::volumeOf;

const volume::Volume& scan() {
    static const volume::Volume v = test::scanOf(test::ballsGrey, {}, 1);
    return v;
}
const Region& plain() {
    static const Region region = segment(scan());
    return region;
}
std::string problemOf(const volume::Volume& v, const Settings& settings) {
    try {
        (void)segment(v, settings);
    } catch (const core::Error& e) {
        return e.what();
    }
    return "no error";
}

TEST(Decisions, AnAuthoredLesionIsCutOutOfEnamelAndDentineAndMarked) {
    Settings settings;
    // Half in the enamel, half in the dentine.
    settings.lesions = {{Vec3(0, 0, test::kDentineMm), Vec3(0.6, 0.5, 0.4)}};
    const Region region = segment(scan(), settings);
    const Solid* lesion = solidOf(region, Tissue::caries, true);
    ASSERT_NE(lesion, nullptr);
    const double mm3 = 4.0 / 3.0 * std::numbers::pi * 0.6 * 0.5 * 0.4;
    EXPECT_NEAR(volumeOf(region, Tissue::caries) / mm3, 1, 0.06);
    const double lostEnamel = volumeOf(plain(), Tissue::enamel) - volumeOf(region, Tissue::enamel);
    const double lostDentine = volumeOf(plain(), Tissue::dentine) - volumeOf(region, Tissue::dentine);
    EXPECT_NEAR((lostEnamel + lostDentine) / volumeOf(region, Tissue::caries), 1, 1e-4);
    EXPECT_GT(lostEnamel, 0.35 * mm3);
    EXPECT_GT(lostDentine, 0.35 * mm3);
    settings.lesions = {{Vec3(0, 0, 5.0), Vec3(0.3, 0.3, 0.3)}};
    const Region beside = segment(scan(), settings);
    EXPECT_EQ(solidOf(beside, Tissue::caries, true), nullptr);
    EXPECT_FALSE(beside.notes.empty());
}

TEST(Decisions, MarksPaintAndErase) {
    Settings settings;
    settings.marks = {{Vec3(0, 0, 2.1), 0.5, Tissue::caries},
                      {Vec3(2.1, 0, 0), 0.5, Tissue::pulp},
                      {Vec3(0, 4.0, 0), 0.6, Tissue::none}};
    const Region region = segment(scan(), settings);
    EXPECT_NEAR(volumeOf(region, Tissue::caries) / test::ballMm3(0.5), 1, 0.06);
    EXPECT_FALSE(solidOf(region, Tissue::caries)->isAuthored);
    EXPECT_NEAR((volumeOf(region, Tissue::pulp) - volumeOf(plain(), Tissue::pulp)) / test::ballMm3(0.5), 1, 0.06);
    // About half of the last ball lay in enamel.
    const double lost = volumeOf(plain(), Tissue::enamel) - volumeOf(region, Tissue::enamel);
    EXPECT_GT(lost, 0.4 * test::ballMm3(0.6));
    EXPECT_LT(lost, 0.6 * test::ballMm3(0.6));
    // The later one wins.
    settings.marks = {{Vec3(0, 0, 2.1), 0.5, Tissue::caries}, {Vec3(0, 0, 2.1), 0.6, Tissue::dentine}};
    EXPECT_LT(volumeOf(segment(scan(), settings), Tissue::caries), 0.01);
}

TEST(Decisions, ACutPlaneLeavesOutWhatLiesOnItsNormalsSide) {
    Settings settings;
    settings.cutPlanes = {{Vec3(0, 0, -2), Vec3(0, 0, -2)}};
    const Region region = segment(scan(), settings);
    double whole = 0;
    for (const double mm3 : volumesMm3(region))
        whole += mm3;
    const double cap = std::numbers::pi * 4 / 3 * (3 * test::kEnamelMm - 2);
    EXPECT_NEAR(whole / (test::ballMm3(test::kEnamelMm) - cap), 1, 0.02);
}

TEST(Decisions, GivenThresholdsAreUsed) {
    Settings settings;
    settings.thresholds = plain().thresholds;
    const Region same = segment(scan(), settings);
    EXPECT_NEAR(volumeOf(same, Tissue::enamel), volumeOf(plain(), Tissue::enamel), 0.5);
    settings.thresholds->dentine = settings.thresholds->toothFrom - 1;
    EXPECT_NE(problemOf(scan(), settings).find("not in order"), std::string::npos);
}

TEST(Decisions, WhatCannotBeDoneIsSaidOnce) {
    Settings mark, lesion, plane, place, spacing;
    mark.marks = {{Vec3(50, 0, 0), 1, Tissue::pulp}};
    EXPECT_NE(problemOf(scan(), mark).find("lies outside the scan"), std::string::npos);
    mark.marks = {{Vec3(0, 0, 0), 0, Tissue::pulp}};
    EXPECT_NE(problemOf(scan(), mark).find("no radius"), std::string::npos);
    lesion.lesions = {{Vec3(0, 0, 0), Vec3(1, 0, 1)}};
    EXPECT_NE(problemOf(scan(), lesion).find("no size"), std::string::npos);
    plane.cutPlanes = {{Vec3(0, 0, 0), Vec3(0, 0, 0)}};
    EXPECT_NE(problemOf(scan(), plane).find("no direction"), std::string::npos);
    place.toothAtMm = Vec3(0, 0, 100);
    EXPECT_NE(problemOf(scan(), place).find("lies outside the scan"), std::string::npos);
    spacing.spacingMm = -1;
    EXPECT_NE(problemOf(scan(), spacing).find("cannot be made"), std::string::npos);
    volume::Volume coarse = scan();
    coarse.grid.spacingMm = Vec3(1, 1, 2);
    EXPECT_NE(problemOf(coarse, {}).find("too coarse"), std::string::npos);
}

TEST(Decisions, ACutOffCrownIsAnErrorAndACutOffTipANote) {
    const auto cropped = [](double lowZ) {
        const volume::Volume& v = scan();
        volume::Volume part;
        part.grid = v.grid;
        const int from = static_cast<int>(std::lround((lowZ - v.grid.originMm.z()) / v.grid.spacingMm.z()));
        part.grid.size[2] -= from;
        part.grid.originMm.z() += from * v.grid.spacingMm.z();
        part.values.assign(v.values.begin() + static_cast<std::ptrdiff_t>(v.grid.index(0, 0, from)), v.values.end());
        return part;
    };
    EXPECT_NE(problemOf(cropped(-2.0), {}).find("cut off by the border"), std::string::npos);
    // A root (dentine) of which the last third of a millimetre is missing.
    const test::Greys g;
    const auto grey = [&](const Vec3& p) {
        const bool isRoot = p.z() < 0 && p.z() > -5 && std::hypot(p.x(), p.y()) < 1.2 && p.norm() > test::kDentineMm;
        return isRoot ? g.dentine : test::ballsGrey(p);
    };
    test::ScanSettings s;
    s.halfMm = {5, 5, 4.8};
    const Region region = segment(test::scanOf(grey, s, 1));
    bool isNoted = false;
    for (const std::string& note : region.notes)
        isNoted = isNoted || note.find("border") != std::string::npos;
    EXPECT_TRUE(isNoted);
}

}  // namespace
}  // namespace handpiece::segmentation::decisions_test
