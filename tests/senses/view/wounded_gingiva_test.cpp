// SPDX-License-Identifier: Apache-2.0
// A cut in a plate of gingiva: how it opens, that it stays closed as a surface, where its blood goes.
#include "handpiece/senses/view/wounded_gingiva.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "handpiece/senses/view/mesh_pieces.h"
#include "support/closed_meshes.h"

namespace handpiece::view::wounded_gingiva_test {
namespace {

using core::Vec3;

messages::GingivaCut cutAt(const Vec3& tip, double timeS) {
    messages::GingivaCut cut;
    cut.timeS = timeS;
    cut.tipMm = core::toArray(tip);
    cut.lengthMm = 2.0;
    cut.stationRadiusMm.fill(0.5);
    return cut;
}

const core::Box kAbout{Vec3(-3, -3, -3), Vec3(3, 3, 3)};

/// A box of gingiva, its top at z = 0, in pieces of 3 mm.
class Plate : public testing::Test {
  protected:
    Plate() {
        const auto pieces = piecesOf(test::boxMesh({-6, -6, -3}, {6, 6, 0}), cases::Tissue::gum, 0.9, 3.0);
        for (const MeshPiece& piece : pieces)
            gingiva_.add(++count_, piece);
        EXPECT_GT(count_, 1u);
    }
    [[nodiscard]] std::vector<GpuVertex> vertices(bool all = true) {
        std::vector<GpuVertex> found;
        for (const auto& [piece, mesh] : gingiva_.takeChanged(all))
            found.insert(found.end(), mesh.vertices.begin(), mesh.vertices.end());
        return found;
    }
    static Vec3 placeOf(const GpuVertex& v) {
        return {double(v.positionMm[0]), double(v.positionMm[1]), double(v.positionMm[2])};
    }

    WoundedGingiva gingiva_;
    std::uint32_t count_ = 0;
};

TEST_F(Plate, OpensAsWideAndDeepAsTheBurWasInItAndItsLipsSwell) {
    gingiva_.cut(cutAt({0.0, 0.0, -0.4}, 1.0), kAbout);
    double deepest = 0.0, highest = 0.0, widest = 0.0;
    for (const GpuVertex& v : vertices()) {
        const Vec3 p = placeOf(v);
        if (p.z() < -1.0) continue;  // the other sides
        deepest = std::min(deepest, p.z());
        highest = std::max(highest, p.z());
        if (p.z() < -0.02 && std::abs(p.x()) < 5.0) widest = std::max(widest, std::hypot(p.x(), p.y()));
    }
    EXPECT_NEAR(deepest, -0.4, 0.03);
    EXPECT_NEAR(widest, 0.5, 0.1);
    EXPECT_GT(highest, 0.05);
    EXPECT_LT(highest, 0.15);
    // Through and through it gives way before it opens any deeper.
    gingiva_.cut(cutAt({2.0, 0.0, -1.5}, 1.0), kAbout);
    deepest = 0.0;
    for (const GpuVertex& v : vertices())
        if (const Vec3 p = placeOf(v); p.z() > -1.5 && std::hypot(p.x() - 2.0, p.y()) < 1.0)
            deepest = std::min(deepest, p.z());
    EXPECT_LT(deepest, -0.4);
    EXPECT_GE(deepest, -WoundedGingiva::kDeepestMm - 1e-6);
}

TEST_F(Plate, StaysClosedFromPieceToPiece) {
    gingiva_.cut(cutAt({0.0, 0.1, -0.5}, 1.0), kAbout);
    gingiva_.cut(cutAt({0.5, 0.2, -0.3}, 1.2), kAbout);
    for (int step = 0; step < 100; ++step)
        gingiva_.flow(1.2 + 0.025 * step, 0.025, Vec3(0.0, -1.0, 0.0));
    using Corner = std::array<float, 3>;
    std::map<std::pair<Corner, Corner>, int> edges;
    for (const auto& [piece, mesh] : gingiva_.takeChanged(true))
        for (const auto& t : mesh.triangles)
            for (std::size_t k = 0; k < 3; ++k) {
                const Corner &a = mesh.vertices[t[k]].positionMm, &b = mesh.vertices[t[(k + 1) % 3]].positionMm;
                edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
            }
    EXPECT_GT(edges.size(), 2000u);
    for (const auto& [edge, sum] : edges)
        ASSERT_EQ(sum, 0) << "an edge of one triangle only, at " << edge.first[0] << ' ' << edge.first[1];
}

TEST_F(Plate, BloodRunsTheWayThatThingsFallAndStops) {
    gingiva_.cut(cutAt({0.0, 0.0, -0.4}, 0.0), kAbout);
    const auto lowestRed = [this] {
        double least = 0.0, most = 0.0;
        for (const GpuVertex& v : vertices())
            if (v.blood > 20) least = std::min(least, placeOf(v).y()), most = std::max(most, placeOf(v).y());
        EXPECT_LT(most, 0.8) << "up it only wets the wound's edge";
        return least;
    };
    const auto flow = [this](double fromS, double toS) {
        for (int step = 0; fromS + 0.025 * step < toS; ++step)
            gingiva_.flow(fromS + 0.025 * step, 0.025, Vec3(0.0, -1.0, 0.0));
    };
    flow(0.0, 0.5);
    const double soon = lowestRed();
    flow(0.5, 6.0);
    const double later = lowestRed();
    flow(6.0, 15.0);
    const double end = lowestRed();
    EXPECT_GT(soon, -1.0);
    EXPECT_LT(later, -1.5);
    EXPECT_LT(end - later, 0.5);
    EXPECT_GT(end, -6.0) << "not over the edge";
    flow(15.0, 30.0);
    EXPECT_NEAR(lowestRed(), end, 0.7) << "it has all but stopped";
}

TEST_F(Plate, WhatHasNotChangedIsNotGivenAgain) {
    EXPECT_TRUE(vertices(false).empty());
    gingiva_.cut(cutAt({0.0, 0.0, -0.4}, 0.0), kAbout);
    EXPECT_FALSE(vertices(false).empty());
    EXPECT_TRUE(vertices(false).empty());
    gingiva_.cut(cutAt({0.0, 0.0, 3.0}, 0.0), kAbout);  // in the air
    EXPECT_TRUE(vertices(false).empty());
}

}  // namespace
}  // namespace handpiece::view::wounded_gingiva_test
