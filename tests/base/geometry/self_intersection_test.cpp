// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/self_intersection.h"

#include <gtest/gtest.h>

#include <set>

#include "base/geometry/brute_crossings.h"
#include "base/geometry/meshes.h"
#include "handpiece/base/core/parallel.h"
#include "support/random.h"

namespace handpiece::geometry::self_intersection_test {
namespace {

using core::Vec3;
using test::boxMesh;
using test::bruteForce;
using test::joined;
using test::sphereMesh;

std::set<std::pair<std::uint32_t, std::uint32_t>> found(const TriangleMesh& mesh) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const CrossingFaces& c : selfIntersections(mesh))
        EXPECT_TRUE(pairs.emplace(c.first, c.second).second) << "a pair twice";
    return pairs;
}

TEST(SelfIntersection, CleanMeshesHaveNone) {
    EXPECT_TRUE(selfIntersections(boxMesh({0, 0, 0}, {1, 2, 3})).empty());
    EXPECT_TRUE(selfIntersections(sphereMesh({3, 2, 1}, 4, 40)).empty());
    EXPECT_TRUE(selfIntersections(test::torusMesh(5, 2, 60)).empty());
    EXPECT_TRUE(selfIntersections(TriangleMesh{}).empty());
}

TEST(SelfIntersection, EqualsBruteForceOnRandomTriangles) {
    std::mt19937_64 generator(test::seed());
    for (int round = 0; round < 20; ++round) {
        TriangleMesh mesh;
        for (std::uint32_t i = 0; i < 150; ++i) {
            const Vec3 centre(test::uniform(generator, -1, 1), test::uniform(generator, -1, 1),
                              test::uniform(generator, -1, 1));
            for (int k = 0; k < 3; ++k)
                mesh.vertices.push_back(centre + 0.3 * test::randomDirection(generator));
            mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
        }
        const auto expected = bruteForce(mesh);
        EXPECT_GT(expected.size(), 15u);
        EXPECT_EQ(found(mesh), expected);
    }
}

TEST(SelfIntersection, EqualsBruteForceOnSpheresThatOverlap) {
    std::mt19937_64 generator(test::seed());
    const TriangleMesh mesh =
        joined(sphereMesh(Vec3::Zero(), 3, 8), sphereMesh(2.5 * test::randomDirection(generator), 2, 7));
    const auto expected = bruteForce(mesh);
    EXPECT_GT(expected.size(), 20u);
    EXPECT_EQ(found(mesh), expected);
}

TEST(SelfIntersection, BoxesThroughEachOthersDiagonals) {
    // Every edge that pierces a side does so exactly on the diagonal between its two triangles.
    EXPECT_FALSE(
        selfIntersections(joined(boxMesh({0, 0, 0}, {1, 1, 1}), boxMesh({0.5, 0.5, 0.5}, {1.5, 1.5, 1.5}))).empty());
}

TEST(SelfIntersection, TouchingIsNotCrossing) {
    EXPECT_TRUE(selfIntersections(joined(boxMesh({0, 0, 0}, {1, 1, 1}), boxMesh({1, 0, 0}, {2, 1, 1}))).empty());
    EXPECT_TRUE(
        selfIntersections(joined(boxMesh({0, 0, 0}, {1, 1, 1}), boxMesh({1, 0.25, 0.25}, {2, 0.75, 0.75}))).empty());
    EXPECT_TRUE(selfIntersections(test::soup(sphereMesh(Vec3::Zero(), 2, 12))).empty())
        << "neighbours by place, not by number";
    EXPECT_TRUE(selfIntersections(joined(sphereMesh(Vec3::Zero(), 2, 12), sphereMesh({4, 0, 0}, 2, 12))).empty());
}

TEST(SelfIntersection, APokedVertexIsFoundAndItsPlaceTold) {
    TriangleMesh mesh = sphereMesh(Vec3::Zero(), 5, 16);
    mesh.vertices[0] = -mesh.vertices[0] * 1.01;  // through the other side
    const auto crossings = selfIntersections(mesh);
    ASSERT_FALSE(crossings.empty());
    for (const CrossingFaces& c : crossings) {
        EXPECT_LT(c.first, c.second);
        EXPECT_NEAR(c.pointMm.norm(), 5.0, 0.1);
    }
    EXPECT_EQ(selfIntersections(mesh, 2).size(), std::min<std::size_t>(2, crossings.size()));
}

TEST(SelfIntersection, AFoldIsFound) {
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.4, 0.7, 0}};
    mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
    EXPECT_EQ(selfIntersections(mesh).size(), 1u);
    mesh.vertices[3] = {0.4, -0.7, 0};
    EXPECT_TRUE(selfIntersections(mesh).empty());
    mesh.vertices[3] = {0.4, 0.7, 0.1};
    EXPECT_TRUE(selfIntersections(mesh).empty());
}

TEST(SelfIntersection, ATreeSaysOfNewFacesWhatTheFinderSays) {
    std::mt19937_64 generator(test::seed());
    const TriangleMesh torus = test::torusMesh(5, 2, 12);
    const CrossingTree tree(torus);
    const auto pick = [&] {
        return static_cast<std::uint32_t>(test::uniform(generator, 0, 1) * static_cast<double>(torus.vertices.size()));
    };
    std::size_t crossed = 0, clear = 0;
    for (int round = 0; round < 400; ++round) {
        const Triangle face{pick(), pick(), pick()};
        if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) continue;
        TriangleMesh with = torus;
        with.triangles.push_back(face);
        const bool isCrossed = !selfIntersections(with).empty();
        EXPECT_EQ(tree.isCrossed(face), isCrossed) << round;
        ++(isCrossed ? crossed : clear);
    }
    EXPECT_GT(crossed, 50u);
    EXPECT_GT(clear, 10u);
    // Chords of a ball lie inside; from a place over it to its far side they go through a face.
    TriangleMesh ball = sphereMesh({1, 2, 3}, 4, 6);
    const auto over = static_cast<std::uint32_t>(ball.vertices.size());
    ball.vertices.emplace_back(1, 2, 20);
    const CrossingTree other(ball);
    for (std::uint32_t v = 0; v < over; ++v) {
        EXPECT_FALSE(other.isPierced(v, (v * 7 + 3) % over)) << v;
        if (ball.vertices[v].z() < 2.0) {
            EXPECT_TRUE(other.isPierced(v, over)) << v;
        } else if (ball.vertices[v].z() > 5.0) {
            EXPECT_FALSE(other.isPierced(v, over)) << v;
        }
    }
}

TEST(SelfIntersection, SameAtAnyThreadCount) {
    const TriangleMesh mesh = joined(sphereMesh(Vec3::Zero(), 3, 40), sphereMesh({1, 0.3, 0.2}, 3, 40));
    core::setThreadCount(1);
    const auto one = selfIntersections(mesh);
    core::setThreadCount(4);
    const auto four = selfIntersections(mesh);
    core::setThreadCount(0);
    ASSERT_EQ(one.size(), four.size());
    EXPECT_GT(one.size(), 100u);
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].first, four[i].first);
        EXPECT_EQ(one[i].second, four[i].second);
        EXPECT_EQ(one[i].pointMm, four[i].pointMm);
    }
}

}  // namespace
}  // namespace handpiece::geometry::self_intersection_test
