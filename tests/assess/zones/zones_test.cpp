// SPDX-License-Identifier: Apache-2.0
// Zones of a target, and volumes by zone, against closed forms and sampling.
#include "handpiece/assess/zones/zones.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <numeric>

#include "handpiece/assess/zones/cavity.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/rotation.h"
#include "support/cut_support.h"
#include "support/error_of.h"

namespace handpiece::zones::zones_test {
namespace {

using core::Vec2;
using core::Vec3;
using tooth::in_test::cut;

/// A block of dentine under a layer of enamel 1 mm thick; its top is at z = 0.
std::shared_ptr<const tooth::ToothModel> block(double voxelMm) {
    field::FieldSettings field;
    field.voxelMm = voxelMm;
    field.bandInMm = 0.3;
    const Vec3 half(5.0, 3.5, 2.5);
    const auto box = [half](const Vec3& p) {
        const Vec3 d = (p + Vec3(0, 0, half.z())).cwiseAbs() - half;
        return d.cwiseMax(0.0).norm() + std::min(d.maxCoeff(), 0.0);
    };
    auto tooth = tooth::in_test::toothOf(
        field::DistanceField::fromFunction({Vec3(-5.4, -3.9, -5.4), Vec3(5.4, 3.9, 0.4)}, field, box));
    const field::TissueMap::PartFunction dentine{[](const Vec3& p) { return p.z() + 1.0; }, cases::Tissue::dentine, 1};
    return tooth::withTissues(
        *tooth, field::TissueMap::fromFunctions(tooth->field, std::span(&dentine, 1), cases::Tissue::enamel));
}

/// A groove with round ends, `half` wide to each side, from -2.5 to 2.5 along x, turned by an angle that no voxel
/// follows.
Cavity groove(double half, double depth, double wallRad = 0.0) {
    Cavity cavity;
    cavity.inTooth.orientation = core::rotationAbout(Vec3::UnitZ(), 0.3);
    cavity.outline.strokes = {{{Vec2(-2.5, 0.0), Vec2(2.5, 0.0)}, half}};
    cavity.floor = {Floor::Kind::flat, -depth, 0.0};
    cavity.wallRad = wallRad;
    return cavity;
}
double areaOf(double half) {
    return 10.0 * half + std::numbers::pi * half * half;
}
Zones zonesOf(const Cavity& cavity, const Leeway& leeway, geometry::ScalarFunction kept = {}) {
    return {targetOf({cavity}, nullptr), boundsOf({cavity}, 6.0), leeway, std::move(kept)};
}
double distanceTo(const Cavity& cavity, const Vec3& p) {
    return targetOf({cavity}, nullptr)(p).distanceMm();
}
double sumOf(const ZoneVolumes& volumes) {
    double sum = 0.0;
    for (const tooth::TissueVolumes& zone : volumes.removed)
        sum += std::accumulate(zone.begin(), zone.end(), 0.0);
    return sum;
}

class VolumesByZone : public testing::TestWithParam<double> {};

TEST_P(VolumesByZone, AreThoseOfTheClosedForm) {
    const auto model = block(GetParam());
    const Cavity target = groove(0.6, 1.5);
    const Zones zones = zonesOf(target, {0.2, 0.25});

    const double whole = areaOf(0.6) * 1.5;
    {  // As asked: all of the target and nothing else.
        const ZoneVolumes v = zoneVolumes(zones, cut(model, [&](const Vec3& p) { return distanceTo(target, p); }));
        EXPECT_NEAR(v.targetMm3(), whole, 0.005 * whole);
        EXPECT_NEAR(v.removedMm3(Zone::target), v.targetMm3(), 0.005 * whole);
        EXPECT_LT(sumOf(v) - v.removedMm3(Zone::target), 0.003 * whole);
        const double enamel = v.removed[0][static_cast<std::size_t>(cases::Tissue::enamel)];
        EXPECT_NEAR(enamel, areaOf(0.6) * 1.0, areaOf(0.6) * 0.51 * GetParam()) << "a node is of one tissue";
    }
    {  // The ideal, as the product makes it, is that very cut.
        const tooth::StateDelta ideal = idealState(zones, model);
        tooth::ToothState by(model);
        tooth::in_test::cutAway(by, [&](const Vec3& p) { return distanceTo(target, p); });
        EXPECT_EQ(tooth::stateHash(ideal), by.stateHash());
        EXPECT_NEAR(tooth::sumOf(ideal.removedMm3.own), whole, 0.005 * whole);
    }
    {  // Wider by less than the leeway, deeper by more.
        const Cavity larger = groove(0.7, 2.0);
        const tooth::ToothMirror mirror = cut(model, [&](const Vec3& p) { return distanceTo(larger, p); });
        const ZoneVolumes v = zoneVolumes(zones, mirror);
        const double sides = (areaOf(0.7) - areaOf(0.6)) * 1.75, floor = areaOf(0.6) * 0.25, below = areaOf(0.7) * 0.25,
                     all = areaOf(0.7) * 2.0;
        // The corner of the leeway is round: nothing of it lies so far out in this cut.
        EXPECT_NEAR(v.removedMm3(Zone::leewaySide), sides, 0.005 * all);
        EXPECT_NEAR(v.removedMm3(Zone::leewayFloor), floor, 0.005 * all);
        EXPECT_NEAR(v.removedMm3(Zone::container), below, 0.005 * all);
        EXPECT_NEAR(v.removedMm3(Zone::target), whole, 0.005 * all);
        const double beside = (areaOf(0.8) - areaOf(0.6)) * 1.75;
        EXPECT_NEAR(tooth::sumOf(v.whole[1]), beside, 0.005 * beside) << "that there is of the leeway at the sides";
        EXPECT_NEAR(tooth::sumOf(v.whole[2]), floor, 0.01 * floor) << "and under the floor";
        const tooth::TissueVolumes left = tooth::integrateVolumes(*model, [&](std::uint32_t dense) -> const float* {
            static thread_local std::array<float, field::kBrickValues> scratch;
            return mirror.isChanged(dense) ? mirror.values(dense, scratch.data()) : nullptr;
        });
        const double gone = std::accumulate(model->volumesMm3.begin(), model->volumesMm3.end(), 0.0) -
                            std::accumulate(left.begin(), left.end(), 0.0);
        EXPECT_NEAR(sumOf(v), gone, 1e-6 * all) << "what is gone is in exactly one zone";
    }
    {  // Too little.
        const Cavity less = groove(0.5, 1.2);
        const ZoneVolumes v = zoneVolumes(zones, cut(model, [&](const Vec3& p) { return distanceTo(less, p); }));
        EXPECT_NEAR(v.targetMm3() - v.removedMm3(Zone::target), whole - areaOf(0.5) * 1.2, 0.005 * whole);
    }
    {  // Into what is protected, which lies in the target too.
        const auto kept = [](const Vec3& p) { return (p - Vec3(0.0, 0.0, -1.5)).norm() - 0.5; };
        const Zones guarded = zonesOf(target, {0.2, 0.25}, kept);
        const ZoneVolumes v = zoneVolumes(guarded, cut(model, [&](const Vec3& p) { return distanceTo(target, p); }));
        const double half = 2.0 / 3.0 * std::numbers::pi * 0.125;
        EXPECT_NEAR(v.removedMm3(Zone::protectedZone), half, 0.05 * half);
        EXPECT_NEAR(v.targetMm3(), whole - half, 0.005 * whole);
    }
}
INSTANTIATE_TEST_SUITE_P(At, VolumesByZone, testing::Values(0.05, 0.1),
                         [](const auto& at) { return fmt::format("{}um", std::lround(1000 * at.param)); });

TEST(Zones, SayWhereAPlaceLies) {
    const Zones zones = zonesOf(groove(0.6, 1.5), {0.2, 0.25}, [](const Vec3& p) { return p.z() + 4.0; });
    EXPECT_EQ(zones.at({0, 0, -1.0}), Zone::target);
    EXPECT_EQ(zones.at({0, 0, -1.6}), Zone::leewayFloor);
    EXPECT_EQ(zones.at({0, 0, -1.8}), Zone::container);
    EXPECT_EQ(zones.at({0, 0, -4.1}), Zone::protectedZone);
    const Vec3 across = core::rotationAbout(Vec3::UnitZ(), 0.3) * Vec3(0.0, 0.7, -1.0);
    EXPECT_EQ(zones.at(across), Zone::leewaySide);
    EXPECT_EQ(zones.at(across * 1.3), Zone::container);
}

TEST(Cavity, WallsLeanAsTheySay) {
    for (const double deg : {-6.0, 0.0, 8.0}) {
        const double rad = deg * std::numbers::pi / 180.0;
        const TargetFunction target = targetOf({groove(0.8, 2.0, rad)}, nullptr);
        const Vec3 across = core::rotationAbout(Vec3::UnitZ(), 0.3) * Vec3::UnitY();
        for (const double over : {0.3, 1.0, 1.9}) {
            const double half = 0.8 + over * core::tan(rad);
            EXPECT_NEAR(target(half * across - (2.0 - over) * Vec3::UnitZ()).wallMm, 0.0, 1e-12);
            EXPECT_NEAR(target((half + 0.1) * across - (2.0 - over) * Vec3::UnitZ()).wallMm, 0.1 * core::cos(rad),
                        1e-12);
        }
    }
}

TEST(Cavity, BadOnesAreRefused) {
    EXPECT_NE(test::errorOf([] { (void)targetOf({}, nullptr); }), "");
    EXPECT_NE(test::errorOf([] { (void)targetOf({Cavity{}}, nullptr); }), "");
    Cavity following = groove(0.5, 1.0);
    following.floor.kind = Floor::Kind::along;
    EXPECT_NE(test::errorOf([&] { (void)targetOf({following}, nullptr); }), "");
    EXPECT_NE(test::errorOf([] { (void)zonesOf(groove(0.5, 1.0), {-0.1, 0.0}); }), "");
}

TEST(Outline, DistancesAgreeWithSampling) {
    std::mt19937_64 random(test::seed(5));
    Outline outline;
    outline.strokes = {{{Vec2(0, 0), Vec2(3, 1), Vec2(4, -1)}, 0.5}, {{Vec2(-2, 2)}, 0.8}};
    outline.areas = {circle(Vec2(-3, -2), 1.5), arc(Vec2(3, -3), 1.0, -0.5 * std::numbers::pi, 0.5 * std::numbers::pi)};
    outline.holes = {circle(Vec2(-3, -2), 0.6)};
    const auto isIn = [](const Vec2& p) {
        const auto near = [&](const Vec2& a, const Vec2& b, double r) {
            for (int i = 0; i <= 4000; ++i)
                if ((a + (b - a) * (i / 4000.0) - p).norm() < r) return true;
            return false;
        };
        const double ring = (p - Vec2(-3, -2)).norm();
        if (ring < 0.6) return false;
        return near({0, 0}, {3, 1}, 0.5) || near({3, 1}, {4, -1}, 0.5) || (p - Vec2(-2, 2)).norm() < 0.8 ||
               ring < 1.5 || ((p - Vec2(3, -3)).norm() < 1.0 && p.x() > 3.0);
    };
    int asked = 0;
    for (int i = 0; i < 4000; ++i) {
        const Vec2 p(test::uniform(random, -5, 5), test::uniform(random, -5, 4));
        const double d = outline.distanceMm(p);
        if (std::abs(d) < 2e-3) continue;  // chords of the circles
        EXPECT_EQ(d < 0.0, isIn(p)) << p.transpose() << " " << d;
        ++asked;
    }
    EXPECT_GT(asked, 3900);
    EXPECT_NEAR(outline.distanceMm({-2, 4}), 1.2, 1e-12);
    const auto [low, high] = outline.bounds();
    EXPECT_NEAR(low.x(), -4.5, 1e-2);
    EXPECT_NEAR(high.x(), 4.5, 1e-12);
}

TEST(Outline, HullHoldsItsPoints) {
    std::mt19937_64 random(test::seed(9));
    std::vector<Vec2> points;
    for (int i = 0; i < 200; ++i)
        points.emplace_back(test::uniform(random, -3, 3), test::uniform(random, -1, 1));
    Outline outline;
    outline.areas = {convexOutline(points)};
    for (const Vec2& p : points)
        EXPECT_LE(outline.distanceMm(p), 1e-12);
    for (const Vec2& corner : outline.areas.front())
        EXPECT_NE(std::find(points.begin(), points.end(), corner), points.end());
}

}  // namespace
}  // namespace handpiece::zones::zones_test
