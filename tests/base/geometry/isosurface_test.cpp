// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/isosurface.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstring>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/inspect.h"
#include "support/random.h"

namespace handpiece::geometry::isosurface_test {
namespace {

using core::Vec3;

void expectClosedManifold(const TriangleMesh& mesh) {
    const MeshReport report = inspect(mesh);
    EXPECT_TRUE(report.closed()) << report.openEdges << " open, " << report.nonManifoldEdges << " forked edges";
    EXPECT_TRUE(report.oriented()) << report.flippedFaces << " flipped, " << report.insideOutShells << " inside out";
    EXPECT_EQ(report.nonManifoldVertices, 0u);
    EXPECT_EQ(report.unusedVertices, 0u);
}

bool sameBytes(const TriangleMesh& a, const TriangleMesh& b) {
    return a.triangles == b.triangles && a.vertices.size() == b.vertices.size() &&
           std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof(Vec3)) == 0;
}

double torus(const Vec3& p) {
    return std::hypot(std::hypot(p.x(), p.y()) - 4.0, p.z()) - 1.5;
}

TEST(Isosurface, SphereHasItsVolumeItsAreaAndItsPoints) {
    const Vec3 centre(0.31, -0.17, 0.23);
    double lastError = 1.0;
    for (const double spacing : {0.4, 0.2, 0.1}) {
        IsosurfaceSettings settings;
        settings.spacingMm = spacing;
        const TriangleMesh mesh = isosurface(
            {Vec3::Constant(-4), Vec3::Constant(4)}, [&](const Vec3& p) { return (p - centre).norm() - 3.0; },
            settings);
        expectClosedManifold(mesh);
        EXPECT_EQ(inspect(mesh).genus, 0);
        for (const Vec3& v : mesh.vertices)
            ASSERT_NEAR((v - centre).norm(), 3.0, 2e-3 * spacing * spacing);
        // The chords of a sphere cost a share of about (spacing / radius)^2 / 6.
        const double error = std::abs(enclosedVolumeMm3(mesh) / (4.0 / 3.0 * M_PI * 27.0) - 1.0);
        EXPECT_LT(error, spacing * spacing / 9.0 / 2.0);
        EXPECT_LT(error, 0.35 * lastError) << "second order";
        EXPECT_NEAR(surfaceAreaMm2(mesh), 4.0 * M_PI * 9.0, 4.0 * M_PI * 9.0 * spacing * spacing / 9.0);
        lastError = error;
    }
}

TEST(Isosurface, TorusKeepsItsHole) {
    IsosurfaceSettings settings;
    settings.spacingMm = 0.15;
    const TriangleMesh mesh = isosurface({{-6, -6, -2}, {6, 6, 2}}, torus, settings);
    expectClosedManifold(mesh);
    const MeshReport report = inspect(mesh);
    EXPECT_EQ(report.shells, 1u);
    EXPECT_EQ(report.genus, 1);
    EXPECT_NEAR(report.volumeMm3, 2.0 * M_PI * M_PI * 4.0 * 2.25, 0.005 * 2.0 * M_PI * M_PI * 4.0 * 2.25);
    EXPECT_NEAR(report.areaMm2, 4.0 * M_PI * M_PI * 4.0 * 1.5, 0.005 * 4.0 * M_PI * M_PI * 4.0 * 1.5);
}

TEST(Isosurface, IsClosedAndManifoldOnRandomNoise) {
    std::mt19937_64 random(test::seed());
    for (int round = 0; round < 12; ++round) {
        const std::array<std::uint32_t, 3> nodes{static_cast<std::uint32_t>(1 + random() % 21),
                                                 static_cast<std::uint32_t>(1 + random() % 21),
                                                 static_cast<std::uint32_t>(1 + random() % 21)};
        std::vector<float> values(std::size_t{nodes[0]} * nodes[1] * nodes[2]);
        // Coarse steps: many nodes are exactly zero, or equal to their neighbours.
        const double steps = round % 2 == 0 ? 3.0 : 1e6;
        for (float& v : values)
            v = static_cast<float>(std::round(test::uniform(random, -1.0, 1.0) * steps) / steps);
        values[0] = -1.0f;
        const ScalarGrid grid{{1.0, 2.0, 3.0}, 0.5, nodes, values};
        const TriangleMesh mesh = isosurface(grid);
        SCOPED_TRACE(testing::Message() << "round " << round << ", " << nodes[0] << " x " << nodes[1] << " x "
                                        << nodes[2] << " nodes");
        ASSERT_FALSE(mesh.triangles.empty());
        expectClosedManifold(mesh);
        EXPECT_GT(enclosedVolumeMm3(mesh), 0.0);
        // Inside and outside nodes really are separated: the winding number at every node, by solid angles.
        if (values.size() > 400) continue;
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (values[i] == 0.0f) continue;
            const Vec3 p = grid.originMm + 0.5 * Vec3(static_cast<double>(i % nodes[0]),
                                                      static_cast<double>(i / nodes[0] % nodes[1]),
                                                      static_cast<double>(i / nodes[0] / nodes[1]));
            double angle = 0.0;
            for (const Triangle& t : mesh.triangles) {
                const Vec3 a = mesh.vertices[t[0]] - p, b = mesh.vertices[t[1]] - p, c = mesh.vertices[t[2]] - p;
                const double la = a.norm(), lb = b.norm(), lc = c.norm();
                angle += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
            }
            ASSERT_NEAR(angle / (2.0 * M_PI), values[i] < 0.0f ? 1.0 : 0.0, 1e-6) << "node " << i;
        }
    }
}

TEST(Isosurface, GivesTheSameBytesAtAnyThreadCount) {
    IsosurfaceSettings settings;
    settings.spacingMm = 0.13;
    settings.lipschitz = 3.0;
    const auto f = [](const Vec3& p) { return torus(p) + 0.3 * std::sin(3.0 * p.x()) * std::sin(2.0 * p.y() + p.z()); };
    std::vector<TriangleMesh> meshes;
    for (const std::size_t threads : {1u, 2u, 5u, 2u}) {
        core::setThreadCount(threads);
        meshes.push_back(isosurface({{-7, -7, -3}, {7, 7, 3}}, f, settings));
    }
    core::setThreadCount(0);
    for (std::size_t i = 1; i < meshes.size(); ++i)
        EXPECT_TRUE(sameBytes(meshes[0], meshes[i])) << i;
}

TEST(Isosurface, LipschitzSkippingLosesNothing) {
    IsosurfaceSettings sharp, blind;
    sharp.spacingMm = blind.spacingMm = 0.2;
    blind.lipschitz = 1e9;  // nothing can be skipped
    const core::Box box{{-6, -6, -2}, {6, 6, 2}};
    EXPECT_TRUE(sameBytes(isosurface(box, torus, sharp), isosurface(box, torus, blind)));
}

TEST(Isosurface, FollowsASurfaceThatIsSteeperThanUsual) {
    // A tube that winds: four times as steep as a distance in one half of space, a third as steep in the other.
    const auto tube = [](const Vec3& p) {
        const double ring = std::hypot(std::hypot(p.x(), p.y()) - 3.0, p.z()) - 0.9;
        return (p.x() > 0.0 ? 4.0 : 1.0 / 3.0) * ring;
    };
    IsosurfaceSettings byBound, guessed;
    byBound.spacingMm = guessed.spacingMm = 0.07;
    byBound.lipschitz = guessed.lipschitz = 4.0;
    guessed.usualSlope = 0.5;
    std::atomic<long> asked{0};
    const auto counted = [&](const Vec3& p) {
        ++asked;
        return tube(p);
    };
    const core::Box box{Vec3::Constant(-4.5), Vec3::Constant(4.5)};
    const TriangleMesh full = isosurface(box, counted, byBound);
    const long askedByBound = asked.exchange(0);
    const TriangleMesh quick = isosurface(box, counted, guessed);
    EXPECT_LT(asked, askedByBound / 2);
    EXPECT_EQ(quick.triangles.size(), full.triangles.size());
    EXPECT_NEAR(enclosedVolumeMm3(quick), enclosedVolumeMm3(full), 1e-9);
    EXPECT_TRUE(inspect(quick).closed());
}

TEST(Isosurface, CutsOffAtTheBox) {
    // A ball of radius 3 in a box that ends 1 mm above its centre.
    IsosurfaceSettings settings;
    settings.spacingMm = 0.1;
    settings.project = false;
    settings.relaxations = 0;
    const core::Box box{Vec3::Constant(-4.0), Vec3(4.0, 4.0, 1.0)};
    const TriangleMesh mesh = isosurface(
        box, [](const Vec3& p) { return p.norm() - 3.0; }, settings);
    expectClosedManifold(mesh);
    EXPECT_EQ(inspect(mesh).genus, 0);
    const double top = mesh.bounds().max.z();
    EXPECT_NEAR(top, 1.0, 2.0 * settings.spacingMm);
    const auto below = [](double z) { return M_PI * (z + 3.0) * (z + 3.0) * (9.0 - (z + 3.0)) / 3.0; };
    EXPECT_LT(enclosedVolumeMm3(mesh), below(top));
    EXPECT_GT(enclosedVolumeMm3(mesh), 0.998 * below(top - settings.spacingMm)) << "within a cell of the box";
}

TEST(Isosurface, EmptyWhereNothingIsInside) {
    EXPECT_TRUE(isosurface(
                    {Vec3::Zero(), Vec3::Ones()}, [](const Vec3&) { return 1.0; }, IsosurfaceSettings{})
                    .triangles.empty());
}

TEST(Isosurface, RefusesWhatMakesNoSense) {
    const auto ball = [](const Vec3& p) { return p.norm() - 1.0; };
    const core::Box box{Vec3::Constant(-2), Vec3::Constant(2)};
    EXPECT_THROW((void)isosurface(core::Box{}, ball, IsosurfaceSettings{}), core::Error);
    EXPECT_THROW((void)isosurface({Vec3::Constant(-2), Vec3(1, 1, INFINITY)}, ball, IsosurfaceSettings{}), core::Error);
    for (const double spacing : {0.0, -0.1, static_cast<double>(NAN)}) {
        IsosurfaceSettings settings;
        settings.spacingMm = spacing;
        EXPECT_THROW((void)isosurface(box, ball, settings), core::Error) << spacing;
    }
    IsosurfaceSettings flat;
    flat.lipschitz = 0.0;
    EXPECT_THROW((void)isosurface(box, ball, flat), core::Error);
    const std::vector<float> values(7);
    EXPECT_THROW((void)isosurface(ScalarGrid{Vec3::Zero(), 1.0, {2, 2, 2}, values}), core::Error);
    EXPECT_THROW((void)isosurface(box, ball, IsosurfaceSettings{}, [](double) { return false; }), core::Error)
        << "cancelled";
}

}  // namespace
}  // namespace handpiece::geometry::isosurface_test
