// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/sampled/surface_sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <limits>
#include <map>
#include <numbers>
#include <vector>

#include "tick/contact/contact_fixture.h"

namespace handpiece::contact::surface_sampler_test {
namespace {

using core::Vec3;

/// A wavy ground of one tissue or of two side by side.
const field::DistanceField& ground(bool twoTissues) {
    const auto make = [](bool two) {
        field::FieldSettings settings;
        // Slopes of 0.8 in x and 0.6 in y at most: the factor makes the function 1-Lipschitz.
        const auto distance = [](const Vec3& p) {
            return 0.7 * (p.z() - 0.2 * std::sin(4.0 * p.x()) - 0.2 * std::sin(3.0 * p.y()));
        };
        const auto tissue = [two](const Vec3& p) {
            return two && p.x() > 0.1 ? cases::Tissue::dentine : cases::Tissue::enamel;
        };
        return field::DistanceField::fromFunction({{-7, -7, -3}, {7, 7, 6}}, settings, distance, tissue);
    };
    static const field::DistanceField one = make(false), two = make(true);
    return twoTissues ? two : one;
}

core::Pose randomPose(std::mt19937_64& generator) {
    core::Pose pose;
    const Vec3 axis(test::uniform(generator, -1, 1), test::uniform(generator, -1, 1), 0.0);
    pose.orientation = core::Quat(Eigen::AngleAxisd(test::uniform(generator, 0.0, 1.5), axis.normalized())) *
                       core::Quat(Eigen::AngleAxisd(test::uniform(generator, 0.0, 6.0), Vec3::UnitZ()));
    pose.positionMm = Vec3(test::uniform(generator, -1.5, 1.5), test::uniform(generator, -1.5, 1.5),
                           test::uniform(generator, -1.2, 0.6));
    return pose;
}

struct Point {
    Vec3 placeMm;
    double areaMm2, gapMm;
    std::size_t ring, patch;
    double from, to;  ///< its share of the turn
};

/// Signed distance as the rings are to have it: mixed in the cell, and between the nodes where walls meet in it. Not a
/// number where it is a matter of rounding whether they do.
double gapOf(const field::DistanceField& field, field::SharpLookup& lookup, const Vec3& p) {
    const double mixed = field.distance(p), voxel = field.settings().voxelMm;
    if (mixed >= 0.1 * voxel || mixed <= -0.4 * voxel) return mixed;
    const field::FieldView view = field.view();
    double v[2][2][2], t[3];
    Vec3 first;
    for (int k = 0; k < 3; ++k) {
        const double g = (p[k] - view.originMm[k]) / voxel;
        first[k] = view.originMm[k] + std::floor(g) * voxel;
        t[k] = g - std::floor(g);
    }
    for (int i = 0; i < 8; ++i)
        v[i & 1][i >> 1 & 1][i >> 2] = field.distance(first + voxel * Vec3(i & 1, i >> 1 & 1, i >> 2));
    double twist = 0.0;
    Vec3 slope = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        double low = 1e9, high = -1e9;
        for (int i = 0; i < 4; ++i) {
            int at[3] = {0, 0, 0};
            at[a] = i & 1;
            at[b] = i >> 1;
            const double from = v[at[0]][at[1]][at[2]];
            at[k] = 1;
            const double rise = (v[at[0]][at[1]][at[2]] - from) / voxel;
            low = std::min(low, rise);
            high = std::max(high, rise);
            slope[k] += rise * (at[a] == 1 ? t[a] : 1.0 - t[a]) * (at[b] == 1 ? t[b] : 1.0 - t[b]);
        }
        twist = std::max(twist, high - low);
    }
    if (std::abs(slope.norm() - 0.995) < 1e-4 || std::abs(twist - 0.25) < 1e-4) return std::nan("");
    return slope.norm() < 0.995 || twist > 0.25 ? lookup.distance(p) : mixed;
}

/// Every point of the rings looked up alone; patches by flooding from neighbour to neighbour.
std::vector<Point> touching(const field::DistanceField& field, const instrument::Bur& bur, const core::Pose& pose) {
    std::vector<Point> points;
    for (std::size_t i = 0; i < bur.rings().size(); ++i) {
        const instrument::SurfaceRing& ring = bur.rings()[i];
        for (std::uint32_t j = 0; j < ring.count; ++j) {
            const double turn = 1.0 / ring.count, angle = 2.0 * std::numbers::pi * (j + 0.5) * turn;
            const Vec3 p = pose.apply({ring.rhoMm * std::cos(angle), ring.rhoMm * std::sin(angle), ring.zMm});
            double gap = field.distance(p);
            if (!field.isFine(p)) {  // a bound, of a point beyond the band
                if (!std::signbit(gap)) continue;
                gap = std::min(gap, -field.settings().bandInMm);
            }
            if (!(gap > kContactMarginMm)) points.push_back({p, ring.areaMm2, gap, i, 0, j * turn, (j + 1) * turn});
        }
    }
    std::size_t patches = 0;
    for (Point& start : points) {
        if (start.patch != 0) continue;
        start.patch = ++patches;
        std::vector<Point*> open{&start};
        while (!open.empty()) {
            const Point& at = *open.back();
            open.pop_back();
            for (Point& other : points) {
                if (other.patch != 0) continue;
                const bool beside = other.ring == at.ring && [&] {
                    const double apart = std::abs(other.from - at.from), turn = at.to - at.from;
                    return std::min(apart, 1.0 - apart) < 1.5 * turn;
                }();
                const bool over = (other.ring == at.ring + 1 || other.ring + 1 == at.ring) &&
                                  other.from < at.to - 1e-12 && at.from < other.to - 1e-12;
                if (!beside && !over) continue;
                other.patch = patches;
                open.push_back(&other);
            }
        }
    }
    return points;
}

class SurfaceSamplerOf : public testing::TestWithParam<const char*> {};

TEST_P(SurfaceSamplerOf, patchesAreThoseOfEveryPointLookedUpAlone) {
    const instrument::Bur bur = instrument::makeBur(GetParam());
    std::mt19937_64 generator(test::seed());
    int compared = 0, severalPatches = 0;
    for (const bool two : {false, true}) {
        const field::DistanceField& field = ground(two);
        KnownSurface surface(field, bur, core::simdLevel());
        SurfaceSampler sensor(surface, bur, core::simdLevel());
        for (int n = 0; n < 60; ++n) {
            const core::Pose pose = randomPose(generator);
            const std::vector<Point> points = touching(field, bur, pose);
            // Which side of the margin a point within a nanometre of it falls on is a matter of rounding.
            if (std::any_of(points.begin(), points.end(),
                            [](const Point& p) { return !(p.gapMm <= kContactMarginMm - 1e-6); }))
                continue;
            PatchSet found;
            sensor.patches(pose, found);
            double pressure = 0.0, area = 0.0;
            std::map<std::size_t, double> areas, pressures, deepest;
            std::map<std::size_t, Vec3> centres;
            std::array<double, cases::kTissueCount> tissues{};
            for (const Point& p : points) {
                const double w = p.areaMm2 * (kContactMarginMm - p.gapMm);
                area += p.areaMm2;
                pressure += w;
                areas[p.patch] += p.areaMm2;
                pressures[p.patch] += w;
                deepest[p.patch] = std::max(deepest[p.patch], -p.gapMm);
                centres.try_emplace(p.patch, Vec3::Zero()).first->second += w * p.placeMm;
                tissues[static_cast<std::size_t>(field.tissueAt(p.placeMm))] += w;
            }
            ASSERT_NEAR(found.areaMm2, area, 1e-5) << n;
            if (areas.size() > kMaxPatches) continue;
            ASSERT_EQ(found.patches.size(), areas.size()) << n;
            std::vector<std::pair<double, std::size_t>> order;
            for (const auto& [patch, share] : pressures)
                order.emplace_back(-share, patch);
            std::sort(order.begin(), order.end());
            for (std::size_t k = 0; k < order.size(); ++k) {
                const std::size_t patch = order[k].second;
                const Patch& p = found.patches[k];
                EXPECT_NEAR(p.pressureShare, pressures[patch] / pressure, 1e-4);
                if (pressures[patch] < 0.01 * pressure) continue;  // near equals may change places
                EXPECT_NEAR(p.areaMm2, areas[patch], 1e-5);
                EXPECT_NEAR(p.maxDepthMm, deepest[patch], 1e-4);
                EXPECT_LE((p.centreMm - centres[patch] / pressures[patch]).norm(), 1e-4);
                EXPECT_NEAR(p.normal.norm(), 1.0, 1e-9);
            }
            for (std::size_t t = 0; t < cases::kTissueCount && pressure > 0.0; ++t)
                EXPECT_NEAR(found.tissueShare[t], tissues[t] / pressure, 1e-3) << t;
            ++compared;
            severalPatches += areas.size() > 1 ? 1 : 0;
        }
    }
    EXPECT_GT(compared, 60);
    if (bur.lengthMm() > 2.0) {
        EXPECT_GT(severalPatches, 0);
    }
}

TEST_P(SurfaceSamplerOf, constraintsHoldTheNearestPointAndTellTheFieldsGaps) {
    const instrument::Bur bur = instrument::makeBur(GetParam());
    const field::DistanceField& field = ground(false);
    KnownSurface surface(field, bur, core::simdLevel());
    SurfaceSampler sensor(surface, bur, core::simdLevel());
    std::mt19937_64 generator(test::seed());
    int compared = 0;
    field::SharpLookup lookup(field, core::SimdLevel::base);
    for (int n = 0; n < 80; ++n) {
        const core::Pose pose = randomPose(generator);
        double nearest = std::numeric_limits<double>::infinity();
        for (const instrument::SurfaceRing& ring : bur.rings())
            for (std::uint32_t j = 0; j < ring.count; ++j) {
                const double angle = 2.0 * std::numbers::pi * (j + 0.5) / ring.count;
                const Vec3 p = pose.apply({ring.rhoMm * std::cos(angle), ring.rhoMm * std::sin(angle), ring.zMm});
                if (field.isFine(p)) nearest = std::min(nearest, gapOf(field, lookup, p));
            }
        ConstraintSet found;
        ASSERT_NE(sensor.constraints(pose, 0.05, found), Status::invalidPose);
        if (!(nearest < 0.05 - 1e-6)) continue;
        ASSERT_FALSE(found.empty());
        EXPECT_NEAR(found[0].gapMm, nearest, 1e-6);
        for (const Constraint& c : found) {
            const double gap = gapOf(field, lookup, c.pointMm);
            EXPECT_FALSE(std::abs(c.gapMm - gap) > 1e-5) << c.gapMm << " " << gap;
            EXPECT_LE(c.gapMm, 0.05 + 1e-6);
            EXPECT_GT(c.normal.dot(field.normal(c.pointMm)), 0.9);
        }
        ++compared;
    }
    EXPECT_GT(compared, 30);
}

INSTANTIATE_TEST_SUITE_P(Burs, SurfaceSamplerOf, testing::Values("paper", "cylinder-flat:1.0x4.0", "round:1.4x1.3"));

/// z <= 0, enamel; dentine for x > 0 when `twoTissues`.
field::DistanceField halfSpace(bool twoTissues) {
    return field::DistanceField::fromFunction(
        {{-2, -2, -1.5}, {2, 2, 0.3}}, {}, [](const Vec3& p) { return p.z(); },
        [twoTissues](const Vec3& p) {
            return twoTissues && p.x() > 0.0 ? cases::Tissue::dentine : cases::Tissue::enamel;
        });
}
core::Pose uprightAt(const Vec3& tip) {
    return {tip, core::Quat::Identity()};
}
constexpr auto kEnamel = static_cast<std::size_t>(cases::Tissue::enamel),
               kDentine = static_cast<std::size_t>(cases::Tissue::dentine);
constexpr double kPi = std::numbers::pi;

TEST(Bearing, aFlatEndBearsOnAPlaneWithItsWholeArea) {
    const field::DistanceField field = halfSpace(false);
    for (const double radius : {0.5, 0.6}) {
        const instrument::Bur bur("flat", instrument::makeProfile(instrument::Shape::cylinderFlat, 2.0 * radius, 4.0));
        KnownSurface surface(field, bur, core::simdLevel());
        SurfaceSampler sensor(surface, bur, core::simdLevel());
        for (const double floorMm : {0.05, 0.15, 0.3}) {
            Bearing b;
            sensor.bearing(uprightAt({0.01, 0.02, 0.0}), -Vec3::UnitZ(), 0.0, floorMm, b);
            EXPECT_EQ(b.status, Status::ok);
            EXPECT_NEAR(b.areaMm2[kEnamel], kPi * radius * radius, 0.003 * kPi * radius * radius);
            // The integral of 2 pi rho / max(rho, floor).
            const double resistance = 2.0 * kPi * (radius - floorMm) + kPi * floorMm;
            EXPECT_NEAR(b.resistanceMm[kEnamel], resistance, 0.01 * resistance);
            EXPECT_LE(b.tangentMm[kEnamel].norm(), 1e-4);  // all round: nothing is left
            EXPECT_EQ(b.areaMm2[kDentine], 0.0);
        }
        Bearing away;
        sensor.bearing(uprightAt({0.01, 0.02, 0.0}), Vec3::UnitZ(), 0.0, 0.1, away);
        EXPECT_EQ(away.areaMm2[kEnamel], 0.0);
    }
}

TEST(Bearing, fallsToNothingOverTheMarginAndCountsTheLead) {
    const field::DistanceField field = halfSpace(false);
    const instrument::Bur bur = instrument::makeBur("cylinder-flat:1.0x4.0");
    KnownSurface surface(field, bur, core::simdLevel());
    SurfaceSampler sensor(surface, bur, core::simdLevel());
    const double whole = kPi * 0.25;
    const auto areaAt = [&](double gapMm, double leadMm) {
        Bearing b;
        sensor.bearing(uprightAt({0.0, 0.0, gapMm}), -Vec3::UnitZ(), leadMm, 0.1, b);
        return b.areaMm2[kEnamel];
    };
    EXPECT_NEAR(areaAt(0.25 * kContactMarginMm, 0.0), 0.75 * whole, 0.004 * whole);
    EXPECT_NEAR(areaAt(0.75 * kContactMarginMm, 0.0), 0.25 * whole, 0.004 * whole);
    EXPECT_EQ(areaAt(1.1 * kContactMarginMm, 0.0), 0.0);
    EXPECT_NEAR(areaAt(1.1 * kContactMarginMm, 0.6 * kContactMarginMm), 0.5 * whole, 0.004 * whole);
    EXPECT_NEAR(areaAt(1.1 * kContactMarginMm, 2.0 * kContactMarginMm), whole, 0.004 * whole);
    EXPECT_NEAR(areaAt(-0.05, 0.0), whole, 0.004 * whole);
}

TEST(Bearing, eachTissueBearsItsShare) {
    const field::DistanceField field = halfSpace(true);
    const instrument::Bur bur = instrument::makeBur("cylinder-flat:1.0x4.0");
    KnownSurface surface(field, bur, core::simdLevel());
    SurfaceSampler sensor(surface, bur, core::simdLevel());
    Bearing b;
    sensor.bearing(uprightAt({0.025, 0.0, 0.0}), -Vec3::UnitZ(), 0.0, 0.1, b);
    EXPECT_NEAR(b.areaMm2[kEnamel] + b.areaMm2[kDentine], kPi * 0.25, 0.003);
    // Dentine begins half a voxel before x = 0, at the nodes' boundary.
    EXPECT_NEAR(b.areaMm2[kEnamel], b.areaMm2[kDentine], 0.12);
    // Clockwise seen down the shank: on the +x side points move along -y.
    EXPECT_LT(b.tangentMm[kDentine].y(), -0.1);
    EXPECT_GT(b.tangentMm[kEnamel].y(), 0.1);
}

TEST(Bearing, aRoundBurPressedIntoAPlaneBearsLikeACap) {
    const field::DistanceField field = halfSpace(false);
    constexpr double kRadius = 0.7, kDepth = 0.2, kFloor = 0.05;
    const instrument::Bur bur = instrument::makeBur("cylinder-round:1.4x4.0");
    KnownSurface surface(field, bur, core::simdLevel());
    SurfaceSampler sensor(surface, bur, core::simdLevel());
    Bearing b;
    sensor.bearing(uprightAt({0.0, 0.0, -kDepth}), -Vec3::UnitZ(), 0.0, kFloor, b);
    // Sums over polar angle: area c dA with weight 1 in the tooth and a linear fall over the margin.
    double area = 0.0, resistance = 0.0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
        const double polar = 0.5 * kPi * (i + 0.5) / kSteps, c = std::cos(polar), rho = kRadius * std::sin(polar);
        const double gap = kRadius * (1.0 - c) - kDepth;
        const double w = std::clamp(1.0 - gap / kContactMarginMm, 0.0, 1.0);
        const double band = 2.0 * kPi * rho * kRadius * 0.5 * kPi / kSteps;
        area += band * w * c;
        resistance += band * w * c * c / std::max(rho, kFloor);
    }
    EXPECT_NEAR(b.areaMm2[kEnamel], area, 0.03 * area);
    EXPECT_NEAR(b.resistanceMm[kEnamel], resistance, 0.03 * resistance);
}

TEST(Bearing, theSideOfACylinderInAHalfRoundGroove) {
    constexpr double kRadius = 0.5, kLength = 2.0;
    // A groove along y of the bur's own radius, half as deep as it is wide.
    const field::DistanceField field = field::DistanceField::fromFunction(
        {{-1.5, -4, -1.5}, {1.5, 4, 0.3}}, {},
        [](const Vec3& p) { return std::max(p.z(), kRadius - std::hypot(p.x(), p.z())); });
    const instrument::Bur bur("flat", instrument::makeProfile(instrument::Shape::cylinderFlat, 2.0 * kRadius, kLength));
    KnownSurface surface(field, bur, core::simdLevel());
    SurfaceSampler sensor(surface, bur, core::simdLevel());
    core::Pose pose;
    pose.orientation = core::rotationBetween(Vec3::UnitZ(), Vec3::UnitY());
    Bearing b;
    sensor.bearing(pose, -Vec3::UnitZ(), 0.0, 0.05, b);
    // c = cos(angle) over the half turn: integrals of r L c and of L c^2; a margin's width of side above the edge.
    EXPECT_NEAR(b.areaMm2[kEnamel], 2.0 * kRadius * kLength, 0.02 * 2.0 * kRadius * kLength);
    EXPECT_NEAR(b.resistanceMm[kEnamel], 0.5 * kPi * kLength, 0.02 * 0.5 * kPi * kLength);
    // The bur turns about -y: its lowest points move along (-y) x (-z) = +x.
    EXPECT_NEAR(b.tangentMm[kEnamel].x(), 0.5 * kPi * kLength, 0.02 * 0.5 * kPi * kLength);
    EXPECT_NEAR(b.tangentMm[kEnamel].y(), 0.0, 1e-3);
}

TEST(Bearing, aPoseThatIsNoNumberIsSaid) {
    const field::DistanceField field = halfSpace(false);
    const instrument::Bur bur = instrument::makeBur("paper");
    KnownSurface surface(field, bur, core::simdLevel());
    SurfaceSampler sensor(surface, bur, core::simdLevel());
    Bearing b;
    sensor.bearing(uprightAt({std::numeric_limits<double>::quiet_NaN(), 0, 0}), -Vec3::UnitZ(), 0.0, 0.1, b);
    EXPECT_EQ(b.status, Status::invalidPose);
    EXPECT_EQ(b.areaMm2[kEnamel], 0.0);
}

TEST(SurfaceSampler, everyInstructionSetGivesTheSameBits) {
    const instrument::Bur bur = instrument::makeBur("paper");
    std::deque<KnownSurface> surfaces;
    std::vector<SurfaceSampler> sensors;
    for (const core::SimdLevel level : {core::SimdLevel::base, core::SimdLevel::avx2, core::SimdLevel::avx512})
        if (level <= core::simdLevel())
            sensors.emplace_back(surfaces.emplace_back(ground(true), bur, level), bur, level);
    if (sensors.size() < 2) GTEST_SKIP() << "this processor runs the base level alone";
    std::mt19937_64 generator(test::seed());
    const auto isSame = [](const Vec3& a, const Vec3& b) { return std::memcmp(a.data(), b.data(), sizeof a) == 0; };
    for (int n = 0; n < 200; ++n) {
        const core::Pose pose = randomPose(generator);
        PatchSet first, other;
        ConstraintSet firstWalls, otherWalls;
        sensors[0].patches(pose, first);
        (void)sensors[0].constraints(pose, 0.08, firstWalls);
        Bearing firstBearing, otherBearing;
        const Vec3 push = test::randomDirection(generator);
        sensors[0].bearing(pose, push, 0.02, 0.1, firstBearing);
        for (std::size_t s = 1; s < sensors.size(); ++s) {
            sensors[s].bearing(pose, push, 0.02, 0.1, otherBearing);
            EXPECT_EQ(firstBearing.areaMm2, otherBearing.areaMm2);
            EXPECT_EQ(firstBearing.resistanceMm, otherBearing.resistanceMm);
            for (std::size_t t = 0; t < cases::kTissueCount; ++t)
                EXPECT_TRUE(isSame(firstBearing.tangentMm[t], otherBearing.tangentMm[t]));
            sensors[s].patches(pose, other);
            (void)sensors[s].constraints(pose, 0.08, otherWalls);
            ASSERT_EQ(first.patches.size(), other.patches.size());
            EXPECT_EQ(first.areaMm2, other.areaMm2);
            EXPECT_EQ(first.tissueShare, other.tissueShare);
            for (std::size_t k = 0; k < first.patches.size(); ++k) {
                EXPECT_TRUE(isSame(first.patches[k].centreMm, other.patches[k].centreMm));
                EXPECT_TRUE(isSame(first.patches[k].normal, other.patches[k].normal));
                EXPECT_EQ(first.patches[k].maxDepthMm, other.patches[k].maxDepthMm);
            }
            ASSERT_EQ(firstWalls.size(), otherWalls.size());
            for (std::size_t k = 0; k < firstWalls.size(); ++k) {
                EXPECT_TRUE(isSame(firstWalls[k].normal, otherWalls[k].normal));
                EXPECT_TRUE(isSame(firstWalls[k].pointMm, otherWalls[k].pointMm));
                EXPECT_EQ(firstWalls[k].gapMm, otherWalls[k].gapMm);
            }
        }
    }
}

}  // namespace
}  // namespace handpiece::contact::surface_sampler_test
