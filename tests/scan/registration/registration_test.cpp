// SPDX-License-Identifier: Apache-2.0
// Teeth whose frame is known, turned any way; crowns registered from any start; one surface put over another.
#include "handpiece/scan/registration/registration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <numbers>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/decimate.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/case/case_check.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/scan/registration/make_case.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::registration::registration_test {
namespace {

using core::Pose;
using core::Vec3;
using geometry::TriangleMesh;
using starter::ToothKind;
using test::errorOf;
using ::testing::HasSubstr;

/// A starter tooth as surfaces from a scan would be.
const surfacing::Surfaces& surfacesOf(ToothKind kind) {
    static std::map<ToothKind, surfacing::Surfaces> made;
    surfacing::Surfaces& s = made[kind];
    if (!s.outer.mesh.triangles.empty()) return s;
    starter::ToothOptions options;
    options.faces = 20000;
    cases::Case toothCase = starter::makeTooth(kind, options);
    s.outer.mesh = std::move(toothCase.outer);
    for (cases::Part& part : toothCase.parts)
        if (part.tissue != cases::Tissue::enamel) s.tissues.push_back({part.tissue, std::move(part.mesh), 0.0, false});
    return s;
}

surfacing::Surfaces moved(surfacing::Surfaces s, const Pose& pose) {
    s.outer.mesh = geometry::transformed(std::move(s.outer.mesh), pose);
    for (surfacing::Surface& t : s.tissues)
        t.mesh = geometry::transformed(std::move(t.mesh), pose);
    return s;
}

Pose randomPose(std::mt19937_64& generator) {
    return {40.0 * test::randomDirection(generator), test::randomRotation(generator)};
}

double degrees(const Vec3& a, const Vec3& b) {
    return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

/// The part of a mesh where `keep` holds for all corners.
template <class Keep>
TriangleMesh clipped(const TriangleMesh& mesh, const Keep& keep) {
    TriangleMesh out;
    std::vector<std::uint32_t> number(mesh.vertices.size(), 0xffffffffu);
    for (const geometry::Triangle& t : mesh.triangles) {
        if (!keep(mesh.vertices[t[0]]) || !keep(mesh.vertices[t[1]]) || !keep(mesh.vertices[t[2]])) continue;
        geometry::Triangle made{};
        for (std::size_t k = 0; k < 3; ++k) {
            std::uint32_t& n = number[t[k]];
            if (n == 0xffffffffu) {
                n = static_cast<std::uint32_t>(out.vertices.size());
                out.vertices.push_back(mesh.vertices[t[k]]);
            }
            made[k] = n;
        }
        out.triangles.push_back(made);
    }
    return out;
}

/// What an intraoral scanner sees of a starter tooth: its crown with noise, and some of the gum.
TriangleMesh intraoral(ToothKind kind, std::mt19937_64& generator, double noiseMm, bool withGum) {
    TriangleMesh scan = clipped(surfacesOf(kind).outer.mesh, [](const Vec3& p) { return p.z() > 1.0; });
    for (Vec3& v : scan.vertices)
        v += noiseMm * std::normal_distribution<double>()(generator) * test::randomDirection(generator);
    if (!withGum) return scan;
    const double halfX = 0.5 * scan.bounds().size().x(), halfY = 0.5 * scan.bounds().size().y();
    const auto first = static_cast<std::uint32_t>(scan.vertices.size());
    constexpr int kSide = 40;
    for (int j = 0; j <= kSide; ++j)
        for (int i = 0; i <= kSide; ++i)
            scan.vertices.emplace_back(24.0 * i / kSide - 12.0, 24.0 * j / kSide - 12.0,
                                       0.8 + 0.3 * std::sin(0.9 * i) * std::cos(0.7 * j));
    const auto isFree = [&](std::uint32_t v) {
        const Vec3& p = scan.vertices[v];
        return std::abs(p.x()) > halfX + 0.2 || std::abs(p.y()) > halfY + 0.2;
    };
    for (std::uint32_t j = 0; j < kSide; ++j)
        for (std::uint32_t i = 0; i < kSide; ++i) {
            const std::uint32_t a = first + j * (kSide + 1) + i, b = a + 1, c = a + kSide + 1, d = c + 1;
            if (!isFree(a) || !isFree(b) || !isFree(c) || !isFree(d)) continue;
            scan.triangles.push_back({a, b, d});
            scan.triangles.push_back({a, d, c});
        }
    return clipped(scan, [](const Vec3&) { return true; });
}

/// The same surface with other triangles.
TriangleMesh coarserOf(ToothKind kind) {
    return geometry::decimate(surfacesOf(kind).outer.mesh, 9000).mesh;
}

class PlacingEachKind : public ::testing::TestWithParam<ToothKind> {};
INSTANTIATE_TEST_SUITE_P(Starter, PlacingEachKind,
                         ::testing::Values(ToothKind::lowerFirstMolar, ToothKind::upperIncisor));

TEST_P(PlacingEachKind, FindsTheFrameHoweverTheToothLies) {
    std::mt19937_64 generator(test::seed());
    const starter::ToothKindInfo& info = starter::infoOf(GetParam());
    for (int i = 0; i < 6; ++i) {
        const Pose toothInScan = randomPose(generator);
        const surfacing::Surfaces scan = moved(surfacesOf(GetParam()), toothInScan);
        const Placed placed = place(scan, {std::nullopt, std::nullopt, info.fdiNumber});
        const Vec3 occlusal = placed.scanInTooth.orientation * (toothInScan.orientation * Vec3::UnitZ());
        EXPECT_LT(degrees(occlusal, Vec3::UnitZ()), 8.0);
        const Vec3 mesial = placed.scanInTooth.orientation * (toothInScan.orientation * Vec3::UnitX());
        const double off = degrees(mesial, Vec3::UnitX());
        EXPECT_LT(std::min(off, 180.0 - off), 12.0);  // either end
        EXPECT_TRUE(placed.isMesialGuessed);
        EXPECT_GT(placed.confidence, 0.7);
        // The cervical line is where z = 0 in these teeth, up to its waves.
        EXPECT_LT(placed.scanInTooth.apply(toothInScan.apply(Vec3::Zero())).norm(), 1.0);
        EXPECT_TRUE(placed.scanInTooth.isValid());
    }
}

TEST_P(PlacingEachKind, HintsWin) {
    std::mt19937_64 generator(test::seed() + 1);
    const Pose toothInScan = randomPose(generator);
    const surfacing::Surfaces scan = moved(surfacesOf(GetParam()), toothInScan);
    Hints hints;
    hints.occlusal = 3.0 * (toothInScan.orientation * Vec3(0.1, 0.0, 1.0));
    hints.mesial = toothInScan.orientation * Vec3(-1.0, 0.2, 0.5);
    const Placed placed = place(scan, hints);
    EXPECT_LT(degrees(placed.scanInTooth.orientation * *hints.occlusal, Vec3::UnitZ()), 1e-6);
    const Vec3 mesial = placed.scanInTooth.orientation * *hints.mesial;
    EXPECT_NEAR(mesial.y(), 0.0, 1e-9);
    EXPECT_GT(mesial.x(), 0.0);
    EXPECT_FALSE(placed.isMesialGuessed);
    EXPECT_EQ(placed.confidence, 1.0);
    EXPECT_TRUE(placed.notes.empty());
}

TEST(Registration, GuessesFromTheShapeWhereThereIsNoEnamelAndSaysSo) {
    surfacing::Surfaces scan = surfacesOf(ToothKind::lowerFirstMolar);
    scan.tissues.clear();
    const Pose turned{Vec3(3, 4, 5), core::Quat(Eigen::AngleAxisd(2.5, Vec3(1, 2, 3).normalized()))};
    const Placed placed = place(moved(scan, turned));
    EXPECT_LT(degrees(placed.scanInTooth.orientation * (turned.orientation * Vec3::UnitZ()), Vec3::UnitZ()), 20.0);
    EXPECT_LE(placed.confidence, 0.4);
    EXPECT_THAT(placed.notes, ::testing::Contains(HasSubstr("guessed from the shape")));
}

TEST(Registration, TheNumberSaysWhichSideIsTheLonger) {
    // Lower molars are longer from mesial to distal, upper ones and premolars from buccal to lingual.
    const surfacing::Surfaces& scan = surfacesOf(ToothKind::upperIncisor);
    const auto mesialOf = [&](int fdi) {
        return Vec3(place(scan, {Vec3::UnitZ(), std::nullopt, fdi}).scanInTooth.orientation.conjugate() *
                    Vec3::UnitX());
    };
    for (const int along : {0, 11, 22, 36, 47, 51, 74, 85})
        EXPECT_LT(std::abs(mesialOf(along).y()), 0.2) << along;
    for (const int across : {13, 14, 25, 16, 27, 31, 42, 33, 44, 35, 53, 54, 65})
        EXPECT_LT(std::abs(mesialOf(across).x()), 0.2) << across;
}

TEST(Registration, RefusesSenselessHints) {
    const surfacing::Surfaces& scan = surfacesOf(ToothKind::upperIncisor);
    EXPECT_THAT(errorOf([&] { (void)place(scan, {Vec3::Zero(), std::nullopt, 0}); }), HasSubstr("occlusal surface"));
    EXPECT_THAT(errorOf([&] { (void)place(scan, {Vec3::UnitZ(), Vec3(0, 0.01, -1), 0}); }), HasSubstr("the same way"));
    EXPECT_THAT(errorOf([&] { (void)place({}, {}); }), HasSubstr("no surface"));
}

TEST_P(PlacingEachKind, MakesACaseThatCanBeCut) {
    const surfacing::Surfaces& s = surfacesOf(GetParam());
    surfacing::Surfaces scan = moved(s, {Vec3(30, -20, 10), core::Quat(Eigen::AngleAxisd(1.0, Vec3::UnitX()))});
    scan.tissues.back().isAuthored = true;
    const int fdi = starter::infoOf(GetParam()).fdiNumber;
    const cases::Case made = makeCase(scan, place(scan, {std::nullopt, std::nullopt, fdi}), {"a name", "", fdi, 0, ""});
    EXPECT_EQ(made.buccalSign, starter::infoOf(GetParam()).buccalSign);
    cases::requireCase(made);
    ASSERT_EQ(made.parts.size(), 4u);
    EXPECT_EQ(made.parts[0].name, "enamel");
    EXPECT_EQ(made.parts[1].name, "dentine");
    EXPECT_EQ(made.parts[3].name, "caries (authored)");
    for (std::size_t i = 1; i < made.parts.size(); ++i) {
        EXPECT_GT(made.parts[i].priority, made.parts[i - 1].priority);
        EXPECT_NEAR(geometry::enclosedVolumeMm3(made.parts[i].mesh), geometry::enclosedVolumeMm3(s.tissues[i - 1].mesh),
                    1e-6);
    }
    EXPECT_TRUE(made.source.empty());
    EXPECT_THAT(errorOf([&] { (void)makeCase(scan, {}, {"x", "", 49, 0, ""}); }), HasSubstr("FDI"));
    EXPECT_THAT(errorOf([&] {
                    (void)makeCase(scan, {}, {"x", "", 0, 0, "format = 1\n[cheese]\n"});
                }),
                HasSubstr("cheese"));
}

class RegisterEachKind : public ::testing::TestWithParam<ToothKind> {};
INSTANTIATE_TEST_SUITE_P(Starter, RegisterEachKind,
                         ::testing::Values(ToothKind::lowerFirstMolar, ToothKind::upperIncisor));

TEST_P(RegisterEachKind, TakesACrownFromAnyStart) {
    std::mt19937_64 generator(test::seed() + 2);
    const TriangleMesh fixed = coarserOf(GetParam());
    const TriangleMesh scan = intraoral(GetParam(), generator, 0.02, false);
    const Pose scanInWorld = randomPose(generator);
    const Registered found = registerOnto(geometry::transformed(scan, scanInWorld), fixed);
    double worstMm = 0.0;
    for (const Vec3& v : scan.vertices)
        worstMm = std::max(worstMm, (found.movingInFixed.apply(scanInWorld.apply(v)) - v).norm());
    EXPECT_LT(worstMm, 0.03);  // a seventh of a scanner's voxel
    EXPECT_LT(found.rmsMm, 0.04);
    EXPECT_GT(found.overlap, 0.9);
}

TEST(Register, TakesAScanWithGumAroundTheTooth) {
    std::mt19937_64 generator(test::seed() + 3);
    const TriangleMesh fixed = coarserOf(ToothKind::lowerFirstMolar);
    const TriangleMesh scan = intraoral(ToothKind::lowerFirstMolar, generator, 0.03, true);
    const Pose scanInWorld = randomPose(generator);
    RegisterSettings settings;
    settings.overlap = 0.25;  // most of it is gum
    const Registered found = registerOnto(geometry::transformed(scan, scanInWorld), fixed, settings);
    double worstMm = 0.0;
    for (const Vec3& v : scan.vertices)
        if (v.z() > 2.0) worstMm = std::max(worstMm, (found.movingInFixed.apply(scanInWorld.apply(v)) - v).norm());
    EXPECT_LT(worstMm, 0.06);
    EXPECT_LT(found.overlap, 0.7);
}

TEST(Register, TakesARoughPlaceByHandAndGivesTheSameAtAnyThreadCount) {
    std::mt19937_64 generator(test::seed() + 4);
    const TriangleMesh fixed = coarserOf(ToothKind::lowerFirstMolar);
    const TriangleMesh scan = intraoral(ToothKind::lowerFirstMolar, generator, 0.02, false);
    RegisterSettings settings;
    settings.roughly = Pose{Vec3(1.0, -0.8, 0.7), core::Quat(Eigen::AngleAxisd(0.2, test::randomDirection(generator)))};
    const Registered found = registerOnto(scan, fixed, settings);
    EXPECT_LT(found.movingInFixed.positionMm.norm(), 0.03);
    core::setThreadCount(1);
    const Registered alone = registerOnto(scan, fixed, settings);
    core::setThreadCount(0);
    EXPECT_EQ(alone.movingInFixed.positionMm, found.movingInFixed.positionMm);
    EXPECT_EQ(alone.movingInFixed.orientation.coeffs(), found.movingInFixed.orientation.coeffs());
    EXPECT_EQ(alone.rmsMm, found.rmsMm);
}

TEST(Register, RefusesAnotherToothAndSenselessInput) {
    std::mt19937_64 generator(test::seed() + 5);
    const TriangleMesh& molar = surfacesOf(ToothKind::lowerFirstMolar).outer.mesh;
    const TriangleMesh incisor = intraoral(ToothKind::upperIncisor, generator, 0.02, false);
    RegisterSettings settings;
    settings.overlap = 0.9;
    EXPECT_THAT(errorOf([&] { (void)registerOnto(incisor, molar, settings); }), HasSubstr("registration"));
    settings.overlap = 0.0;
    EXPECT_THAT(errorOf([&] { (void)registerOnto(incisor, molar, settings); }), HasSubstr("overlap"));
    EXPECT_THAT(errorOf([&] { (void)registerOnto({}, molar); }), HasSubstr("empty"));
    EXPECT_EQ(errorOf([&] { (void)registerOnto(incisor, molar, {}, [](double) { return false; }); }), "cancelled");
}

TEST(OuterSurface, TheCrownReplacesWhatTheScannerBlurred) {
    // The CT saw the tooth 0.12 mm too thick and its fissures filled; the intraoral scan is right.
    const surfacing::Surfaces& truth = surfacesOf(ToothKind::lowerFirstMolar);
    const geometry::TriangleTree right(truth.outer.mesh);
    geometry::IsosurfaceSettings coarse;
    coarse.spacingMm = 0.2;
    coarse.relaxations = 0;
    coarse.project = false;  // as a scanner's voxels would give it
    surfacing::Surfaces ct = truth;
    ct.outer.mesh = geometry::isosurface(
        truth.outer.mesh.bounds().grown(0.6), [&](const Vec3& p) { return right.signedDistance(p) - 0.12; }, coarse);
    std::mt19937_64 generator(test::seed() + 6);
    const TriangleMesh crown = intraoral(ToothKind::lowerFirstMolar, generator, 0.005, false);
    const surfacing::Surfaces made = withOuterSurface(ct, crown, 0.4);

    const geometry::MeshReport report = geometry::inspect(made.outer.mesh);
    EXPECT_TRUE(report.closed());
    EXPECT_TRUE(report.oriented());
    EXPECT_EQ(report.nonManifoldVertices, 0u);
    EXPECT_EQ(report.genus, 0);
    EXPECT_TRUE(geometry::selfIntersections(made.outer.mesh).empty());

    const geometry::TriangleTree thick(ct.outer.mesh), result(made.outer.mesh);
    std::vector<double> crownMm;
    double rootMm = 0.0;
    for (const Vec3& v : truth.outer.mesh.vertices)
        if (v.z() > 3.5) crownMm.push_back(result.nearest(v).distanceMm);
    for (const Vec3& v : made.outer.mesh.vertices)
        if (v.z() < 0.0) rootMm = std::max(rootMm, thick.nearest(v).distanceMm);
    std::sort(crownMm.begin(), crownMm.end());
    std::printf("crown: median %.4f, p95 %.4f, worst %.4f mm; root %.4f mm\n", crownMm[crownMm.size() / 2],
                crownMm[crownMm.size() * 95 / 100], crownMm.back(), rootMm);
    EXPECT_LT(crownMm[crownMm.size() / 2], 0.01);
    EXPECT_LT(crownMm[crownMm.size() * 95 / 100], 0.1);  // beyond: fissures deeper than the reach
    EXPECT_LT(rootMm, 0.02);
    for (const surfacing::Surface& s : made.tissues) {
        if (s.tissue == cases::Tissue::caries) continue;  // its mouth is open to the surface
        for (const Vec3& v : s.mesh.vertices)
            ASSERT_LT(v.z() > 2.0 ? result.signedDistance(v) : 0.0, 0.06);
    }
    const cases::Case made2 = makeCase(made, place(made), {});
    cases::requireCase(made2);
}

TEST(OuterSurface, RefusesACrownThatLiesElsewhere) {
    const surfacing::Surfaces& s = surfacesOf(ToothKind::upperIncisor);
    TriangleMesh away = s.outer.mesh;
    for (Vec3& v : away.vertices)
        v.x() += 30.0;
    EXPECT_THAT(errorOf([&] { (void)withOuterSurface(s, away); }), HasSubstr("register it first"));
    EXPECT_THAT(errorOf([&] { (void)withOuterSurface(s, s.outer.mesh, -1.0); }), HasSubstr("reach"));
}

}  // namespace
}  // namespace handpiece::registration::registration_test
