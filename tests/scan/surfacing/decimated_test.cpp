// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/scan/surfacing/surfaces.h"
#include "scan/surfacing/regions.h"
#include "support/error_of.h"

namespace handpiece::surfacing::decimated_test {
namespace {

using cases::Tissue;
using core::Vec3;
using geometry::TriangleMesh;
using test::BallTooth;
using test::tissueOf;

const Surfaces& fullTooth() {
    static const Surfaces full = makeSurfaces(BallTooth{}.region(0.1));
    return full;
}

void expectSolid(const TriangleMesh& mesh) {
    const geometry::MeshReport report = geometry::inspect(mesh);
    EXPECT_TRUE(report.closed());
    EXPECT_TRUE(report.oriented());
    EXPECT_EQ(report.nonManifoldVertices, 0u);
    EXPECT_EQ(report.genus, 0);
    EXPECT_TRUE(geometry::selfIntersections(mesh).empty());
}

std::vector<const Surface*> allOf(const Surfaces& surfaces) {
    std::vector<const Surface*> all{&surfaces.outer};
    for (const Surface& tissue : surfaces.tissues)
        all.push_back(&tissue);
    return all;
}

TEST(Decimated, TableTwoHasExactlyItsPercentages) {
    const Surfaces& full = fullTooth();
    const std::vector<Surfaces> steps = decimatedSteps(full, kTableTwoPercents);
    ASSERT_EQ(steps.size(), 5u);
    const std::vector<const Surface*> whole = allOf(full);
    for (std::size_t s = 0; s < steps.size(); ++s) {
        const std::vector<const Surface*> all = allOf(steps[s]);
        ASSERT_EQ(all.size(), whole.size());
        for (std::size_t i = 0; i < all.size(); ++i) {
            SCOPED_TRACE(testing::Message() << kTableTwoPercents[s] << " %, surface " << i);
            const double wanted = 0.01 * kTableTwoPercents[s] * static_cast<double>(whole[i]->mesh.triangles.size());
            EXPECT_LE(std::abs(static_cast<double>(all[i]->mesh.triangles.size()) - wanted), 1.0);
            EXPECT_EQ(all[i]->mesh.triangles.size() % 2, 0u);
            EXPECT_EQ(all[i]->tissue, whole[i]->tissue);
            expectSolid(all[i]->mesh);
        }
        EXPECT_TRUE(steps[s].notes.empty()) << steps[s].notes.front();
        EXPECT_NEAR(geometry::enclosedVolumeMm3(steps[s].outer.mesh) / geometry::enclosedVolumeMm3(full.outer.mesh),
                    1.0, 5e-4);
    }
    EXPECT_EQ(steps[4].outer.mesh.vertices, full.outer.mesh.vertices);
    EXPECT_EQ(steps[4].outer.mesh.triangles, full.outer.mesh.triangles);
}

TEST(Decimated, OneStepIsThatOfAll) {
    const Surfaces alone = decimated(fullTooth(), 12);
    const std::array<double, 3> percents{25, 6, 12};
    const std::vector<Surfaces> steps = decimatedSteps(fullTooth(), percents);
    for (std::size_t i = 0; i < alone.tissues.size(); ++i) {
        EXPECT_EQ(alone.tissues[i].mesh.vertices, steps[2].tissues[i].mesh.vertices);
        EXPECT_EQ(alone.tissues[i].mesh.triangles, steps[2].tissues[i].mesh.triangles);
    }
    EXPECT_EQ(alone.outer.mesh.vertices, steps[2].outer.mesh.vertices);
}

TEST(Decimated, BoundHoldsAndSidesAreKept) {
    const Surfaces& full = fullTooth();
    const BallTooth truth;
    for (const double percent : {2.0, 6.0, 25.0}) {
        SCOPED_TRACE(percent);
        const Surfaces few = decimated(full, percent);
        const std::vector<const Surface*> whole = allOf(full), all = allOf(few);
        for (std::size_t i = 0; i < all.size(); ++i) {
            const geometry::TriangleTree tree(all[i]->mesh);
            double worst = 0.0;
            for (const Vec3& p : whole[i]->mesh.vertices)
                worst = std::max(worst, tree.nearest(p).distanceMm);
            EXPECT_LE(worst, all[i]->errorBoundMm + 1e-12) << i;
        }
        const geometry::TriangleTree outer(few.outer.mesh), dentine(tissueOf(few, Tissue::dentine)->mesh);
        for (const Vec3& p : tissueOf(few, Tissue::pulp)->mesh.vertices) {
            EXPECT_LE(outer.signedDistance(p), -few.leastGapMm);
            EXPECT_LE(dentine.signedDistance(p), -few.leastGapMm);
        }
        // No flakes of enamel on the root: what lies just under the outer surface there is dentine.
        std::size_t flakes = 0, points = 0;
        for (const geometry::Triangle& t : few.outer.mesh.triangles) {
            const Vec3 &a = few.outer.mesh.vertices[t[0]], &b = few.outer.mesh.vertices[t[1]],
                       &c = few.outer.mesh.vertices[t[2]];
            const Vec3 p = (a + b + c) / 3.0 - 0.002 * (b - a).cross(c - a).normalized();
            if (p.z() > truth.middle.z() - truth.enamelMm) continue;
            ++points;
            flakes += dentine.signedDistance(p) > 0.0;
        }
        ASSERT_GT(points, 100u);
        EXPECT_LE(static_cast<double>(flakes) / static_cast<double>(points), 0.005);
    }
}

TEST(Decimated, ToATotalOfFaces) {
    const Surfaces few = decimatedTo(fullTooth(), 8000);
    std::size_t total = 0;
    for (const Surface* surface : allOf(few)) {
        total += surface->mesh.triangles.size();
        expectSolid(surface->mesh);
    }
    EXPECT_NEAR(static_cast<double>(total), 8000.0, 100.0);
    const double all = [] {
        double sum = 0.0;
        for (const Surface* surface : allOf(fullTooth()))
            sum += geometry::surfaceAreaMm2(surface->mesh);
        return sum;
    }();
    EXPECT_NEAR(static_cast<double>(few.outer.mesh.triangles.size()),
                8000.0 * geometry::surfaceAreaMm2(fullTooth().outer.mesh) / all, 2.0);
}

// Faces of 0.1 mm under a field of 0.2 mm voxels: as coarse as said, at the cost that is said.
TEST(Decimated, TheUsefulPercentHasEdgesOfTwoVoxels) {
    const Surfaces& full = fullTooth();
    const double voxelMm = 0.2, percent = usefulPercent(full, voxelMm);
    EXPECT_GE(percent, 4.0);
    EXPECT_LE(percent, 7.0);
    EXPECT_EQ(usefulPercent(full, 0.04), 100.0);
    const Surfaces few = decimated(full, percent);
    EXPECT_LE(few.outer.errorBoundMm, 1.5 * voxelMm * voxelMm / BallTooth{}.radiusMm);
    std::size_t faces = 0;
    double areaMm2 = 0.0;
    for (const Surface* surface : allOf(few)) {
        faces += surface->mesh.triangles.size();
        areaMm2 += geometry::surfaceAreaMm2(surface->mesh);
    }
    // Equilateral triangles with edges of two voxels, or a whole percentage more.
    const double edgeMm = std::sqrt(4.0 / std::sqrt(3.0) * areaMm2 / static_cast<double>(faces));
    EXPECT_LE(edgeMm, 2.0 * voxelMm * 1.01);
    EXPECT_GE(edgeMm, 1.75 * voxelMm);
}

TEST(Decimated, SaysWhatIsWrong) {
    for (const double percent : {0.0, -3.0, 100.5, std::nan("")})
        EXPECT_NE(test::errorOf([&] { (void)decimated(fullTooth(), percent); }).find("is not possible"),
                  std::string::npos);
    EXPECT_NE(test::errorOf([&] { (void)decimatedTo(fullTooth(), 100); }).find("too few for 4 surfaces"),
              std::string::npos);
    EXPECT_NE(
        test::errorOf([&] { (void)decimated(fullTooth(), 6, [](double f) { return f < 0.1; }); }).find("cancelled"),
        std::string::npos);
}

}  // namespace
}  // namespace handpiece::surfacing::decimated_test
