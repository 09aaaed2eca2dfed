// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/triangle_tree.h"

#include <gtest/gtest.h>

#include <set>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/points_beyond.h"
#include "support/closed_meshes.h"
#include "support/random.h"

namespace handpiece::geometry::triangle_tree_test {
namespace {

using core::Vec3;
using test::uniform;

Vec3 randomPoint(std::mt19937_64& g, double extent) {
    return {uniform(g, -extent, extent), uniform(g, -extent, extent), uniform(g, -extent, extent)};
}

TriangleMesh soup(std::mt19937_64& g, int count, double size) {
    TriangleMesh mesh;
    for (int i = 0; i < count; ++i) {
        const Vec3 at = randomPoint(g, 3.0);
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (int k = 0; k < 3; ++k)
            mesh.vertices.push_back(at + randomPoint(g, size));
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

void expectExact(const TriangleMesh& mesh, std::mt19937_64& g, int points, double extent) {
    const TriangleTree tree(mesh);
    for (int i = 0; i < points; ++i) {
        const Vec3 p = randomPoint(g, extent);
        const double truth = test::distanceToMesh(p, mesh);
        const NearestPoint n = tree.nearest(p);
        ASSERT_NE(n.triangle, kNoTriangle);
        EXPECT_NEAR(n.distanceMm, truth, 1e-11) << p.transpose();
        EXPECT_NEAR((n.pointMm - p).norm(), truth, 1e-11);
        // The point lies on the triangle it names, in the order of the given mesh.
        const Triangle& t = mesh.triangles[tree.triangles()[n.triangle].index];
        EXPECT_LT(test::distanceToTriangle(n.pointMm, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]),
                  1e-9);
        if (n.feature >= 4) {
            EXPECT_LT((n.pointMm - mesh.vertices[t[n.feature - 4u]]).norm(), 1e-12);
        }
        if (n.feature >= 1 && n.feature <= 3) {
            EXPECT_LT(
                test::distanceToSegment(n.pointMm, mesh.vertices[t[n.feature - 1u]], mesh.vertices[t[n.feature % 3u]]),
                1e-9);
        }
    }
}

TEST(TriangleTree, NearestEqualsBruteForceOnSoups) {
    std::mt19937_64 g(test::seed());
    for (const int count : {1, 2, 4, 5, 31, 500, 6000})
        expectExact(soup(g, count, 0.3), g, 200, 5.0);
    expectExact(soup(g, 300, 3.0), g, 300, 5.0);
    expectExact(soup(g, 3000, 0.01), g, 300, 50.0);
}

TEST(TriangleTree, NearestEqualsBruteForceFarFromTheOrigin) {
    std::mt19937_64 g(test::seed());
    TriangleMesh mesh = soup(g, 1500, 0.05);
    for (Vec3& v : mesh.vertices)
        v += Vec3(400.0, -300.0, 900.0);
    const TriangleTree tree(mesh);
    for (int i = 0; i < 300; ++i) {
        const Vec3 p = Vec3(400.0, -300.0, 900.0) + randomPoint(g, 5.0);
        EXPECT_NEAR(tree.nearest(p).distanceMm, test::distanceToMesh(p, mesh), 1e-9);
    }
}

TEST(TriangleTree, DegenerateTrianglesAreSegmentsAndPoints) {
    std::mt19937_64 g(test::seed());
    TriangleMesh mesh;
    for (int i = 0; i < 400; ++i) {
        const Vec3 a = randomPoint(g, 2.0), d = randomPoint(g, 1.0);
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        switch (i % 5) {
            case 0:
                mesh.vertices.insert(mesh.vertices.end(), {a, a, a});
                break;  // a point
            case 1:
                mesh.vertices.insert(mesh.vertices.end(), {a, a, a + d});
                break;  // a segment
            case 2:
                mesh.vertices.insert(mesh.vertices.end(), {a, a + d, a + 0.3 * d});
                break;  // folded
            case 3:
                mesh.vertices.insert(mesh.vertices.end(), {a, a + d, a + 0.5 * d + randomPoint(g, 1e-9)});
                break;
            default:
                mesh.vertices.insert(mesh.vertices.end(), {a, a + d, a + 0.5 * d + randomPoint(g, 1e-4)});
                break;
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    const TriangleTree tree(mesh);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 p = randomPoint(g, 3.0);
        // A sliver 1e-9 high is as good as its longest edge.
        EXPECT_NEAR(tree.nearest(p).distanceMm, test::distanceToMesh(p, mesh), 2e-9);
    }
}

TEST(TriangleTree, AllTrianglesInOnePlaceStillBuild) {
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles.assign(20000, {0, 1, 2});
    const TriangleTree tree(mesh);
    EXPECT_NEAR(tree.nearest({0.2, 0.2, 1.5}).distanceMm, 1.5, 1e-12);
}

TEST(TriangleTree, SeedsAndBoundsDoNotChangeAnswers) {
    std::mt19937_64 g(test::seed());
    const TriangleMesh mesh = test::bumpyMesh(4, 4.0);
    const TriangleTree tree(mesh);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 p = randomPoint(g, 6.0);
        const double plain = tree.signedDistance(p);
        const auto seed = static_cast<std::uint32_t>(g() % mesh.triangles.size());
        EXPECT_NEAR(tree.signedDistance(p, nullptr, seed), plain, 1e-12);
        EXPECT_NEAR(tree.nearest(p, std::abs(plain) + 1e-9, seed).distanceMm, std::abs(plain), 1e-12);
        const NearestPoint none = tree.nearest(p, std::abs(plain) - 1e-9, seed);
        EXPECT_EQ(none.triangle, kNoTriangle);
    }
    EXPECT_EQ(tree.nearest({0, 0, 0}, std::numeric_limits<double>::infinity(), 0xfffffff0u).triangle,
              tree.nearest({0, 0, 0}).triangle);
}

TEST(TriangleTree, SignAgreesWithTheWindingNumber) {
    std::mt19937_64 g(test::seed());
    for (const TriangleMesh& mesh : {test::bumpyMesh(4, 4.0), test::boxMesh({-3, -2, -1}, {3, 2, 0.5})}) {
        const TriangleTree tree(mesh);
        for (int i = 0; i < 1500; ++i) {
            const Vec3 p = randomPoint(g, 5.5);
            const double truth = test::windingByBruteForce(p, mesh);
            NearestPoint n;
            const double d = tree.signedDistance(p, &n);
            EXPECT_EQ(d<0.0, truth> 0.5) << p.transpose();
            EXPECT_EQ(tree.side(p, n), d < 0.0 ? -1.0 : 1.0);
        }
    }
}

TEST(TriangleTree, SignIsRightBesideSharpEdgesAndCorners) {
    std::mt19937_64 g(test::seed());
    // A needle-sharp pyramid: the nearest feature is nearly always an edge or a corner.
    TriangleMesh mesh;
    mesh.vertices = {{-0.1, -0.1, 0}, {0.1, -0.1, 0}, {0.1, 0.1, 0}, {-0.1, 0.1, 0}, {0, 0, 5}};
    mesh.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {0, 2, 1}, {0, 3, 2}};
    const TriangleTree tree(mesh);
    for (int i = 0; i < 5000; ++i) {
        const Vec3 p(uniform(g, -0.3, 0.3), uniform(g, -0.3, 0.3), uniform(g, -0.3, 5.3));
        EXPECT_EQ(tree.signedDistance(p) < 0.0, test::windingByBruteForce(p, mesh) > 0.5) << p.transpose();
    }
}

TEST(TriangleTree, EveryTriangleLiesInItsBoxesAndDepthIsBounded) {
    std::mt19937_64 g(test::seed());
    TriangleMesh mesh = soup(g, 5000, 0.2);
    // Sizes over nine decades, so that surface-area splits are as lopsided as they get.
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
        mesh.vertices[i] *= std::pow(10.0, -9.0 * static_cast<double>(i / 3) / 5000.0);
    const TriangleTree tree(mesh);
    std::vector<int> depth(tree.nodes().size(), 0);
    std::set<std::uint32_t> seen;
    depth[0] = 1;
    for (std::size_t i = 0; i < tree.nodes().size(); ++i) {
        const TreeNode& node = tree.nodes()[i];
        EXPECT_LE(depth[i], kMaxTreeDepth);
        for (int lane = 0; lane < 8; ++lane) {
            if (lane >= node.lanes) {
                EXPECT_GT(node.minX[lane], node.maxX[lane]);
            } else if (node.child[lane] >= 0) {
                ASSERT_GT(static_cast<std::size_t>(node.child[lane]), i);
                depth[static_cast<std::size_t>(node.child[lane])] = depth[i] + 1;
            } else {
                EXPECT_LE(node.count[lane], kMaxLeafTriangles);
                for (std::uint32_t k = 0; k < node.count[lane]; ++k) {
                    const TreeTriangle& t = tree.triangles()[static_cast<std::uint32_t>(~node.child[lane]) + k];
                    EXPECT_TRUE(seen.insert(t.index).second);
                    for (const std::uint32_t v : mesh.triangles[t.index]) {
                        const Vec3& p = mesh.vertices[v];
                        EXPECT_TRUE(p.x() > node.minX[lane] && p.x() < node.maxX[lane] && p.y() > node.minY[lane] &&
                                    p.y() < node.maxY[lane] && p.z() > node.minZ[lane] && p.z() < node.maxZ[lane]);
                    }
                }
            }
        }
    }
    EXPECT_EQ(seen.size(), mesh.triangles.size());
}

TEST(TriangleTree, TheSameTreeAtAnyThreadCount) {
    const TriangleMesh mesh = test::bumpyMesh(5, 4.0);
    core::setThreadCount(1);
    const TriangleTree one(mesh);
    core::setThreadCount(4);
    const TriangleTree four(mesh);
    core::setThreadCount(0);
    ASSERT_EQ(one.nodes().size(), four.nodes().size());
    for (std::size_t i = 0; i < one.nodes().size(); ++i) {
        EXPECT_TRUE(std::equal(one.nodes()[i].child, one.nodes()[i].child + 8, four.nodes()[i].child));
        EXPECT_TRUE(std::equal(one.nodes()[i].maxZ, one.nodes()[i].maxZ + 8, four.nodes()[i].maxZ));
    }
    for (std::size_t i = 0; i < one.triangles().size(); ++i)
        ASSERT_EQ(one.triangles()[i].index, four.triangles()[i].index);
    EXPECT_EQ(one.pseudonormals(), four.pseudonormals());
}

TEST(TriangleTree, RefusesWhatIsNoMesh) {
    EXPECT_THROW(TriangleTree(TriangleMesh{}), core::Error);
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 3}};
    EXPECT_THROW(TriangleTree{mesh}, core::Error);
    mesh.triangles = {{0, 1, 2}};
    mesh.vertices[2].x() = std::nan("");
    EXPECT_THROW(TriangleTree{mesh}, core::Error);
}

// What is skipped because a neighbour is far from the limit must not matter.
TEST(PointsBeyond, AreThoseOfEachDistance) {
    std::mt19937_64 g(test::seed());
    const TriangleTree tree(test::bumpyMesh(3, 2.0));
    std::vector<Vec3> points;
    Vec3 p = Vec3::Zero();  // a walk in steps of very different length, in and out of the surface
    for (int i = 0; i < 4000; ++i) {
        p += (i % 5 == 0 ? 0.8 : 0.05) * randomPoint(g, 1.0);
        if (p.norm() > 4.0) p *= 0.4;
        points.push_back(p);
    }
    for (const double sign : {1.0, -1.0})
        for (const double mostMm : {0.1, 0.0, -0.3}) {
            std::vector<std::uint32_t> truth;
            for (std::uint32_t i = 0; i < points.size(); ++i)
                if (sign * tree.signedDistance(points[i]) > mostMm) truth.push_back(i);
            ASSERT_GT(truth.size(), 100u);
            EXPECT_EQ(pointsBeyond(tree, points, mostMm, sign), truth);
        }
}

}  // namespace
}  // namespace handpiece::geometry::triangle_tree_test
