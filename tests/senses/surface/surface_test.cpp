// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/surface/surface.h"

#include <gtest/gtest.h>

#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/senses/surface/closed_surface.h"
#include "senses/surface/solids.h"
#include "support/random.h"

namespace handpiece::surface::surface_test {
namespace {

using core::Quat;
using core::Vec3;

geometry::TriangleMesh meshOf(const field::DistanceField& field) {
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

/// Distances of `points` to the mesh [um], ascending.
std::vector<double> distancesUm(const geometry::TriangleMesh& mesh, const std::vector<Vec3>& points) {
    const geometry::TriangleTree tree(mesh);
    std::vector<double> all;
    for (const Vec3& p : points)
        all.push_back(1e3 * tree.nearest(p).distanceMm);
    std::sort(all.begin(), all.end());
    return all;
}

/// An edge of the solid is an edge of the mesh: within 10 um at voxels of 50 um nearly everywhere, and never off by
/// half a voxel.
void expectSharp(const geometry::TriangleMesh& mesh, const std::vector<Vec3>& edge, std::size_t percent = 95) {
    const std::vector<double> off = distancesUm(mesh, edge);
    EXPECT_LT(off[off.size() * percent / 100], 10.0);
    EXPECT_LT(off.back(), 25.0);
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
    for (int i = 0; i < 5; ++i) {
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
                for (double t = 0.1; t <= 0.9; t += 0.01)
                    if ((c & d) == 0)
                        edges.push_back(
                            corners[static_cast<std::size_t>(c)] +
                            t * (corners[static_cast<std::size_t>(c | d)] - corners[static_cast<std::size_t>(c)]));
        expectSharp(mesh, edges);
        EXPECT_LT(distancesUm(mesh, corners).back(), 40.0);
        for (const Vec3& v : mesh.vertices)
            EXPECT_LT(std::abs(test::box(centre, half, turn)(v)), 0.03);
    }
}

TEST(Surface, MarginAndFloorOfABoxCutByACylinderAreSharp) {
    std::mt19937_64 random(test::seed());
    for (int i = 0; i < 5; ++i) {
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
        expectSharp(mesh, margin);
        expectSharp(mesh, corner);
        const geometry::TriangleMesh exported = closedSurface(FieldSource(field));
        EXPECT_TRUE(geometry::selfIntersections(exported).empty());
        // A little is given up where faces crossed.
        expectSharp(exported, margin, 90);
        expectSharp(exported, corner, 90);
        EXPECT_NEAR(geometry::enclosedVolumeMm3(mesh) / volume, 1.0, 2e-3);
    }
}

TEST(Surface, CornersOnAMarginAreLitByTheSurfacesThatMeetThere) {
    std::mt19937_64 random(test::seed());
    for (int i = 0; i < 3; ++i) {
        const Quat turn = test::randomRotation(random);
        const Vec3 half(0.9, 0.9, 0.5);
        const double radius = 0.4, floor = -0.1;
        const auto field = test::sampled(
            test::cut(test::box(Vec3::Zero(), half, turn), test::cylinderBur(turn * Vec3(0, 0, floor), radius, turn)),
            {Vec3::Constant(-1.5), Vec3::Constant(1.5)});
        const FieldSource source(field);
        Surface surface(source);
        surface.build();
        std::size_t corners = 0, off = 0;
        for (const auto& mesh : surface.meshes())
            for (const auto& t : mesh->triangles)
                for (const std::uint16_t corner : t) {
                    const SurfaceVertex& v = mesh->vertices[corner];
                    const Vec3 p = turn.conjugate() * Vec3(v.positionMm[0], v.positionMm[1], v.positionMm[2]);
                    const double r = std::hypot(p.x(), p.y());
                    if (std::abs(r - radius) > 0.03 || std::abs(p.z() - half.z()) > 0.03) continue;
                    const Vec3 n = turn.conjugate() * Vec3(v.normal[0], v.normal[1], v.normal[2]);
                    const Vec3 wall(-p.x() / r, -p.y() / r, 0.0);
                    ++corners;
                    // A dozen degrees off both of them.
                    if (std::max(n.z(), n.dot(wall)) < 0.978) ++off;
                }
        EXPECT_GT(corners, 300u);
        EXPECT_LE(off, corners / 50) << corners;
    }
}

}  // namespace
}  // namespace handpiece::surface::surface_test
