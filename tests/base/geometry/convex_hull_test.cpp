// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/convex_hull.h"

#include <gtest/gtest.h>

#include <map>

#include "base/geometry/convex_shapes.h"
#include "handpiece/base/core/error.h"

namespace handpiece::geometry::convex_hull_test {
namespace {

using core::Vec3;
using test::uniform;

double farthest(const std::vector<Vec3>& points, const Vec3& direction) {
    double best = -1e300;
    for (const Vec3& p : points)
        best = std::max(best, p.dot(direction));
    return best;
}

// Climbing must reach what a scan of every given point reaches, from any start.
void expectSupportIsExact(const std::vector<Vec3>& points, std::mt19937_64& generator, int directions) {
    const ConvexHull hull{std::span<const Vec3>(points)};
    double size = 0.0;
    for (const Vec3& p : points)
        size = std::max(size, p.norm());
    const auto check = [&](const Vec3& d, std::uint32_t start) {
        const double got = hull.vertex(hull.support(d, start)).dot(d), want = farthest(points, d);
        ASSERT_NEAR(got, want, 1e-12 * size * d.norm()) << "direction " << d.transpose() << " from " << start;
    };
    for (int i = 0; i < directions; ++i) {
        const auto start = static_cast<std::uint32_t>(generator() % hull.vertexCount());
        const Vec3 d = test::randomDirection(generator) * uniform(generator, 1e-3, 1e3);
        check(d, kNoVertex);
        check(d, start);
    }
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z)
                if (x != 0 || y != 0 || z != 0)
                    check(Vec3(x, y, z), static_cast<std::uint32_t>(generator() % hull.vertexCount()));
    // Along facet normals, where three or more vertices tie.
    for (std::size_t i = 0; i < hull.mesh().triangles.size(); i += 1 + hull.mesh().triangles.size() / 200) {
        const Triangle& t = hull.mesh().triangles[i];
        const Vec3 n = (hull.vertex(t[1]) - hull.vertex(t[0])).cross(hull.vertex(t[2]) - hull.vertex(t[0]));
        if (n.norm() > 0.0) check(n.normalized(), static_cast<std::uint32_t>(generator() % hull.vertexCount()));
    }
}

// Closed, facing outwards, every given point inside, every edge used once each way.
void expectIsHull(const std::vector<Vec3>& points) {
    const ConvexHull hull{std::span<const Vec3>(points)};
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    double size = 0.0;
    for (const Vec3& p : points)
        size = std::max(size, p.norm());
    for (const Triangle& t : hull.mesh().triangles) {
        for (std::size_t i = 0; i < 3; ++i)
            ++edges[{t[i], t[(i + 1) % 3]}];
        const Vec3 n = (hull.vertex(t[1]) - hull.vertex(t[0])).cross(hull.vertex(t[2]) - hull.vertex(t[0]));
        if (n.norm() < 1e-9 * size * size) continue;
        for (const Vec3& p : points)
            ASSERT_LE(n.normalized().dot(p - hull.vertex(t[0])), 1e-9 * size);
    }
    for (const auto& [edge, uses] : edges) {
        EXPECT_EQ(uses, 1);
        EXPECT_TRUE(edges.contains({edge.second, edge.first}));
    }
    EXPECT_EQ(hull.vertexCount() + hull.mesh().triangles.size(), edges.size() / 2 + 2) << "Euler";
    EXPECT_GT(enclosedVolumeMm3(hull.mesh()), 0.0);
}

TEST(ConvexHull, ofABoxWithPointsInsideAndOnItsFacesIsTheBox) {
    std::vector<Vec3> points = test::boxCorners({1, 2, 3});
    points.insert(points.end(), {Vec3::Zero(), Vec3(1, 0, 0), Vec3(0.3, 2, -1), Vec3(0.1, 0.2, 0.3)});
    const ConvexHull hull{std::span<const Vec3>(points)};
    EXPECT_EQ(hull.vertexCount(), 8u);
    EXPECT_EQ(hull.mesh().triangles.size(), 12u);
    EXPECT_NEAR(enclosedVolumeMm3(hull.mesh()), 48.0, 1e-12);
    EXPECT_NEAR(surfaceAreaMm2(hull.mesh()), 88.0, 1e-12);
    for (std::uint32_t i = 0; i < 8; ++i)
        EXPECT_GE(hull.neighbours(i).size(), 3u);
}

TEST(ConvexHull, isClosedConvexAndFacesOutwards) {
    std::mt19937_64 generator(test::seed());
    expectIsHull(test::boxCorners({1, 1, 1}));
    expectIsHull(test::roundEndedCylinder(0.5, 4));
    for (int i = 0; i < 10; ++i)
        expectIsHull(test::randomEllipsoid(generator, 10 + 30 * i));
}

TEST(ConvexHull, supportFindsTheFarthestPointOfRandomHulls) {
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 100; ++i)
        expectSupportIsExact(test::randomEllipsoid(generator, 4 + static_cast<int>(generator() % 400)), generator, 300);
}

TEST(ConvexHull, supportIsExactOnShapesWithFlatSidesAndTies) {
    std::mt19937_64 generator(test::seed());
    expectSupportIsExact(test::boxCorners({1, 2, 3}), generator, 2000);
    expectSupportIsExact(test::roundEndedCylinder(0.5, 4), generator, 5000);
    std::vector<Vec3> grid;  // facets with hundreds of points in one plane
    for (int x = 0; x < 13; ++x)
        for (int y = 0; y < 13; ++y)
            for (int z = 0; z < 2; ++z)
                grid.emplace_back(0.1 * x, 0.1 * y, 0.1 * z);
    expectSupportIsExact(grid, generator, 2000);
    const core::Quat turn = test::randomRotation(generator);
    for (Vec3& p : grid)
        p = turn * p + Vec3(10, -20, 5);
    expectSupportIsExact(grid, generator, 2000);
}

TEST(ConvexHull, supportIsExactOnALargeBumpyHull) {
    std::mt19937_64 generator(test::seed());
    expectSupportIsExact(test::bumpySphere(20000, 5.0, 0.0), generator, 1000);
    expectSupportIsExact(test::bumpySphere(20000, 5.0, 0.05), generator, 1000);
}

TEST(ConvexHull, refusesPointsWithoutVolume) {
    const auto hullOf = [](const std::vector<Vec3>& points) { return ConvexHull{std::span<const Vec3>(points)}; };
    EXPECT_THROW(hullOf({}), core::Error);
    EXPECT_THROW(hullOf({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}), core::Error);
    EXPECT_THROW(hullOf({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, 1, 0), Vec3(2, 1, 0)}), core::Error);
    EXPECT_THROW(hullOf(std::vector<Vec3>(10, Vec3(1, 2, 3))), core::Error);
    EXPECT_THROW(hullOf({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, std::nan(""))}), core::Error);
}

}  // namespace
}  // namespace handpiece::geometry::convex_hull_test
