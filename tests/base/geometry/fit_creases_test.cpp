// SPDX-License-Identifier: Apache-2.0
/// @file
/// The line of a valley, in a mesh that was sampled on a grid.
#include "handpiece/base/geometry/fit_creases.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "support/random.h"

namespace handpiece::geometry::fit_creases_test {
namespace {

using core::Vec3;

/// A block with a winding groove across its top, as fissures are: flanks of 40 degrees, its floor 0.03 mm round.
struct Grooved {
    double turnRad, shiftMm;

    [[nodiscard]] double bendMm(double along) const { return 0.15 * std::sin(1.7 * along) + shiftMm; }
    [[nodiscard]] double operator()(const Vec3& p) const {
        const double c = std::cos(turnRad), s = std::sin(turnRad);
        const double along = c * p.x() + s * p.y(), across = c * p.y() - s * p.x() - bendMm(along);
        const double floor = 0.84 * (std::sqrt(across * across + 0.03 * 0.03) - 0.03);
        const double groove = 0.7 * (p.z() - std::min(floor, 0.6));
        return std::max(groove, (p - Vec3(0, 0, -2)).cwiseAbs().maxCoeff() - 2.6);
    }
    [[nodiscard]] Vec3 floorAt(double along) const {
        const double c = std::cos(turnRad), s = std::sin(turnRad), across = bendMm(along);
        return {c * along - s * across, s * along + c * across, 0.0};
    }
};

TriangleMesh meshOf(const Grooved& solid, bool isFit) {
    IsosurfaceSettings settings;
    settings.spacingMm = 0.1;
    settings.lipschitz = 1.5;
    const ScalarFunction f = [&](const Vec3& p) { return solid(p); };
    TriangleMesh mesh = isosurface({Vec3(-3, -3, -5), Vec3(3, 3, 1)}, f, settings);
    if (isFit) fitCreases(mesh, f, settings.spacingMm);
    return mesh;
}

/// How far the floor of the groove lies from the mesh [um], ascending.
std::vector<double> offUm(const Grooved& solid, const TriangleMesh& mesh) {
    const TriangleTree tree(mesh);
    std::vector<double> off;
    for (double along = -2.2; along < 2.2; along += 0.005)
        off.push_back(1e3 * tree.nearest(solid.floorAt(along)).distanceMm);
    std::sort(off.begin(), off.end());
    return off;
}

TEST(FitCreases, AValleysFloorIsALineOfTheMesh) {
    std::mt19937_64 random(test::seed());
    for (int i = 0; i < 3; ++i) {
        const Grooved solid{test::uniform(random, 0.0, 1.5), test::uniform(random, -0.1, 0.1)};
        const TriangleMesh rough = meshOf(solid, false), mesh = meshOf(solid, true);
        const std::vector<double> before = offUm(solid, rough), after = offUm(solid, mesh);
        const std::size_t most = before.size() * 95 / 100;
        EXPECT_LT(after[most], 12.0);
        EXPECT_LT(after[most], 0.7 * before[most]) << "turned by " << solid.turnRad;
        const MeshReport report = inspect(mesh);
        EXPECT_TRUE(report.closed());
        EXPECT_TRUE(report.oriented());
        EXPECT_EQ(report.nonManifoldVertices, 0u);
        EXPECT_TRUE(selfIntersections(mesh, 1).empty());
    }
}

TEST(FitCreases, LeavesWhatDoesNotBendAndGivesTheSameBytesOnAnyThreads) {
    IsosurfaceSettings settings;
    settings.spacingMm = 0.15;
    std::size_t asked = 0;
    const TriangleMesh ball = isosurface(
        {Vec3::Constant(-2.5), Vec3::Constant(2.5)}, [](const Vec3& p) { return p.norm() - 2.0; }, settings);
    TriangleMesh same = ball;
    fitCreases(
        same,
        [&](const Vec3& p) {
            ++asked;
            return p.norm() - 2.0;
        },
        settings.spacingMm);
    EXPECT_EQ(asked, 0u);
    EXPECT_EQ(same.triangles, ball.triangles);

    const Grooved solid{0.4, 0.0};
    core::setThreadCount(1);
    const TriangleMesh one = meshOf(solid, true);
    core::setThreadCount(3);
    const TriangleMesh three = meshOf(solid, true);
    core::setThreadCount(0);
    EXPECT_EQ(one.triangles, three.triangles);
    ASSERT_EQ(one.vertices.size(), three.vertices.size());
    EXPECT_EQ(std::memcmp(one.vertices.data(), three.vertices.data(), one.vertices.size() * sizeof(Vec3)), 0);
}

}  // namespace
}  // namespace handpiece::geometry::fit_creases_test
