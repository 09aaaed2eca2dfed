// SPDX-License-Identifier: Apache-2.0
/// @file
/// The field of a mesh against brute force over its triangles.

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/simd.h"
#include "handpiece/model/field/field_builder.h"
#include "handpiece/model/field/nearest_kernel.h"
#include "support/closed_meshes.h"
#include "support/random.h"

namespace handpiece::field::surface_field_test {
namespace {

using core::Vec3;
using geometry::TriangleMesh;
using geometry::TriangleTree;
using test::uniform;

FieldSettings voxels(double voxelMm) {
    FieldSettings settings;
    settings.voxelMm = voxelMm;
    return settings;
}

DistanceField fieldOf(const TriangleMesh& mesh, const FieldSettings& settings = {},
                      std::span<const PartSurface> parts = {}) {
    const TriangleTree tree(mesh);
    return FieldBuilder::fromSurface(mesh, tree, parts, settings);
}

double signedByBruteForce(const Vec3& p, const TriangleMesh& mesh) {
    return test::distanceToMesh(p, mesh) * (test::windingByBruteForce(p, mesh) > 0.5 ? -1.0 : 1.0);
}

/// Every stored node of `field`, `every`-th one only.
template <class F>
void forNodes(const DistanceField& field, std::size_t every, F&& visit) {
    const FieldView v = field.view();
    std::size_t counter = 0;
    for (int bz = 0; bz < v.bricks[2]; ++bz)
        for (int by = 0; by < v.bricks[1]; ++by)
            for (int bx = 0; bx < v.bricks[0]; ++bx) {
                const std::int32_t dense = bx + v.bricks[0] * (by + v.bricks[1] * bz), brick = v.brickIndex[dense];
                if (brick < 0) continue;
                const std::uint8_t* tissues = v.tissue + v.tissueStart[dense];
                for (int i = 0; i < kBrickValues; ++i, ++counter) {
                    if (counter % every != 0) continue;
                    const Vec3 p(v.originMm[0] + v.voxelMm * (8 * bx + i % 9),
                                 v.originMm[1] + v.voxelMm * (8 * by + i / 9 % 9),
                                 v.originMm[2] + v.voxelMm * (8 * bz + i / 81));
                    visit(p, v.values[brick * kBrickValues + i], static_cast<cases::Tissue>(tissues[i]));
                }
            }
}

TEST(SurfaceField, NodesEqualBruteForceOnAConcaveMesh) {
    const TriangleMesh mesh = test::bumpyMesh(4, 2.0);
    for (const double voxel : {0.025, 0.05, 0.1}) {
        const DistanceField field = fieldOf(mesh, voxels(voxel));
        const std::size_t every = field.brickCount() * kBrickValues / 1500;
        std::size_t nodes = 0;
        forNodes(field, every, [&](const Vec3& p, float value, cases::Tissue) {
            ++nodes;
            EXPECT_NEAR(value, signedByBruteForce(p, mesh), 2e-6) << p.transpose();
        });
        EXPECT_GT(nodes, 1000u);
        EXPECT_NEAR(field.volumeMm3() / geometry::enclosedVolumeMm3(mesh), 1.0,
                    1e-3 * std::max(1.0, std::pow(voxel / 0.05, 2)));
        EXPECT_NEAR(field.areaMm2() / geometry::surfaceAreaMm2(mesh), 1.0, 3e-3 * std::max(1.0, voxel / 0.05));
    }
}

TEST(SurfaceField, NodesEqualTheTreeEverywhere) {
    for (const TriangleMesh& mesh :
         {test::bumpyMesh(5, 3.0), test::boxMesh({-2.01, -1.02, -1.03}, {1.5, 2.2, 3.1}), test::sphereMesh(1, 1.7)}) {
        const TriangleTree tree(mesh);
        const DistanceField field = FieldBuilder::fromSurface(mesh, tree, {}, {});
        double worst = 0.0;
        forNodes(field, 7, [&](const Vec3& p, float value, cases::Tissue) {
            worst = std::max(worst, std::abs(value - tree.signedDistance(p)));
        });
        EXPECT_LT(worst, 2e-6);
    }
}

TEST(SurfaceField, SliversAndFlatTrianglesDoNotTearIt) {
    // A box whose faces are cut into needles by points strewn on one edge, with triangles of no area among them.
    TriangleMesh mesh = test::boxMesh(Vec3::Constant(-1.0), Vec3::Constant(1.0));
    mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), mesh.triangles.end(),
                                        [](const auto& t) {
                                            return t == geometry::Triangle{4, 5, 7};
                                        }),
                         mesh.triangles.end());
    mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), mesh.triangles.end(),
                                        [](const auto& t) {
                                            return t == geometry::Triangle{0, 1, 5} || t == geometry::Triangle{0, 5, 4};
                                        }),
                         mesh.triangles.end());
    // Edge 4-5 in 400 pieces, two of them of no length; a fan to 7 above and to 0 (and 1) in front.
    std::vector<std::uint32_t> edge{4};
    for (int i = 1; i < 400; ++i) {
        edge.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
        mesh.vertices.push_back(Vec3(-1.0 + (i == 200 ? 199 : i) * 0.005, -1.0, 1.0));
    }
    edge.push_back(5);
    for (std::size_t i = 0; i + 1 < edge.size(); ++i) {
        mesh.triangles.push_back({edge[i], edge[i + 1], 7});
        mesh.triangles.push_back({edge[i + 1], edge[i], 0});
    }
    mesh.triangles.push_back({5, 0, 1});
    const DistanceField field = fieldOf(mesh);
    forNodes(field, 53, [&](const Vec3& p, float value, cases::Tissue) {
        const Vec3 q = p.cwiseAbs() - Vec3::Ones();
        EXPECT_NEAR(value, q.cwiseMax(0.0).norm() + std::min(0.0, q.maxCoeff()), 2e-6) << p.transpose();
    });
}

TEST(SurfaceField, EveryPointOfTheBandLiesInABrick) {
    std::mt19937_64 g(test::seed());
    const TriangleMesh mesh = test::bumpyMesh(4, 2.0);
    const TriangleTree tree(mesh);
    const DistanceField field = FieldBuilder::fromSurface(mesh, tree, {}, {});
    int inBand = 0;
    for (int i = 0; i < 40000; ++i) {
        const Vec3 p = test::randomDirection(g) * uniform(g, 1.0, 2.8);
        const double d = tree.signedDistance(p);
        if (d > 0.1 || d < -0.3) {
            if (!field.isFine(p)) {
                EXPECT_LE(std::abs(field.distance(p)), std::abs(d) + 1e-9);
                EXPECT_GE(field.distance(p) * d, 0.0);
            }
            continue;
        }
        ++inBand;
        ASSERT_TRUE(field.isFine(p)) << p.transpose();
        EXPECT_NEAR(field.distance(p), d, 0.02);
    }
    EXPECT_GT(inBand, 5000);
}

TEST(SurfaceField, TheSameBitsAtAnyThreadCount) {
    const TriangleMesh mesh = test::bumpyMesh(4, 2.0);
    core::setThreadCount(1);
    const std::uint64_t one = fieldOf(mesh, voxels(0.1)).stateHash();
    core::setThreadCount(2);
    const std::uint64_t two = fieldOf(mesh, voxels(0.1)).stateHash();
    core::setThreadCount(7);
    const std::uint64_t seven = fieldOf(mesh, voxels(0.1)).stateHash();
    core::setThreadCount(0);
    EXPECT_EQ(one, two);
    EXPECT_EQ(one, seven);
}

std::uint64_t hashOfABumpyTooth() {
    return fieldOf(test::bumpyMesh(4, 2.0), voxels(0.1)).stateHash();
}

/// Run by the next test in processes of their own, because the level is read once in each.
TEST(SurfaceField, DISABLED_PrintsItsHash) {
    std::cout << "hash " << hashOfABumpyTooth() << std::endl;
}

TEST(SurfaceField, TheSameBitsAtEverySimdLevel) {
    const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
    const std::string wanted = "hash " + std::to_string(hashOfABumpyTooth());
    for (const std::string level : {"base", "avx2", "avx512"}) {
        const std::string command =
            "HANDPIECE_SIMD=" + level + " '" + program +
            "' --gtest_also_run_disabled_tests --gtest_filter=*DISABLED_PrintsItsHash 2>/dev/null";
        std::FILE* child = ::popen(command.c_str(), "r");
        ASSERT_NE(child, nullptr);
        std::string output;
        for (int c; (c = std::fgetc(child)) != EOF;)
            output.push_back(static_cast<char>(c));
        EXPECT_EQ(::pclose(child), 0);
        EXPECT_NE(output.find(wanted), std::string::npos) << level << ": " << output;
    }
}

TEST(SurfaceField, RepeatedNodesAreEqualBitForBit) {
    const DistanceField field = fieldOf(test::bumpyMesh(4, 2.0));
    const FieldView v = field.view();
    std::size_t compared = 0;
    const auto at = [&](int x, int y, int z) { return v.brickIndex[x + v.bricks[0] * (y + v.bricks[1] * z)]; };
    // All pairs of bricks that touch, by face, edge or corner.
    const auto tissueOf = [&](int x, int y, int z) {
        return v.tissue + v.tissueStart[x + v.bricks[0] * (y + v.bricks[1] * z)];
    };
    for (int bz = 0; bz < v.bricks[2]; ++bz)
        for (int by = 0; by < v.bricks[1]; ++by)
            for (int bx = 0; bx < v.bricks[0]; ++bx)
                for (int k = 1; k < 27; ++k) {
                    const int d[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1}, o[3] = {bx + d[0], by + d[1], bz + d[2]};
                    if (o[0] < 0 || o[1] < 0 || o[2] < 0 || o[0] >= v.bricks[0] || o[1] >= v.bricks[1] ||
                        o[2] >= v.bricks[2])
                        continue;
                    const std::int32_t a = at(bx, by, bz), b = at(o[0], o[1], o[2]);
                    if (a < 0 || b < 0) continue;
                    for (int i = 0; i < kBrickValues; ++i) {
                        const int n[3] = {i % 9, i / 9 % 9, i / 81};
                        int m[3];
                        bool shared = true;
                        for (int c = 0; c < 3; ++c) {
                            m[c] = n[c] - 8 * d[c];
                            shared = shared && m[c] >= 0 && m[c] <= 8;
                        }
                        if (!shared) continue;
                        ++compared;
                        const int j = m[0] + 9 * (m[1] + 9 * m[2]);
                        ASSERT_EQ(v.values[a * kBrickValues + i], v.values[b * kBrickValues + j]);
                        ASSERT_EQ(tissueOf(bx, by, bz)[i], tissueOf(o[0], o[1], o[2])[j]);
                    }
                }
    EXPECT_GT(compared, 50000u);
}

#if defined(__x86_64__)
TEST(NearestKernel, TheSameBitsAtEverySimdLevelAndAsGoodAsExact) {
    std::mt19937_64 g(test::seed());
    const TriangleMesh mesh = test::bumpyMesh(5, 3.0);
    const TriangleTree tree(mesh);
    std::vector<FlatTriangle> flat;
    for (const auto& t : tree.triangles())
        flat.push_back(flattened(t));
    for (int i = 0; i < 3000; ++i) {
        PointPacket packet{};
        const Vec3 centre = test::randomDirection(g) * uniform(g, 0.0, 4.0);
        for (int k = 0; k < 3; ++k) {
            packet.centre[k] = centre[k];
            packet.halfSize[k] = 0.1f;
            for (float& o : packet.offset[k])
                o = static_cast<float>(uniform(g, -0.1, 0.1));
        }
        const auto seed = static_cast<std::uint32_t>(g() % flat.size());
        std::uint32_t base[kPacket], wide[kPacket];
        simd_base::nearestOfPacket(tree.nodes().data(), flat.data(), packet, seed, base);
        if (core::simdLevel() >= core::SimdLevel::avx2) {
            simd_avx2::nearestOfPacket(tree.nodes().data(), flat.data(), packet, seed, wide);
            EXPECT_TRUE(std::equal(base, base + kPacket, wide));
        }
        if (core::simdLevel() >= core::SimdLevel::avx512) {
            simd_avx512::nearestOfPacket(tree.nodes().data(), flat.data(), packet, seed, wide);
            EXPECT_TRUE(std::equal(base, base + kPacket, wide));
        }
        for (int lane = 0; lane < kPacket; ++lane) {
            const Vec3 p = centre + Vec3(packet.offset[0][lane], packet.offset[1][lane], packet.offset[2][lane]);
            EXPECT_NEAR(tree.nearestOn(base[lane], p).distanceMm, tree.nearest(p).distanceMm, 2e-6);
        }
    }
}
#endif

TEST(SurfaceField, TissuesByPriorityAndElseByTheNearestPart) {
    // Dentine core in enamel, a lesion across both, a gap between core and lesion nobody claims.
    const TriangleMesh outer = test::bumpyMesh(4, 2.0), core = test::sphereMesh(3, 1.2),
                       lesion = test::sphereMesh(3, 0.4, {0, 0, 1.3});
    const TriangleTree outerTree(outer), coreTree(core), lesionTree(lesion);
    const PartSurface parts[] = {{&outerTree, cases::Tissue::enamel, 10},
                                 {&lesionTree, cases::Tissue::caries, 50},
                                 {&coreTree, cases::Tissue::dentine, 20}};
    const DistanceField field = FieldBuilder::fromSurface(outer, outerTree, parts, {});
    std::mt19937_64 g(test::seed());
    int seen[cases::kTissueCount] = {};
    const FieldView v = field.view();
    std::size_t counter = 0;
    forNodes(field, 11, [&](const Vec3& p, float, cases::Tissue tissue) {
        ++counter;
        const double e = outerTree.signedDistance(p), c = lesionTree.signedDistance(p), d = coreTree.signedDistance(p);
        cases::Tissue wanted = cases::Tissue::enamel;
        if (c < 0.0) {
            wanted = cases::Tissue::caries;
        } else if (d < 0.0) {
            wanted = cases::Tissue::dentine;
        } else if (e >= 0.0) {
            wanted = c < std::min(d, e) ? cases::Tissue::caries
                     : d < e            ? cases::Tissue::dentine
                                        : cases::Tissue::enamel;
        }
        ++seen[static_cast<int>(wanted)];
        ASSERT_EQ(tissue, wanted) << p.transpose();
    });
    EXPECT_GT(seen[static_cast<int>(cases::Tissue::enamel)], 1000);
    EXPECT_GT(seen[static_cast<int>(cases::Tissue::caries)], 10);
    EXPECT_GT(seen[static_cast<int>(cases::Tissue::dentine)], 10);
    // Deep inside, brick by brick.
    EXPECT_EQ(field.tissueAt({0, 0, 0}), cases::Tissue::dentine);
    EXPECT_EQ(v.tissue[v.tissueStart[0]], static_cast<std::uint8_t>(cases::Tissue::none));
    // One part needs no looking.
    const DistanceField single = FieldBuilder::fromSurface(outer, outerTree, std::span(parts).subspan(2, 1), {});
    EXPECT_EQ(single.tissueAt({0, 0, 1.9}), cases::Tissue::dentine);
}

TEST(SurfaceField, ASurfaceThatEnclosesNothingIsRefused) {
    // Inside out: every sign is wrong.
    TriangleMesh mesh = test::bumpyMesh(3, 2.0);
    for (auto& t : mesh.triangles)
        std::swap(t[0], t[1]);
    EXPECT_THROW((void)fieldOf(mesh), core::Error);
    // A plate thinner than a voxel.
    EXPECT_THROW((void)fieldOf(test::boxMesh({-2, -2, 0.001}, {2, 2, 0.011})), core::Error);
}

TEST(SurfaceField, SlightlySelfCrossingIsNotHollow) {
    // A dent pushed through the far side of a thin bump would be refused; a fold at the surface is lived with.
    TriangleMesh mesh = test::sphereMesh(4, 2.0);
    mesh.vertices[100] += 0.08 * (mesh.vertices[300] - mesh.vertices[100]).normalized();
    const DistanceField field = fieldOf(mesh);
    EXPECT_NEAR(field.volumeMm3() / geometry::enclosedVolumeMm3(mesh), 1.0, 2e-3);
    EXPECT_LT(field.distance({0, 0, 0}), 0.0);
}

TEST(SurfaceField, CancelledWorkStops) {
    const TriangleMesh mesh = test::bumpyMesh(3, 2.0);
    const TriangleTree tree(mesh);
    EXPECT_THROW((void)FieldBuilder::fromSurface(mesh, tree, {}, {}, [](double f) { return f < 0.3; }), core::Error);
}

}  // namespace
}  // namespace handpiece::field::surface_field_test
