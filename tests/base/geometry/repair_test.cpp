// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/geometry/meshes.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "support/random.h"

namespace handpiece::geometry::repair_test {
namespace {

using core::Vec3;
using test::boxMesh;
using test::holed;
using test::joined;
using test::sphereMesh;

void expectWhole(const TriangleMesh& mesh) {
    const MeshReport r = inspect(mesh);
    EXPECT_TRUE(r.closed());
    EXPECT_TRUE(r.oriented());
    EXPECT_EQ(r.nonManifoldVertices, 0u);
    EXPECT_EQ(r.duplicateFaces, 0u);
    EXPECT_EQ(r.unusedVertices, 0u);
}

TEST(Repair, LeavesAWholeMeshAlone) {
    TriangleMesh mesh = sphereMesh({1, 2, 3}, 5, 16);
    const TriangleMesh before = mesh;
    const RepairReport r = repair(mesh);
    EXPECT_EQ(mesh.triangles, before.triangles);
    EXPECT_EQ(mesh.vertices, before.vertices);
    EXPECT_EQ(
        r.weldedVertices + r.addedFaces + r.turnedFaces + r.droppedShells + r.splitVertices + r.removedDuplicateFaces,
        0u);
}

TEST(Repair, WeldsASoup) {
    std::mt19937_64 generator(test::seed());
    const TriangleMesh whole = sphereMesh({1, 2, 3}, 5, 16);
    TriangleMesh mesh = test::soup(whole);
    for (Vec3& v : mesh.vertices)
        v += 2e-5 * test::randomDirection(generator);
    const RepairReport r = repair(mesh);
    EXPECT_EQ(mesh.vertices.size(), whole.vertices.size());
    EXPECT_EQ(r.weldedVertices, 3 * whole.triangles.size() - whole.vertices.size());
    EXPECT_TRUE(r.holes.empty());
    expectWhole(mesh);
    EXPECT_NEAR(enclosedVolumeMm3(mesh), enclosedVolumeMm3(whole), 1e-4 * enclosedVolumeMm3(whole));
}

TEST(Repair, WeldingDistanceIsTheCallers) {
    const TriangleMesh whole = sphereMesh({1, 2, 3}, 5, 8);
    TriangleMesh mesh = test::soup(whole);
    std::mt19937_64 generator(test::seed());
    for (Vec3& v : mesh.vertices)
        v += 0.01 * test::randomDirection(generator);
    RepairSettings settings;
    settings.weldMm = 0.1;
    EXPECT_EQ(repair(mesh, settings).weldMm, 0.1);
    EXPECT_EQ(mesh.vertices.size(), whole.vertices.size());
    settings.weldMm = 5.0;
    EXPECT_THROW(repair(mesh, settings), core::Error);
    settings.weldMm = std::nan("");
    EXPECT_THROW(repair(mesh, settings), core::Error);
}

TEST(Repair, ClosesAFlatHoleExactly) {
    TriangleMesh mesh = boxMesh({0, 0, 0}, {2, 3, 4});
    mesh.triangles.erase(mesh.triangles.begin() + 2, mesh.triangles.begin() + 4);
    const RepairReport r = repair(mesh);
    ASSERT_EQ(r.holes.size(), 1u);
    EXPECT_EQ(r.holes[0].edges, 4u);
    EXPECT_DOUBLE_EQ(r.holes[0].perimeterMm, 10.0);
    EXPECT_DOUBLE_EQ(r.holes[0].areaMm2, 6.0);
    EXPECT_EQ(r.addedFaces, 2u);
    expectWhole(mesh);
    EXPECT_DOUBLE_EQ(enclosedVolumeMm3(mesh), 24.0);
}

TEST(Repair, ClosesHolesOfEverySize) {
    const TriangleMesh whole = sphereMesh(Vec3::Zero(), 5, 32);
    // The cap that a hole of this height cuts off is lost, and no more: pi h^2 (R - h / 3).
    for (const double height : {0.05, 0.3, 1.0, 4.9}) {
        TriangleMesh mesh = holed(whole, [&](const Vec3& c) { return c.z() > 5.0 - height || c.z() < -4.95; });
        const RepairReport r = repair(mesh);
        EXPECT_EQ(r.holes.size(), 2u);
        EXPECT_EQ(r.after.boundaryLoops, 0u);
        expectWhole(mesh);
        EXPECT_EQ(r.crossingFaces, 0u) << height;
        const double cap = M_PI * height * height * (5.0 - height / 3.0), other = M_PI * 0.05 * 0.05 * 5.0;
        EXPECT_NEAR(enclosedVolumeMm3(mesh), enclosedVolumeMm3(whole) - cap - other, 0.12 * cap + 0.2);
    }
}

TEST(Repair, ALargeHoledMeshKeepsItsVolume) {
    const TriangleMesh whole = sphereMesh(Vec3::Zero(), 5, 120);  // 115,200 faces
    std::mt19937_64 generator(test::seed());
    std::vector<Vec3> places;
    for (int i = 0; i < 20; ++i)
        places.push_back(5.0 * test::randomDirection(generator));
    TriangleMesh mesh = holed(whole, [&](const Vec3& c) {
        return std::any_of(places.begin(), places.end(), [&](const Vec3& p) { return (p - c).norm() < 0.4; });
    });
    const MeshReport before = inspect(mesh);
    EXPECT_GT(before.boundaryLoops, 10u);
    const RepairReport r = repair(mesh);
    EXPECT_EQ(r.holes.size(), before.boundaryLoops);
    expectWhole(mesh);
    EXPECT_NEAR(enclosedVolumeMm3(mesh), enclosedVolumeMm3(whole), 1e-3 * enclosedVolumeMm3(whole));
    EXPECT_EQ(r.crossingFaces, 0u);
}

TEST(Repair, TurnsFacesAndShells) {
    TriangleMesh mesh = test::insideOut(sphereMesh(Vec3::Zero(), 5, 8));
    std::mt19937_64 generator(test::seed());
    for (Triangle& t : mesh.triangles)
        if (test::uniform(generator, 0, 1) < 0.3) std::swap(t[0], t[1]);
    repair(mesh);
    expectWhole(mesh);
    EXPECT_GT(enclosedVolumeMm3(mesh), 0.0);
}

TEST(Repair, CavitiesStayInwards) {
    const TriangleMesh outer = sphereMesh(Vec3::Zero(), 5, 12), inner = sphereMesh({1, 0, 0}, 2, 8);
    const double expected = enclosedVolumeMm3(outer) - enclosedVolumeMm3(inner);
    for (TriangleMesh mesh : {joined(outer, test::insideOut(inner)), joined(test::insideOut(outer), inner)}) {
        repair(mesh);
        expectWhole(mesh);
        EXPECT_NEAR(enclosedVolumeMm3(mesh), expected, 1e-9);
    }
}

TEST(Repair, DropsDebrisOnRequest) {
    const TriangleMesh whole = sphereMesh(Vec3::Zero(), 5, 12);
    TriangleMesh mesh = joined(joined(whole, sphereMesh({7, 0, 0}, 0.2, 3)), sphereMesh({0, 7, 0}, 0.1, 2));
    TriangleMesh kept = mesh;
    const RepairReport r = repair(mesh);
    EXPECT_EQ(r.droppedShells, 2u);
    EXPECT_EQ(r.droppedFaces, 72u + 32u);
    EXPECT_EQ(mesh.triangles.size(), whole.triangles.size());
    RepairSettings settings;
    settings.debrisAreaShare = 0.0;
    EXPECT_EQ(repair(kept, settings).droppedShells, 0u);
    EXPECT_EQ(inspect(kept).shells, 3u);
}

TEST(Repair, RemovesFinsAndDoubleFaces) {
    const TriangleMesh whole = sphereMesh(Vec3::Zero(), 5, 8);
    TriangleMesh mesh = whole;
    for (const std::size_t f : {10u, 200u}) {
        const Triangle t = mesh.triangles[f];
        mesh.vertices.push_back(mesh.vertices[t[0]] * 1.5);
        mesh.triangles.push_back({t[0], t[1], static_cast<std::uint32_t>(mesh.vertices.size() - 1)});
    }
    mesh.triangles.push_back(mesh.triangles[50]);
    mesh.triangles.push_back({mesh.triangles[60][1], mesh.triangles[60][0], mesh.triangles[60][2]});
    mesh.triangles.push_back({7, 7, 9});
    const RepairReport r = repair(mesh);
    EXPECT_EQ(r.removedFinFaces, 2u);
    EXPECT_EQ(r.removedDuplicateFaces, 2u);
    EXPECT_EQ(r.removedDegenerateFaces, 1u);
    EXPECT_TRUE(r.holes.empty());
    expectWhole(mesh);
    EXPECT_EQ(mesh.triangles.size(), whole.triangles.size());
    EXPECT_DOUBLE_EQ(enclosedVolumeMm3(mesh), enclosedVolumeMm3(whole));
}

TEST(Repair, CutsBoxesThatShareAnEdgeApart) {
    // After welding two opposite boxes share the vertical edge at (1, 1): four faces there.
    TriangleMesh mesh = joined(boxMesh({0, 0, 0}, {1, 1, 1}), boxMesh({1, 1, 0}, {2, 2, 1}));
    const RepairReport r = repair(mesh);
    EXPECT_EQ(r.splitEdges, 1u);
    EXPECT_EQ(r.splitVertices, 2u);
    expectWhole(mesh);
    EXPECT_EQ(inspect(mesh).shells, 2u);
    EXPECT_NEAR(enclosedVolumeMm3(mesh), 2.0, 1e-3);
    EXPECT_EQ(r.crossingFaces, 0u);
    // The cut survives a file that merges equal places.
    const test::TemporaryFolder folder;
    writeStl(folder.path() / "boxes.stl", mesh);
    expectWhole(readMesh(folder.path() / "boxes.stl"));
}

TEST(Repair, TakesTheWallBetweenTwoBoxesOut) {
    TriangleMesh mesh = joined(boxMesh({0, 0, 0}, {1, 1, 1}), boxMesh({1, 0, 0}, {2, 1, 1}));
    const RepairReport r = repair(mesh);
    EXPECT_EQ(r.weldedVertices, 4u);
    expectWhole(mesh);
    EXPECT_NEAR(enclosedVolumeMm3(mesh), 2.0, 1e-3);
}

TEST(Repair, SeparatesFansAtAVertex) {
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}};
    const RepairReport r = repair(mesh);
    EXPECT_EQ(r.splitVertices, 1u);
    expectWhole(mesh);
    EXPECT_NEAR(enclosedVolumeMm3(mesh), 2.0 / 6.0, 1e-4);
}

TEST(Repair, EdgesBetweenEndsThatStayJoined) {
    // A box with a notch on each of two opposite sides that meet along one edge: its ends are joined all the way
    // around.
    TriangleMesh mesh;
    const auto add = [&](double x0, double y0, double z0, double x1, double y1, double z1) {
        mesh = joined(mesh, boxMesh({x0, y0, z0}, {x1, y1, z1}));
    };
    for (double x = 0; x < 2; ++x)
        for (double y = 0; y < 2; ++y)
            for (double z = 0; z < 3; ++z)
                if (z != 1 || x == y) add(x, y, z, x + 1, y + 1, z + 1);
    const RepairReport r = repair(mesh);
    EXPECT_GE(r.splitEdges, 1u);
    expectWhole(mesh);
    EXPECT_NEAR(enclosedVolumeMm3(mesh), 10.0, 1e-2);
    EXPECT_EQ(inspect(mesh).shells, 1u);
}

TEST(Repair, RefusesWhatCannotBeMended) {
    TriangleMesh empty, sheet, before;
    EXPECT_THROW(repair(empty), core::Error);
    sheet.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    before = sheet;
    EXPECT_THROW(repair(sheet), core::Error);
    EXPECT_EQ(sheet.triangles, before.triangles) << "the input stays as it was";
}

TEST(Repair, RefusesToLoseMoreThanAHundredth) {
    // A flat wing of a tenth of the ball's area hangs on one of its edges: no small fin, and nothing to close.
    const TriangleMesh whole = sphereMesh(Vec3::Zero(), 5, 12);
    TriangleMesh winged = whole;
    const std::uint32_t a = whole.triangles[0][0], b = whole.triangles[0][1],
                        c = static_cast<std::uint32_t>(whole.vertices.size()), d = c + 1;
    const Vec3 along = whole.vertices[b] - whole.vertices[a];
    const Vec3 out = (0.1 * surfaceAreaMm2(whole) / along.norm()) * whole.vertices[a].normalized();
    winged.vertices.push_back(whole.vertices[a] + out);
    winged.vertices.push_back(whole.vertices[b] + out);
    winged.triangles.push_back({a, b, d});
    winged.triangles.push_back({a, d, c});
    const TriangleMesh before = winged;
    try {
        repair(winged);
        FAIL() << "lost more than a hundredth without a word";
    } catch (const core::Error& e) {
        EXPECT_THAT(e.what(), testing::HasSubstr("would lose"));
    }
    EXPECT_EQ(winged.triangles, before.triangles);

    // A ball in crumbs: each is debris, all together are not.
    TriangleMesh crumbs = test::soup(whole);
    std::mt19937_64 generator(test::seed());
    for (std::size_t v = 0; v < crumbs.vertices.size() / 2; ++v)
        crumbs.vertices[v] += 0.01 * test::randomDirection(generator);
    try {
        repair(crumbs);
        FAIL() << "half a ball was debris";
    } catch (const core::Error& e) {
        EXPECT_THAT(e.what(), testing::HasSubstr("in pieces"));
    }
}

TEST(Repair, TellsWhatItTookAway) {
    const TriangleMesh whole = sphereMesh(Vec3::Zero(), 5, 16), speck = sphereMesh({7, 0, 0}, 0.2, 3);
    TriangleMesh mesh = joined(whole, speck);
    const Triangle t = mesh.triangles[10];
    mesh.vertices.push_back(mesh.vertices[t[0]] * 1.1);
    mesh.triangles.push_back({t[0], t[1], static_cast<std::uint32_t>(mesh.vertices.size() - 1)});
    const double finMm2 = surfaceAreaMm2(mesh) - surfaceAreaMm2(whole) - surfaceAreaMm2(speck);
    const RepairReport r = repair(mesh);
    EXPECT_NEAR(r.removedFinAreaMm2, finMm2, 1e-9);
    EXPECT_NEAR(r.lostAreaMm2, finMm2, 1e-9);
    EXPECT_NEAR(r.droppedAreaMm2, surfaceAreaMm2(speck), 1e-9);
    EXPECT_NEAR(r.droppedVolumeMm3, enclosedVolumeMm3(speck), 1e-9);
    EXPECT_EQ(mesh.triangles, whole.triangles);
}

TEST(Repair, ReplacesSmallSpotsThatCross) {
    const TriangleMesh whole = sphereMesh(Vec3::Zero(), 5, 24);
    TriangleMesh mesh = whole;
    // One vertex dragged sideways through its neighbours, another through the whole ball.
    const Vec3 aside = mesh.vertices[300].cross(Vec3(0.3, 0.5, 0.8)).normalized();
    mesh.vertices[300] = (mesh.vertices[300] * 0.98 + 1.0 * aside).eval();
    mesh.vertices[900] *= -1.02;
    const RepairReport r = repair(mesh);
    EXPECT_GT(r.removedCrossingFaces, 0u);
    EXPECT_EQ(r.crossingFaces, 0u);
    EXPECT_TRUE(selfIntersections(mesh).empty());
    expectWhole(mesh);
    EXPECT_NEAR(enclosedVolumeMm3(mesh), enclosedVolumeMm3(whole), 0.01 * enclosedVolumeMm3(whole));
}

TEST(Repair, TurnsFacesWithoutHeight) {
    // A vertex in the middle of an edge, known to one side only: the other side's face is filled up with a flat one.
    TriangleMesh mesh = boxMesh({0, 0, 0}, {1, 2, 3});
    const Triangle t = mesh.triangles[0];
    mesh.vertices.push_back(0.5 * (mesh.vertices[t[0]] + mesh.vertices[t[1]]));
    mesh.triangles[0] = {t[0], 8, t[2]};
    mesh.triangles.push_back({8, t[1], t[2]});
    mesh.triangles.push_back({t[0], t[1], 8});
    EXPECT_EQ(inspect(mesh).degenerateFaces, 1u);
    const RepairReport r = repair(mesh);
    EXPECT_EQ(r.turnedFlatFaces, 1u);
    EXPECT_EQ(r.after.degenerateFaces, 0u);
    expectWhole(mesh);
    EXPECT_DOUBLE_EQ(enclosedVolumeMm3(mesh), 6.0);
    EXPECT_DOUBLE_EQ(surfaceAreaMm2(mesh), 22.0);
}

TEST(Repair, TellsOfSolidsThatOverlap) {
    TriangleMesh mesh = joined(sphereMesh(Vec3::Zero(), 5, 8), sphereMesh({3, 0.2, 0.1}, 4, 8));
    const RepairReport r = repair(mesh);
    EXPECT_GT(r.crossingFaces, 10u);
    EXPECT_EQ(r.crossingFaces, selfIntersections(mesh).size());
    EXPECT_EQ(r.removedCrossingFaces, 0u);
    expectWhole(mesh);
}

TEST(Repair, RandomDamageIsAlwaysMended) {
    std::mt19937_64 generator(test::seed());
    for (int round = 0; round < 60; ++round) {
        const TriangleMesh whole = round % 2 ? sphereMesh({3, 1, 2}, 5, 10) : test::torusMesh(5, 2, 24);
        TriangleMesh mesh = whole;
        const auto pick = [&](std::size_t n) {
            return static_cast<std::size_t>(test::uniform(generator, 0, 1) * static_cast<double>(n));
        };
        for (std::size_t i = pick(40); i > 0; --i)
            mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(pick(mesh.triangles.size())));
        for (std::size_t i = pick(20); i > 0; --i) {
            Triangle& t = mesh.triangles[pick(mesh.triangles.size())];
            std::swap(t[0], t[1]);
        }
        for (std::size_t i = pick(5); i > 0; --i)
            mesh.triangles.push_back(mesh.triangles[pick(mesh.triangles.size())]);
        for (std::size_t i = pick(5); i > 0; --i)
            mesh.triangles.push_back({static_cast<std::uint32_t>(pick(mesh.vertices.size())),
                                      static_cast<std::uint32_t>(pick(mesh.vertices.size())),
                                      static_cast<std::uint32_t>(pick(mesh.vertices.size()))});
        if (round % 3 == 0) mesh = test::soup(mesh);
        ASSERT_NO_THROW(repair(mesh)) << "round " << round;
        expectWhole(mesh);
        EXPECT_NEAR(enclosedVolumeMm3(mesh), enclosedVolumeMm3(whole), 0.1 * enclosedVolumeMm3(whole))
            << "round " << round;
    }
}

TEST(Repair, RealHandpieceHead) {
    const std::filesystem::path data = test::realDataFolder();
    if (data.empty()) GTEST_SKIP() << "no real data beside the checkout";
    TriangleMesh mesh = readMesh(data / "tools" / "contra_angle_head.stl");
    const RepairReport r = repair(mesh);
    EXPECT_EQ(r.before.openEdges, 43u);
    EXPECT_EQ(r.crossingFaces, 0u);
    expectWhole(mesh);
    EXPECT_GT(enclosedVolumeMm3(mesh), 0.0);
}

}  // namespace
}  // namespace handpiece::geometry::repair_test
