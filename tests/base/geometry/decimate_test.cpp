// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/decimate.h"

#include <gtest/gtest.h>

#include <cstring>

#include "base/geometry/meshes.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "support/random.h"

namespace handpiece::geometry::decimate_test {
namespace {

using core::Vec3;
using test::boxMesh;
using test::sphereMesh;
using test::torusMesh;

void expectClosedManifold(const TriangleMesh& mesh, std::int64_t genus) {
    const MeshReport report = inspect(mesh);
    EXPECT_TRUE(report.closed());
    EXPECT_TRUE(report.oriented());
    EXPECT_EQ(report.nonManifoldVertices, 0u);
    EXPECT_EQ(report.degenerateFaces, 0u);
    EXPECT_EQ(report.unusedVertices, 0u);
    EXPECT_EQ(report.genus, genus);
}

double distanceToSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    return (p - a - t * (b - a)).norm();
}

/// Distance to a triangle: the plane where the foot lies inside, else the sides.
double distanceTo(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 n = (b - a).cross(c - a).normalized();
    if (n.dot((b - a).cross(p - a)) >= 0 && n.dot((c - b).cross(p - b)) >= 0 && n.dot((a - c).cross(p - c)) >= 0)
        return std::abs(n.dot(p - a));
    return std::min({distanceToSegment(p, a, b), distanceToSegment(p, b, c), distanceToSegment(p, c, a)});
}

double largestDistance(const TriangleMesh& from, const TriangleMesh& to) {
    double largest = 0.0;
    for (const Vec3& p : from.vertices) {
        double best = INFINITY;
        for (const Triangle& t : to.triangles)
            best = std::min(best, distanceTo(p, to.vertices[t[0]], to.vertices[t[1]], to.vertices[t[2]]));
        largest = std::max(largest, best);
    }
    return largest;
}

/// A box whose sides are grids of n x n squares.
TriangleMesh griddedBox(double edge, std::uint32_t n) {
    TriangleMesh mesh;
    std::map<std::array<std::uint32_t, 3>, std::uint32_t> number;
    const auto vertex = [&](const std::array<std::uint32_t, 3>& at) {
        const auto [place, isNew] = number.try_emplace(at, static_cast<std::uint32_t>(mesh.vertices.size()));
        if (isNew) mesh.vertices.push_back(Vec3(at[0], at[1], at[2]) * (edge / n));
        return place->second;
    };
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const bool high : {false, true})
            for (std::uint32_t i = 0; i < n; ++i)
                for (std::uint32_t j = 0; j < n; ++j) {
                    const auto at = [&](std::uint32_t u, std::uint32_t v) {
                        std::array<std::uint32_t, 3> place{};
                        place[axis] = high ? n : 0;
                        place[(axis + 1) % 3] = u;
                        place[(axis + 2) % 3] = v;
                        return vertex(place);
                    };
                    const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
                    if (high) {
                        mesh.triangles.push_back({a, b, c});
                        mesh.triangles.push_back({a, c, d});
                    } else {
                        mesh.triangles.push_back({a, c, b});
                        mesh.triangles.push_back({a, d, c});
                    }
                }
    return mesh;
}

TEST(Decimate, GivesExactlyTheFacesAskedFor) {
    const TriangleMesh ball = sphereMesh({1, 2, 3}, 5, 20);  // 3200 faces
    for (const std::size_t target : {3198u, 1600u, 501u, 100u, 20u}) {
        const TriangleMesh fewer = decimate(ball, target).mesh;
        EXPECT_EQ(fewer.triangles.size(), target + target % 2);
        EXPECT_EQ(fewer.vertices.size(), fewer.triangles.size() / 2 + 2) << "Euler";
        expectClosedManifold(fewer, 0);
    }
    const Decimated same = decimate(ball, 4000);
    EXPECT_EQ(same.mesh.triangles, ball.triangles);
    EXPECT_EQ(same.errorBoundMm, 0.0);
}

TEST(Decimate, KeepsVolumeAreaAndShape) {
    const TriangleMesh ball = sphereMesh(Vec3::Zero(), 5, 60);  // 28800 faces
    const Decimated fewer = decimate(ball, 7200);
    EXPECT_NEAR(enclosedVolumeMm3(fewer.mesh) / enclosedVolumeMm3(ball), 1.0, 1e-3);
    EXPECT_NEAR(surfaceAreaMm2(fewer.mesh) / surfaceAreaMm2(ball), 1.0, 2e-3);
    for (const Triangle& t : fewer.mesh.triangles) {
        const Vec3 &a = fewer.mesh.vertices[t[0]], &b = fewer.mesh.vertices[t[1]], &c = fewer.mesh.vertices[t[2]];
        ASSERT_GT((b - a).cross(c - a).normalized().dot(((a + b + c) / 3.0).normalized()), 0.9) << "no face turns over";
    }
}

TEST(Decimate, KeepsTheHoleOfATorus) {
    const TriangleMesh ring = torusMesh(5, 2, 48);
    for (const std::size_t target : {2000u, 400u, 60u}) {
        const Decimated fewer = decimate(ring, target);
        EXPECT_EQ(fewer.mesh.triangles.size(), target);
        expectClosedManifold(fewer.mesh, 1);
    }
    const TriangleMesh fine = torusMesh(5, 2, 120);
    EXPECT_NEAR(enclosedVolumeMm3(decimate(fine, 14400).mesh) / enclosedVolumeMm3(fine), 1.0, 1e-3);
}

TEST(Decimate, ItsErrorBoundIsOneByBruteForce) {
    std::mt19937_64 random(test::seed());
    TriangleMesh lumpy = sphereMesh(Vec3::Zero(), 4, 16);  // 2048 faces
    for (Vec3& v : lumpy.vertices)
        v *= 1.0 + 0.08 * std::sin(2.0 * v.x()) * std::sin(1.5 * v.y()) + test::uniform(random, -0.004, 0.004);
    for (const std::size_t target : {1200u, 500u, 120u}) {
        const Decimated fewer = decimate(lumpy, target);
        const double truth = largestDistance(lumpy, fewer.mesh);
        EXPECT_GE(fewer.errorBoundMm, truth - 1e-12);
        EXPECT_LE(fewer.errorBoundMm, 2.0 * truth + 1e-3) << "a bound, but a useful one";
        expectClosedManifold(fewer.mesh, 0);
    }
}

TEST(Decimate, FlatPlacesCostNextToNothing) {
    const TriangleMesh box = griddedBox(3.0, 10);  // 1200 faces
    ASSERT_TRUE(inspect(box).closed());
    const Decimated fewer = decimate(box, 12);
    EXPECT_EQ(fewer.mesh.triangles.size(), 12u);
    EXPECT_EQ(fewer.mesh.vertices.size(), 8u);
    // Every place is drawn a little to the middle of its last edge: up to 0.3 % of the box's edge.
    EXPECT_NEAR(enclosedVolumeMm3(fewer.mesh), 27.0, 0.1);
    EXPECT_LT(fewer.errorBoundMm, 0.01);
    EXPECT_LE(largestDistance(box, fewer.mesh), fewer.errorBoundMm + 1e-12);
}

TEST(Decimate, GivesTheSameBytesAtAnyThreadCount) {
    const TriangleMesh ring = torusMesh(5, 2, 40);
    core::setThreadCount(1);
    const Decimated one = decimate(ring, 500);
    core::setThreadCount(3);
    const Decimated three = decimate(ring, 500);
    core::setThreadCount(0);
    EXPECT_EQ(one.mesh.triangles, three.mesh.triangles);
    ASSERT_EQ(one.mesh.vertices.size(), three.mesh.vertices.size());
    EXPECT_EQ(
        std::memcmp(one.mesh.vertices.data(), three.mesh.vertices.data(), one.mesh.vertices.size() * sizeof(Vec3)), 0);
    EXPECT_EQ(one.errorBoundMm, three.errorBoundMm);
}

TEST(Decimate, SheetsThatLieCloseDoNotComeToCross) {
    // A hollow ball, its wall thin on one side.
    TriangleMesh shell = sphereMesh(Vec3::Zero(), 2.0, 48);
    const TriangleMesh inside = sphereMesh(Vec3(0.25, 0.0, 0.0), 1.742, 40);
    const auto first = static_cast<std::uint32_t>(shell.vertices.size());
    shell.vertices.insert(shell.vertices.end(), inside.vertices.begin(), inside.vertices.end());
    for (const Triangle& t : inside.triangles)
        shell.triangles.push_back({first + t[0], first + t[2], first + t[1]});
    ASSERT_TRUE(selfIntersections(shell).empty());
    constexpr std::size_t kFaces = 500;
    EXPECT_FALSE(selfIntersections(decimate(shell, kFaces).mesh).empty()) << "nothing to be avoided";
    const std::optional<TriangleMesh> made = decimateUncrossed(shell, kFaces, 0.6);
    ASSERT_TRUE(made);
    EXPECT_LT(made->triangles.size(), shell.triangles.size() / 2);
    EXPECT_TRUE(selfIntersections(*made).empty());
    EXPECT_TRUE(inspect(*made).closed());
    EXPECT_EQ(inspect(*made).shells, 2u);
}

TEST(Decimate, RefusesWhatIsNotASurface) {
    const TriangleMesh ball = sphereMesh(Vec3::Zero(), 5, 6);
    EXPECT_THROW((void)decimate(ball, 3), core::Error);
    TriangleMesh open = ball;
    open.triangles.pop_back();
    EXPECT_THROW((void)decimate(open, 100), core::Error);
    TriangleMesh flipped = ball;
    std::swap(flipped.triangles[7][0], flipped.triangles[7][1]);
    EXPECT_THROW((void)decimate(flipped, 100), core::Error);
    EXPECT_THROW((void)decimate(ball, 20, [](double) { return false; }), core::Error) << "cancelled";
}

}  // namespace
}  // namespace handpiece::geometry::decimate_test
