// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/inspect.h"

#include <gtest/gtest.h>

#include "base/geometry/meshes.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "support/random.h"

namespace handpiece::geometry::inspect_test {
namespace {

using core::Vec3;
using test::boxMesh;
using test::joined;
using test::sphereMesh;

const TriangleMesh kBox = boxMesh({1, 2, 3}, {4, 7, 10});

TEST(Inspect, BoxIsMeasuredExactly) {
    const MeshReport r = inspect(kBox);
    EXPECT_EQ(r.vertices, 8u);
    EXPECT_EQ(r.faces, 12u);
    EXPECT_EQ(r.edges, 18u);
    EXPECT_DOUBLE_EQ(r.areaMm2, 2.0 * (3 * 5 + 5 * 7 + 3 * 7));
    EXPECT_DOUBLE_EQ(r.volumeMm3, 105.0);
    EXPECT_EQ(r.boxMm.min, Vec3(1, 2, 3));
    EXPECT_EQ(r.boxMm.max, Vec3(4, 7, 10));
    EXPECT_EQ(r.shells, 1u);
    EXPECT_TRUE(r.closed());
    EXPECT_TRUE(r.oriented());
    EXPECT_EQ(r.eulerCharacteristic, 2);
    EXPECT_EQ(r.genus, 0);
    EXPECT_EQ(r.openEdges + r.nonManifoldEdges + r.nonManifoldVertices + r.duplicateVertices + r.degenerateFaces +
                  r.duplicateFaces,
              0u);
}

TEST(Inspect, SphereNearsItsClosedForm) {
    const MeshReport r = inspect(sphereMesh({5, -3, 100}, 6.0, 64));
    const double area = 4.0 * M_PI * 36.0, volume = 4.0 / 3.0 * M_PI * 216.0;
    EXPECT_NEAR(r.areaMm2, area, 1e-3 * area);
    EXPECT_NEAR(r.volumeMm3, volume, 1e-3 * volume);
    EXPECT_LT(r.volumeMm3, volume);
    EXPECT_EQ(r.genus, 0);
}

TEST(Inspect, GenusAndEulerCharacteristic) {
    const MeshReport torus = inspect(test::torusMesh(5, 2, 24));
    EXPECT_EQ(torus.eulerCharacteristic, 0);
    EXPECT_EQ(torus.genus, 1);
    const MeshReport two = inspect(joined(test::torusMesh(5, 2, 24), sphereMesh({20, 0, 0}, 3, 4)));
    EXPECT_EQ(two.eulerCharacteristic, 2);
    EXPECT_EQ(two.genus, 1);
    EXPECT_EQ(two.shells, 2u);
}

TEST(Inspect, HolesAreCounted) {
    TriangleMesh mesh = sphereMesh(Vec3::Zero(), 5, 8);
    const Vec3 gone = (mesh.vertices[mesh.triangles[40][0]] + mesh.vertices[mesh.triangles[40][1]]) / 2.0;
    mesh.triangles.erase(mesh.triangles.begin() + 300);
    mesh.triangles.erase(mesh.triangles.begin() + 40);
    const MeshReport r = inspect(mesh);
    EXPECT_EQ(r.openEdges, 6u);
    EXPECT_EQ(r.boundaryLoops, 2u);
    EXPECT_FALSE(r.closed());
    EXPECT_FALSE(r.genus.has_value());
    ASSERT_TRUE(r.firstOpenEdgeMm.has_value());
    EXPECT_LT((*r.firstOpenEdgeMm - gone).norm(), 10.0);
}

TEST(Inspect, FlippedFacesAreTheSmallerSide) {
    TriangleMesh mesh = sphereMesh(Vec3::Zero(), 5, 8);
    for (const std::size_t f : {3u, 77u, 78u, 400u})
        std::swap(mesh.triangles[f][0], mesh.triangles[f][1]);
    EXPECT_EQ(inspect(mesh).flippedFaces, 4u);
    EXPECT_EQ(inspect(test::insideOut(mesh)).flippedFaces, 4u);
    EXPECT_EQ(inspect(test::insideOut(mesh)).insideOutShells, 1u);
}

TEST(Inspect, CavitiesFaceInwards) {
    const TriangleMesh outer = sphereMesh(Vec3::Zero(), 5, 8), inner = sphereMesh({0.5, 0.3, 0.1}, 2, 5);
    EXPECT_EQ(inspect(joined(outer, test::insideOut(inner))).insideOutShells, 0u);
    EXPECT_EQ(inspect(joined(outer, inner)).insideOutShells, 1u);
    EXPECT_EQ(inspect(joined(test::insideOut(outer), test::insideOut(inner))).insideOutShells, 1u);
    EXPECT_EQ(inspect(joined(outer, sphereMesh({6, 6, 0}, 1, 5))).insideOutShells, 0u);
    EXPECT_EQ(inspect(joined(joined(outer, test::insideOut(inner)), sphereMesh({0.5, 0.3, 0.1}, 1, 5))).insideOutShells,
              0u);
}

TEST(Inspect, PlantedFlawsAreCountedExactly) {
    TriangleMesh mesh = sphereMesh(Vec3::Zero(), 5, 8);
    // A fin on an edge, a face twice, a face without area, a vertex unused.
    const Triangle t = mesh.triangles[10];
    mesh.vertices.push_back(mesh.vertices[t[0]] * 1.5);
    mesh.triangles.push_back({t[0], t[1], static_cast<std::uint32_t>(mesh.vertices.size() - 1)});
    MeshReport r = inspect(mesh);
    EXPECT_EQ(r.nonManifoldEdges, 1u);
    EXPECT_EQ(r.openEdges, 2u);
    mesh.triangles.push_back({mesh.triangles[100][1], mesh.triangles[100][0], mesh.triangles[100][2]});
    mesh.triangles.push_back({5, 5, 6});
    mesh.vertices.emplace_back(99, 99, 99);
    r = inspect(mesh);
    EXPECT_EQ(r.duplicateFaces, 1u);
    EXPECT_EQ(r.nonManifoldEdges, 4u);
    EXPECT_EQ(r.degenerateFaces, 1u);
    EXPECT_EQ(r.unusedVertices, 1u);
    EXPECT_LT(r.boxMm.max.x(), 10.0) << "an unused vertex does not count";
}

TEST(Inspect, VerticesThatTouch) {
    // Two tetrahedra of one vertex.
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}};
    MeshReport r = inspect(mesh);
    EXPECT_EQ(r.nonManifoldVertices, 1u);
    EXPECT_EQ(r.shells, 2u);
    EXPECT_TRUE(r.closed());
    ASSERT_TRUE(r.firstNonManifoldVertexMm.has_value());
    EXPECT_EQ(*r.firstNonManifoldVertexMm, Vec3(0, 0, 0));
    r = inspect(test::soup(kBox));
    EXPECT_EQ(r.duplicateVertices, 28u);
    EXPECT_EQ(r.openEdges, 36u);
    EXPECT_EQ(r.shells, 12u);
}

TEST(Inspect, OneSidedSurfaceIsNotOrientable) {
    TriangleMesh strip;
    constexpr std::uint32_t n = 12;
    for (std::uint32_t i = 0; i < n; ++i) {
        const double u = 2.0 * M_PI * i / n;
        for (const double w : {-1.0, 1.0}) {
            const double r = 5.0 + w * std::cos(u / 2);
            strip.vertices.emplace_back(r * std::cos(u), r * std::sin(u), w * std::sin(u / 2));
        }
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t a = 2 * i, b = 2 * i + 1, c = i + 1 < n ? a + 2 : 1, d = i + 1 < n ? b + 2 : 0;
        strip.triangles.push_back({a, c, b});
        strip.triangles.push_back({b, c, d});
    }
    EXPECT_FALSE(inspect(strip).orientable);
}

TEST(Inspect, UnitsAreGuessedWithAReason) {
    EXPECT_EQ(probableUnit(25.0).unit, LengthUnit::millimetre);
    EXPECT_EQ(probableUnit(0.5).unit, LengthUnit::millimetre);
    EXPECT_EQ(probableUnit(120.0).unit, LengthUnit::millimetre);
    EXPECT_EQ(probableUnit(25000.0).unit, LengthUnit::micrometre);
    EXPECT_EQ(probableUnit(0.025).unit, LengthUnit::metre);
    EXPECT_EQ(probableUnit(0.2).unit, LengthUnit::inch);
    EXPECT_EQ(probableUnit(1e9).unit, LengthUnit::unknown);
    EXPECT_EQ(probableUnit(0.0).unit, LengthUnit::unknown);
    for (const double d : {25.0, 25000.0, 0.025, 1e9, 0.0})
        EXPECT_FALSE(probableUnit(d).reason.empty());
}

TEST(Inspect, BadIndicesAreRefused) {
    TriangleMesh mesh = kBox;
    mesh.triangles[3][1] = 8;
    EXPECT_THROW((void)inspect(mesh), core::Error);
    EXPECT_EQ(inspect(TriangleMesh{}).faces, 0u);
}

TEST(Inspect, RealTools) {
    const std::filesystem::path data = test::realDataFolder();
    if (data.empty()) GTEST_SKIP() << "no real data beside the checkout";
    const MeshReport bur = inspect(readMesh(data / "tools" / "tapered_bur.stl"));
    EXPECT_EQ(bur.vertices, 1562u);
    EXPECT_EQ(bur.faces, 3120u);
    EXPECT_TRUE(bur.closed());
    EXPECT_TRUE(bur.oriented());
    const MeshReport head = inspect(readMesh(data / "tools" / "contra_angle_head.stl"));
    EXPECT_EQ(head.openEdges, 43u);
    EXPECT_FALSE(head.closed());
}

}  // namespace
}  // namespace handpiece::geometry::inspect_test
