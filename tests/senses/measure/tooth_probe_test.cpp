// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/measure/tooth_probe.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "handpiece/base/core/error.h"
#include "support/closed_meshes.h"
#include "support/cut_support.h"
#include "support/random.h"

namespace handpiece::measure::tooth_probe_test {
namespace {

using cases::Tissue;
using core::Vec3;

constexpr double kVoxel = 0.05;
constexpr double kOuter = 2.0, kDentine = 1.5, kPulp = 0.6;  // balls in one another

/// A tooth of a mesh, with a ball of dentine and one of pulp in it.
std::shared_ptr<const tooth::ToothModel> toothOf(const geometry::TriangleMesh& mesh, bool withPulp = true) {
    cases::Case made;
    made.name = "closed form";
    made.outer = mesh;
    tooth::LoadSettings settings;
    settings.useCache = false;
    settings.field.voxelMm = kVoxel;
    auto uncut = tooth::loadModel(made, settings);
    std::vector<field::TissueMap::PartFunction> parts{
        {[](const Vec3& p) { return p.norm() - kDentine; }, Tissue::dentine, 1}};
    if (withPulp) parts.push_back({[](const Vec3& p) { return p.norm() - kPulp; }, Tissue::pulp, 2});
    field::TissueMap tissues = field::TissueMap::fromFunctions(uncut->field, parts, Tissue::enamel);
    return tooth::withTissues(*uncut, std::move(tissues));
}

/// A cavity from above: a cylinder of radius 0.5 about z with a round end whose lowest point is at `floorMm`.
double boring(const Vec3& p, double floorMm) {
    const Vec3 centre(0, 0, floorMm + 0.5);
    const double z = std::max(0.0, p.z() - centre.z());
    return (p - centre - Vec3(0, 0, z)).norm() - 0.5;
}

std::optional<double> meetsByBruteForce(const geometry::TriangleMesh& mesh, const Vec3& o, const Vec3& d) {
    std::optional<double> first;
    for (const auto& t : mesh.triangles) {
        const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
        // The plane, then the side of each edge.
        const Vec3 n = (b - a).cross(c - a);
        if (std::abs(n.dot(d)) < 1e-14) continue;
        const double at = n.dot(a - o) / n.dot(d);
        const Vec3 p = o + at * d;
        const bool inside =
            n.dot((b - a).cross(p - a)) >= 0 && n.dot((c - b).cross(p - b)) >= 0 && n.dot((a - c).cross(p - c)) >= 0;
        if (at >= 0 && inside && (!first || at < *first)) first = at;
    }
    return first;
}

/// A step at a time.
std::optional<double> zeroByMarching(const ToothProbe& probe, const Vec3& o, const Vec3& d, double far) {
    constexpr double kStep = 0.0005;
    const bool inside = probe.signedDistanceMm(o) < 0;
    for (double t = kStep; t < far; t += kStep)
        if ((probe.signedDistanceMm(o + t * d) < 0) != inside) return t - 0.5 * kStep;
    return {};
}

class Bored : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        base_ = toothOf(test::sphereMesh(5, kOuter));
        field_ = std::make_unique<tooth::ToothState>(base_);
        tooth::in_test::cutAway(*field_, [](const Vec3& p) { return boring(p, kFloor); });
        mirror_ = std::make_unique<tooth::ToothMirror>(base_);
        mirror_->apply(field_->state());
        uncut_ = std::make_unique<tooth::ToothMirror>(base_);
    }
    static void TearDownTestSuite() {
        mirror_.reset();
        uncut_.reset();
        field_.reset();
        base_.reset();
    }
    static constexpr double kFloor = 0.9;
    static inline std::shared_ptr<const tooth::ToothModel> base_;
    static inline std::unique_ptr<tooth::ToothState> field_;
    static inline std::unique_ptr<tooth::ToothMirror> mirror_, uncut_;
};

TEST_F(Bored, aLineOfSightEndsAtTheFloor) {
    const ToothProbe probe(*mirror_);
    const auto hit = probe.cast(Vec3(0, 0, 10), -Vec3::UnitZ());
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->pointMm.z(), kFloor, 0.002);
    EXPECT_NEAR(hit->distanceMm, 10 - kFloor, 0.002);
    EXPECT_GT(hit->normal.z(), 0.999);
    EXPECT_EQ(hit->tissue, Tissue::dentine);
    EXPECT_TRUE(hit->cut);
    // Its wall, from inside the cavity.
    const auto wall = probe.cast(Vec3(0, 0, 1.7), Vec3::UnitX());
    ASSERT_TRUE(wall);
    EXPECT_NEAR(wall->pointMm.x(), 0.5, 0.002);
    EXPECT_LT(wall->normal.x(), -0.99);
    EXPECT_EQ(wall->tissue, Tissue::enamel);
    EXPECT_TRUE(wall->cut);
    // Beside it all is as it was.
    const auto side = probe.cast(Vec3(10, 0, 0.3), -Vec3::UnitX());
    ASSERT_TRUE(side);
    EXPECT_NEAR(side->pointMm.norm(), kOuter, 0.003);
    EXPECT_GT(side->normal.dot(side->pointMm.normalized()), 0.999);
    EXPECT_FALSE(side->cut);
    EXPECT_EQ(side->tissue, Tissue::enamel);
    // The tooth before the cut is still there for those who ask.
    const auto before = probe.castUncut(Vec3(0.01, 0.02, 10), -Vec3::UnitZ());
    ASSERT_TRUE(before);
    EXPECT_NEAR(before->pointMm.norm(), kOuter, 0.003);
    EXPECT_FALSE(before->cut);
    EXPECT_FALSE(probe.cast(Vec3(0, 0, 10), Vec3::UnitZ()));
    EXPECT_FALSE(probe.cast(Vec3(0, 0, 10), -Vec3::UnitZ(), 5.0));
    EXPECT_FALSE(probe.cast(Vec3(5, 0, 10), -Vec3::UnitZ()));
    EXPECT_FALSE(probe.castUncut(Vec3(5, 0, 10), -Vec3::UnitZ()));
}

TEST_F(Bored, aCastFindsTheFirstZeroThatMarchingFinds) {
    std::mt19937_64 random(test::seed());
    for (const tooth::ToothMirror* mirror : {mirror_.get(), uncut_.get()}) {
        const ToothProbe probe(*mirror);
        int hits = 0;
        for (int i = 0; i < 150; ++i) {
            // From outside, from in the cavity, from inside the tooth.
            const Vec3 o = i % 3 == 0   ? Vec3(5 * test::randomDirection(random))
                           : i % 3 == 1 ? Vec3(0.3 * test::randomDirection(random) + Vec3(0, 0, 1.6))
                                        : Vec3(test::uniform(random, 0, 1.9) * test::randomDirection(random));
            const Vec3 target = test::uniform(random, 0, 2) * test::randomDirection(random);
            const Vec3 d = (target - o).normalized();
            const auto marched = zeroByMarching(probe, o, d, 9.0);
            const auto hit = probe.cast(o, d, 9.0);
            // A glance shorter than a step is seen by the cast alone.
            if (!marched && hit) {
                EXPECT_LT(std::abs(hit->normal.dot(d)), 0.1);
                continue;
            }
            ASSERT_EQ(hit.has_value(), marched.has_value()) << i;
            if (!hit) continue;
            ++hits;
            if (hit->distanceMm < *marched - 0.01 * kVoxel)
                EXPECT_LT(std::abs(hit->normal.dot(d)), 0.1) << i;
            else
                EXPECT_NEAR(hit->distanceMm, *marched, 0.01 * kVoxel) << i;
        }
        EXPECT_GT(hits, 100);
    }
}

TEST(ToothProbe, castsMeetTheTrianglesThatBruteForceMeets) {
    const geometry::TriangleMesh mesh = test::bumpyMesh(4, 2.0);
    const auto base = toothOf(mesh);
    const tooth::ToothMirror mirror(base);
    const ToothProbe probe(mirror);
    std::mt19937_64 random(test::seed());
    int hits = 0, compared = 0;
    double worst = 0.0;
    for (int i = 0; i < 600; ++i) {
        const Vec3 o = (i % 2 == 0 ? 6.0 : 1.0) * test::randomDirection(random);
        Vec3 d = test::randomDirection(random);
        if (i % 4 == 0) d = (2.0 * test::randomDirection(random) - o).normalized();
        if (i % 7 == 0) d = -o.cwiseAbs().maxCoeff() * Vec3::UnitZ() / o.cwiseAbs().maxCoeff();
        const auto brute = meetsByBruteForce(mesh, o, d);
        const auto exact = probe.castUncut(o, d);
        ASSERT_EQ(exact.has_value(), brute.has_value()) << i;
        if (!brute) continue;
        ++hits;
        EXPECT_NEAR(exact->distanceMm, *brute, 1e-9);
        const auto cast = probe.cast(o, d);
        // The field rounds a glance off.
        if (!cast || std::abs(exact->normal.dot(d)) < 0.3 || std::abs(cast->distanceMm - *brute) > 1.0) continue;
        ++compared;
        worst = std::max(worst, std::abs(cast->distanceMm - *brute));
    }
    std::printf("  %d rays met, %d compared, the field off by %.2f um at worst\n", hits, compared, 1e3 * worst);
    EXPECT_GT(hits, 200);
    EXPECT_GT(compared, 150);
    EXPECT_LT(worst, 0.4 * kVoxel);
}

TEST(ToothProbe, noRayThroughAnEdgeOrACornerSlipsThrough) {
    const geometry::TriangleMesh mesh = test::sphereMesh(3, 2.0, Vec3(0.1, -0.2, 0.3));
    const geometry::TriangleTree tree(mesh);
    std::mt19937_64 random(test::seed());
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 &a = mesh.vertices[t[k]], &b = mesh.vertices[t[(k + 1) % 3]];
            for (const double s : {0.0, 0.5, 0.37}) {
                const Vec3 target = a + s * (b - a), o = 8.0 * test::randomDirection(random);
                const geometry::RayMeeting met = tree.firstMeeting(o, (target - o).normalized());
                ASSERT_NE(met.triangle, geometry::kNoTriangle);
                EXPECT_LE(met.distanceMm, (target - o).norm() + 1e-9);
            }
        }
    EXPECT_EQ(tree.firstMeeting(Vec3(9, 0, 0), Vec3::UnitX()).triangle, geometry::kNoTriangle);
    EXPECT_EQ(tree.firstMeeting(Vec3(9, 0, 0), -Vec3::UnitX(), 3.0).triangle, geometry::kNoTriangle);
}

TEST_F(Bored, tissuesAndDistancesAreThoseOfTheCutTooth) {
    const ToothProbe probe(*mirror_);
    std::mt19937_64 random(test::seed());
    for (int i = 0; i < 3000; ++i) {
        const Vec3 p = test::uniform(random, 0, 2.6) * test::randomDirection(random);
        const double solid = p.norm() - kOuter, truth = std::max(solid, -boring(p, kFloor));
        const double read = probe.signedDistanceMm(p);
        if (std::abs(truth) > 0.01) {
            EXPECT_EQ(read < 0, truth < 0) << p.transpose();
            EXPECT_LE(std::abs(read), std::abs(truth) + 0.01) << p.transpose();
            EXPECT_GT(std::abs(read), std::min(0.005, std::abs(truth) - 0.01)) << p.transpose();
        }
        if (std::abs(truth) < 0.01 || std::abs(p.norm() - kDentine) < 0.01 || std::abs(p.norm() - kPulp) < 0.01)
            continue;
        const Tissue expected = truth > 0             ? Tissue::none
                                : p.norm() < kPulp    ? Tissue::pulp
                                : p.norm() < kDentine ? Tissue::dentine
                                                      : Tissue::enamel;
        EXPECT_EQ(probe.tissueAt(p), expected) << p.transpose();
    }
    EXPECT_EQ(probe.tissueAt(Vec3(50, 0, 0)), Tissue::none);
    EXPECT_GT(probe.signedDistanceMm(Vec3(50, 0, 0)), 40.0);
}

TEST_F(Bored, depthsAreToTheSurfaceBeforeTheCut) {
    const ToothProbe probe(*mirror_);
    const Vec3 floor(0.02, 0.01, kFloor);
    EXPECT_NEAR(probe.depthBelowUncutMm(floor), kOuter - floor.norm(), 0.003);
    EXPECT_NEAR(probe.depthBelowUncutMm(Vec3(0, 3, 0)), -1.0, 0.003);
    const auto along = probe.depthAlongMm(Vec3(0.3, 0.01, kFloor), Vec3::UnitZ());
    ASSERT_TRUE(along);
    EXPECT_NEAR(*along, std::sqrt(4 - 0.09 - 0.0001) - kFloor, 0.003);
    EXPECT_EQ(probe.depthAlongMm(Vec3(0, 0, 2.5), Vec3::UnitZ()), 0.0);
    EXPECT_FALSE(probe.depthAlongMm(floor, Vec3::Zero()));

    std::vector<std::array<float, 3>> vertices{
        {0.0f, 0.0f, static_cast<float>(kFloor)}, {0.5f, 0.0f, 1.6f}, {2.0f, 0.0f, 0.0f}, {0.0f, 3.0f, 0.0f}};
    const std::vector<float> depths = probe.removedDepths(vertices);
    ASSERT_EQ(depths.size(), 4u);
    EXPECT_NEAR(depths[0], kOuter - kFloor, 0.003);
    EXPECT_NEAR(depths[1], kOuter - std::hypot(0.5, 1.6), 0.003);
    EXPECT_EQ(depths[2], 0.0f);
    EXPECT_EQ(depths[3], 0.0f);
}

TEST_F(Bored, dentineOverThePulpIsTheWayToIt) {
    const ToothProbe probe(*mirror_);
    std::mt19937_64 random(test::seed());
    double worst = 0.0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3 p = test::uniform(random, 0.0, 2.0) * test::randomDirection(random);
        const auto left = probe.leftOverPulpMm(p);
        ASSERT_TRUE(left);
        worst = std::max(worst, std::abs(*left - std::max(0.0, p.norm() - kPulp)));
    }
    std::printf("  off by %.1f um at worst\n", 1e3 * worst);
    EXPECT_LT(worst, 0.5 * kVoxel);
    const auto thinnest = probe.thinnestOverPulp();
    ASSERT_TRUE(thinnest);
    EXPECT_NEAR(thinnest->leftMm, kFloor - kPulp, 0.5 * kVoxel);
    EXPECT_NEAR((thinnest->pointMm - Vec3(0, 0, kFloor)).norm(), 0.0, 0.12);
    EXPECT_FALSE(ToothProbe(*uncut_).thinnestOverPulp());
}

TEST(ToothProbe, anOpenedPulpHasNothingOverIt) {
    const auto base = toothOf(test::sphereMesh(4, kOuter));
    tooth::ToothState field(base);
    tooth::in_test::cutAway(field, [](const Vec3& p) { return boring(p, 0.3); });
    tooth::ToothMirror mirror(base);
    mirror.apply(field.state());
    const auto thinnest = ToothProbe(mirror).thinnestOverPulp();
    ASSERT_TRUE(thinnest);
    EXPECT_EQ(thinnest->leftMm, 0.0);
}

TEST(ToothProbe, aToothWithoutPulpHasNoneToSpare) {
    const auto base = toothOf(test::sphereMesh(3, kOuter), false);
    const tooth::ToothMirror mirror(base);
    const ToothProbe probe(mirror);
    EXPECT_FALSE(probe.leftOverPulpMm(Vec3(0, 0, 1)));
    EXPECT_FALSE(probe.thinnestOverPulp());
}

TEST_F(Bored, aSectionShowsTheTissuesInTheirPlaces) {
    const ToothProbe probe(*mirror_);
    for (const Vec3& normal : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 2, -0.5)}) {
        const double mm = 0.02, offset = 0.2;
        const Section s = probe.section(normal, offset * normal.norm(), mm);
        const Vec3 n = normal.normalized();
        EXPECT_NEAR((s.uAxis.cross(s.vAxis) - n).norm(), 0.0, 1e-12);
        EXPECT_NEAR(s.originMm.dot(n), offset, 1e-12);
        ASSERT_EQ(s.tissue.size(), static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.height));
        std::array<double, cases::kTissueCount> area{}, expected{};
        for (int j = 0; j < s.height; ++j)
            for (int i = 0; i < s.width; ++i) {
                const Vec3 p = s.originMm + mm * (i * s.uAxis + j * s.vAxis);
                area[s.tissue[static_cast<std::size_t>(j * s.width + i)]] += mm * mm;
                const bool gone = p.norm() > kOuter || boring(p, kFloor) < 0;
                const Tissue t = gone                  ? Tissue::none
                                 : p.norm() < kPulp    ? Tissue::pulp
                                 : p.norm() < kDentine ? Tissue::dentine
                                                       : Tissue::enamel;
                expected[static_cast<std::size_t>(t)] += mm * mm;
            }
        for (const Tissue t : {Tissue::enamel, Tissue::dentine, Tissue::pulp}) {
            const auto k = static_cast<std::size_t>(t);
            EXPECT_GT(expected[k], 0.5);
            EXPECT_NEAR(area[k], expected[k], 0.01 * expected[k]) << k;
        }
        // Without the cavity it would be rings of circles.
        EXPECT_NEAR(expected[static_cast<std::size_t>(Tissue::pulp)], M_PI * (kPulp * kPulp - offset * offset), 0.02);
    }
    EXPECT_GT(probe.section(Vec3::UnitX(), 0).vAxis.z(), 0.99);
}

TEST_F(Bored, aSectionTellsWhereBetweenItsPixelsTissuesMeet) {
    const ToothProbe probe(*mirror_);
    const double mm = 0.05;
    for (const Vec3& normal : {Vec3(1, 0, 0), Vec3(1, 2, -0.5)}) {
        const Section s = probe.section(normal, 0.2 * normal.norm(), mm);
        ASSERT_EQ(s.away.size(), s.tissue.size());
        std::size_t met = 0, far = 0;
        for (int j = 0; j + 1 < s.height; ++j)
            for (int i = 0; i + 1 < s.width; ++i)
                for (const bool isUp : {false, true}) {
                    const auto a = static_cast<std::size_t>(j * s.width + i);
                    const std::size_t b = isUp ? a + static_cast<std::size_t>(s.width) : a + 1;
                    if (s.tissue[a] == s.tissue[b]) continue;
                    const Vec3 p = s.originMm + mm * (i * s.uAxis + j * s.vAxis), way = isUp ? s.vAxis : s.uAxis;
                    const double one = s.away[a][0], two = s.away[b][0], t = one / (one + two);
                    const double radius = (p + t * mm * way).norm();
                    const double off = std::min({std::abs(radius - kOuter), std::abs(radius - kDentine),
                                                 std::abs(radius - kPulp), std::abs(boring(p + t * mm * way, kFloor))});
                    ++met;
                    // A tenth of a pixel; where the boring's edge cuts a corner off, less well.
                    if (off > 0.1 * mm) ++far;
                    EXPECT_LT(off, 0.6 * mm);
                    EXPECT_EQ(s.away[a][1] == 255 && s.tissue[b] == 0, false);
                }
        EXPECT_GT(met, 200u);
        EXPECT_LT(far, met / 25);
    }
}

TEST_F(Bored, whatMakesNoSenseIsRefused) {
    const ToothProbe probe(*mirror_);
    EXPECT_THROW((void)probe.section(Vec3::Zero(), 0.0), core::Error);
    EXPECT_THROW((void)probe.section(Vec3(std::nan(""), 0, 1), 0.0), core::Error);
    EXPECT_THROW((void)probe.section(Vec3::UnitX(), std::nan("")), core::Error);
    EXPECT_THROW((void)probe.section(Vec3::UnitX(), 0, 0.0), core::Error);
    EXPECT_THROW((void)probe.section(Vec3::UnitX(), 0, 1e-6), core::Error);
    EXPECT_FALSE(probe.cast(Vec3(0, 0, 9), Vec3::Zero()));
    EXPECT_FALSE(probe.cast(Vec3(0, std::nan(""), 9), -Vec3::UnitZ()));
    EXPECT_FALSE(probe.castUncut(Vec3(0, 0, 9), Vec3(0, 0, -2)));
}

}  // namespace
}  // namespace handpiece::measure::tooth_probe_test
