// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/surface/surface.h"

#include <gtest/gtest.h>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "senses/surface/solids.h"
#include "support/random.h"

namespace handpiece::surface {
namespace {

using core::Quat;
using core::Vec3;

geometry::TriangleMesh meshOf(const tooth::ToothField& field) {
    const FieldSource source(field);
    Surface surface(source);
    surface.build();
    return surface.closedMesh();
}

void expectSolid(const geometry::TriangleMesh& mesh, std::int64_t genus, std::size_t shells = 1) {
    const geometry::MeshReport report = geometry::inspect(mesh);
    EXPECT_TRUE(report.closed()) << report.openEdges << " open, " << report.nonManifoldEdges << " non-manifold";
    EXPECT_TRUE(report.oriented());
    EXPECT_EQ(report.nonManifoldVertices, 0u);
    EXPECT_EQ(report.unusedVertices, 0u);
    EXPECT_EQ(report.shells, shells);
    ASSERT_TRUE(report.genus.has_value());
    EXPECT_EQ(*report.genus, genus);
}

/// Largest distance of `points` to the mesh [um].
double farthestUm(const geometry::TriangleMesh& mesh, const std::vector<Vec3>& points) {
    const geometry::TriangleTree tree(mesh);
    double most = 0.0;
    for (const Vec3& p : points)
        most = std::max(most, tree.nearest(p).distanceMm);
    return 1e3 * most;
}

TEST(Surface, SphereHasTheAreaAndVolumeOfASphere) {
    const Vec3 centre(0.013, -0.021, 0.007);
    const auto field = test::sampled(test::sphere(centre, 1.0), {Vec3::Constant(-1.1), Vec3::Constant(1.1)});
    const geometry::TriangleMesh mesh = meshOf(field);
    expectSolid(mesh, 0);
    EXPECT_NEAR(geometry::enclosedVolumeMm3(mesh) / (4.0 / 3.0 * M_PI), 1.0, 1e-3);
    EXPECT_NEAR(geometry::surfaceAreaMm2(mesh) / (4.0 * M_PI), 1.0, 1e-3);
    for (const Vec3& v : mesh.vertices)
        EXPECT_NEAR((v - centre).norm(), 1.0, 0.002);
}

TEST(Surface, BoxKeepsItsEdgesAndCorners) {
    std::mt19937_64 random(test::seed());
    for (int i = 0; i < 6; ++i) {
        const Quat turn = i == 0 ? Quat::Identity() : test::randomRotation(random);
        const Vec3 centre = 0.05 * test::randomDirection(random), half(0.6, 0.5, 0.7);
        const auto field = test::sampled(test::box(centre, half, turn), {Vec3::Constant(-1.1), Vec3::Constant(1.1)});
        const geometry::TriangleMesh mesh = meshOf(field);
        expectSolid(mesh, 0);
        const geometry::MeshReport report = geometry::inspect(mesh);
        EXPECT_NEAR(report.volumeMm3 / (8 * 0.6 * 0.5 * 0.7), 1.0, 1e-3);
        EXPECT_NEAR(report.areaMm2 / (8 * (0.6 * 0.5 + 0.5 * 0.7 + 0.6 * 0.7)), 1.0, 5e-3);
        std::vector<Vec3> corners, edges;
        for (int c = 0; c < 8; ++c)
            corners.push_back(centre + turn * Vec3((c & 1) != 0 ? half.x() : -half.x(),
                                                   (c & 2) != 0 ? half.y() : -half.y(),
                                                   (c & 4) != 0 ? half.z() : -half.z()));
        for (int c = 0; c < 8; ++c)
            for (const int d : {1, 2, 4})
                for (double t = 0.0; t <= 1.0; t += 0.01)
                    if ((c & d) == 0)
                        edges.push_back(
                            corners[static_cast<std::size_t>(c)] +
                            t * (corners[static_cast<std::size_t>(c | d)] - corners[static_cast<std::size_t>(c)]));
        double worst = 0.0;
        for (const Vec3& v : mesh.vertices)
            worst = std::max(worst, std::abs(test::box(centre, half, turn)(v)));
        std::printf("turn %d: edges %.2f um, corners %.2f um, vertices off %.2f um, crossings %zu\n", i,
                    farthestUm(mesh, edges), farthestUm(mesh, corners), 1e3 * worst,
                    geometry::selfIntersections(mesh).size());
        EXPECT_LT(farthestUm(mesh, edges), 10.0);
    }
}

TEST(Surface, MarginAndFloorOfABoxCutByACylinderAreSharp) {
    std::mt19937_64 random(test::seed());
    for (int i = 0; i < 6; ++i) {
        // A block whose top the bur enters askew to the grid; its axis is the block's normal.
        const Quat turn = i == 0 ? Quat::Identity() : test::randomRotation(random);
        const Vec3 half(0.9, 0.9, 0.5);
        const double radius = 0.4, floor = -0.1;
        const test::Distance block = test::box(Vec3::Zero(), half, turn);
        const test::Distance bur = test::cylinderBur(turn * Vec3(0, 0, floor), radius, turn);
        const auto field = test::sampled(test::cut(block, bur), {Vec3::Constant(-1.5), Vec3::Constant(1.5)});
        const geometry::TriangleMesh mesh = meshOf(field);
        expectSolid(mesh, 0);
        std::vector<Vec3> margin, corner;
        for (double a = 0.0; a < 2 * M_PI; a += 0.01) {
            margin.push_back(turn * Vec3(radius * std::cos(a), radius * std::sin(a), half.z()));
            corner.push_back(turn * Vec3(radius * std::cos(a), radius * std::sin(a), floor));
        }
        const double volume = 8 * half.prod() - M_PI * radius * radius * (half.z() - floor);
        double worst = 0.0, sum = 0.0;
        for (const Vec3& v : mesh.vertices) {
            const double off = std::abs(test::cut(block, bur)(v));
            worst = std::max(worst, off);
            sum += off;
        }
        std::printf(
            "turn %d: margin %.2f um, floor corner %.2f um, vertices off %.2f um mean %.3f, volume %.4f %%, crossings "
            "%zu\n",
            i, farthestUm(mesh, margin), farthestUm(mesh, corner), 1e3 * worst,
            1e3 * sum / double(mesh.vertices.size()), 100 * (geometry::enclosedVolumeMm3(mesh) / volume - 1),
            geometry::selfIntersections(mesh).size());
        EXPECT_LT(farthestUm(mesh, margin), 10.0);
        EXPECT_LT(farthestUm(mesh, corner), 10.0);
        EXPECT_NEAR(geometry::enclosedVolumeMm3(mesh) / volume, 1.0, 2e-3);
    }
}

}  // namespace
}  // namespace handpiece::surface
