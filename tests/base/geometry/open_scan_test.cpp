// SPDX-License-Identifier: Apache-2.0
// Open intraoral scans, drawn at random: closed, or stood on a base, so that a case takes them; or refused with a
// reason.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <set>

#include "base/geometry/arches.h"
#include "base/geometry/brute_crossings.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/base/geometry/repair.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/model/case/case.h"

namespace handpiece::geometry::open_scan_test {
namespace {

using core::Vec3;
using testing::HasSubstr;

std::set<std::array<double, 3>> placesOf(const TriangleMesh& mesh) {
    std::set<std::array<double, 3>> places;
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t)
            places.insert({mesh.vertices[v].x(), mesh.vertices[v].y(), mesh.vertices[v].z()});
    return places;
}

/// Mended, or empty and refused with a reason.
TriangleMesh mendedOrRefused(const TriangleMesh& scan, const RepairSettings& settings, RepairReport& report) {
    TriangleMesh mesh = scan;
    try {
        report = repair(mesh, settings);
        requireUncrossed(report, settings, "scan.stl");
        return mesh;
    } catch (const core::Error& e) {
        EXPECT_FALSE(e.problem().empty());
        EXPECT_FALSE(e.remedy().empty());
        return {};
    }
}

void expectACaseTakesIt(const TriangleMesh& scan, const TriangleMesh& mesh, const RepairReport& report) {
    const MeshReport r = inspect(mesh);
    EXPECT_TRUE(r.closed());
    EXPECT_TRUE(r.oriented());
    EXPECT_EQ(r.nonManifoldVertices, 0u);
    EXPECT_TRUE(selfIntersections(mesh).empty());
    EXPECT_GT(r.volumeMm3, 0.0);
    if (mesh.triangles.size() < 1200) {
        EXPECT_TRUE(test::bruteForce(mesh, kTouchingShare * r.boxMm.size().norm()).empty());
    }
    // As the file that a person gives to `case new`.
    const TriangleMesh file = readMesh(stlBytes(mesh, "mended.stl"), MeshFormat::stl, "mended.stl");
    EXPECT_NO_THROW(cases::requireSolid(file, "mended.stl"));
    // What was scanned is where it was, to the bit, but for debris, double points and what gave way as it crossed.
    if (report.removedCrossingFaces == 0 && report.droppedShells == 0 && report.weldedVertices == 0) {
        const auto given = placesOf(scan), after = placesOf(mesh);
        EXPECT_TRUE(std::includes(after.begin(), after.end(), given.begin(), given.end()));
    }
}

TEST(OpenScans, AreClosedAndStoodOnABase) {
#ifdef HANDPIECE_SANITIZED
    constexpr int kRounds = 6;
#else
    constexpr int kRounds = 44;
#endif
    std::mt19937_64 generator(test::seed());
    int closed = 0, based = 0;
    for (int round = 0; round < kRounds; ++round) {
        // Most of them small, for the tests' time; one in 22 as long as a real one's.
        const std::size_t edges =
            round % 22 == 21 ? 600 : 40 + static_cast<std::size_t>(test::uniform(generator, 0, 1) * 110);
        const test::OpenScan scan = test::ScanDrawer(generator).draw(edges);
        SCOPED_TRACE(fmt::format("round {}: {}", round, scan.what));
        RepairSettings settings;
        RepairReport report;
        const TriangleMesh plain = mendedOrRefused(scan.mesh, settings, report);
        if (!plain.triangles.empty()) {
            ++closed;
            expectACaseTakesIt(scan.mesh, plain, report);
        }
        settings.base = true;
        const TriangleMesh model = mendedOrRefused(scan.mesh, settings, report);
        if (model.triangles.empty()) continue;
        ++based;
        expectACaseTakesIt(scan.mesh, model, report);
        // The floor is flat, and nothing is below it.
        ASSERT_EQ(report.bases.size(), 1u);
        const Vec3& down = report.bases[0].downMm;
        double lowest = -HUGE_VAL, scanned = -HUGE_VAL;
        for (const Vec3& v : model.vertices)
            lowest = std::max(lowest, down.dot(v));
        for (const Vec3& v : scan.mesh.vertices)
            scanned = std::max(scanned, down.dot(v));
        EXPECT_GE(lowest, scanned - 1e-9);
        std::size_t onFloor = 0;
        for (const Vec3& v : model.vertices)
            onFloor += down.dot(v) > lowest - 1e-9;
        EXPECT_GE(onFloor, 3u);
        EXPECT_GT(enclosedVolumeMm3(model), 0.0);
    }
    RecordProperty("closed", closed);
    RecordProperty("based", based);
    EXPECT_GE(closed, kRounds - kRounds / 15);
    EXPECT_GE(based, kRounds - kRounds / 10);
}

TEST(OpenScans, ABaseHasTheDepthThatIsAsked) {
    // A cup, open below: half a ball of 5 mm.
    TriangleMesh cup = test::holed(test::sphereMesh(Vec3::Zero(), 5, 16), [](const Vec3& c) { return c.z() < 0.0; });
    RepairSettings settings;
    settings.base = true;
    settings.baseDepthMm = 2.5;
    const RepairReport r = repair(cup, settings);
    ASSERT_EQ(r.bases.size(), 1u);
    EXPECT_EQ(r.bases[0].edges, 64u);
    EXPECT_EQ(r.bases[0].depthMm, 2.5);
    EXPECT_NEAR(r.bases[0].downMm.z(), -1.0, 1e-12);
    EXPECT_NEAR(inspect(cup).boxMm.min.z(), -2.5, 1e-12);
    EXPECT_TRUE(r.holes.empty());
    EXPECT_EQ(r.crossingFaces, 0u);
    const double half = 2.0 / 3.0 * M_PI * 125.0, cylinder = M_PI * 25.0 * 2.5;
    EXPECT_NEAR(r.after.volumeMm3, half + cylinder, 0.02 * (half + cylinder));
}

TEST(OpenScans, ABaseNeedsABorder) {
    RepairSettings settings;
    settings.base = true;
    const auto problemOf = [&](TriangleMesh mesh) {
        try {
            (void)repair(mesh, settings);
        } catch (const core::Error& e) {
            return e.problem();
        }
        return std::string();
    };
    TriangleMesh ball = test::sphereMesh(Vec3::Zero(), 5, 16);
    EXPECT_THAT(problemOf(ball), HasSubstr("closed"));
    ball.triangles.pop_back();
    EXPECT_THAT(problemOf(ball), HasSubstr("only a hole"));
    settings.baseDepthMm = std::nan("");
    EXPECT_THAT(problemOf(ball), HasSubstr("base"));
}

TEST(OpenScans, WhatCannotBeClosedIsRefusedWithTheReason) {
    // A rod stands in the cup and looks out of it: what closes the cup would go through the rod.
    const TriangleMesh cup =
        test::holed(test::sphereMesh(Vec3::Zero(), 5, 16), [](const Vec3& c) { return c.z() < 0.0; });
    const TriangleMesh rod = test::boxMesh({-1, -1, -7}, {1.1, 1.2, 2});
    for (const bool base : {false, true}) {
        TriangleMesh mesh = test::joined(cup, rod);
        RepairSettings settings;
        settings.base = base;
        try {
            const RepairReport r = repair(mesh, settings);
            EXPECT_GT(r.crossingMade, 0u);
            requireUncrossed(r, settings, "cup.stl");
            ADD_FAILURE() << "closed through the rod, base " << base;
        } catch (const core::Error& e) {
            EXPECT_THAT(e.what(), HasSubstr("cross")) << base;
            EXPECT_THAT(e.problem(), HasSubstr(base ? "every base" : "a hole cannot be closed"));
        }
    }
    // Two solids that overlap: nothing was made, and that is said.
    TriangleMesh two = test::joined(test::sphereMesh(Vec3::Zero(), 5, 8), test::sphereMesh({3, 0.2, 0.1}, 4, 8));
    const RepairReport r = repair(two);
    EXPECT_EQ(r.crossingMade, 0u);
    try {
        requireUncrossed(r, {}, "two.stl");
        ADD_FAILURE() << "solids that overlap were let pass";
    } catch (const core::Error& e) {
        EXPECT_THAT(e.what(), HasSubstr("two.stl: the surface crosses itself"));
        EXPECT_THAT(e.remedy(), HasSubstr("unite"));
    }
}

}  // namespace
}  // namespace handpiece::geometry::open_scan_test
