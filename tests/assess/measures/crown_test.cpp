// SPDX-License-Identifier: Apache-2.0
// Crown preparations with a closed form: truncated cones with a chamfer, out of a turned cylinder.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "assess/measures/analytic.h"

namespace handpiece::measures {
namespace {

using handpiece::test::uniform;
using test::Body;
using test::Table;
using test::Vec2;
using test::Vec3;

constexpr double kRadius = 3.2, kTop = 4.0, kBottom = -2.0;

/// A cylinder about z, many-sided: flat to a third of a micron.
geometry::TriangleMesh cylinder() {
    constexpr std::uint32_t kSides = 256;
    geometry::TriangleMesh mesh;
    for (std::uint32_t i = 0; i < kSides; ++i)
        for (const double z : {kBottom, kTop}) {
            const double a = 2.0 * std::numbers::pi * i / kSides;
            mesh.vertices.emplace_back(kRadius * std::cos(a), kRadius * std::sin(a), z);
        }
    mesh.vertices.emplace_back(0, 0, kBottom);
    mesh.vertices.emplace_back(0, 0, kTop);
    for (std::uint32_t i = 0; i < kSides; ++i) {
        const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % kSides);
        mesh.triangles.push_back({a, b, b + 1});
        mesh.triangles.push_back({a, b + 1, a + 1});
        mesh.triangles.push_back({b, a, 2 * kSides});
        mesh.triangles.push_back({a + 1, b + 1, 2 * kSides + 1});
    }
    return mesh;
}

/// A cone of half the convergence, a finish line at z = 0 whose inner corner is round, a round occlusal edge, tilted.
struct Cone {
    double halfDeg = 8.0, widthMm = 0.7, occlusalMm = 1.5, chamferMm = 0.5, edgeMm = 0.2;

    [[nodiscard]] double radiusAt(double z) const {
        return kRadius - widthMm / std::cos(halfDeg * test::kRad) - z * std::tan(halfDeg * test::kRad);
    }
    /// Negative in what is cut away.
    [[nodiscard]] double operator()(const Vec3& p) const {
        const double r = std::hypot(p.x(), p.y()), t = halfDeg * test::kRad;
        // What stays: the cone with its rounded edge, or below the margin; between both a round inner corner.
        const double side = (r - radiusAt(0)) * std::cos(t) + p.z() * std::sin(t), top = p.z() - (kTop - occlusalMm);
        const double a = side + edgeMm, b = top + edgeMm;
        const double cone = std::min(std::max(a, b), 0.0) + std::hypot(std::max(a, 0.0), std::max(b, 0.0)) - edgeMm;
        const double below = p.z();
        // Quarter round in the corner of the two: distances to both less than the radius.
        const double u = chamferMm - cone, v = chamferMm - below;
        const double stays = u > 0.0 && v > 0.0 ? chamferMm - std::hypot(u, v) : std::min(cone, below);
        return -stays;
    }
};

TEST(Crown, conesWithAChamferInTurnedGrids) {
    std::mt19937_64 random(handpiece::test::seed() + 5);
    const char* asked = std::getenv("HANDPIECE_MEASURES");
    const int each = asked != nullptr ? std::atoi(asked) : 1;
    for (const double voxel : {0.1, 0.05}) {
        const Body body = test::bodyOf(cylinder(), test::randomPose(random), voxel);
        Table table;
        for (int i = 0; i < each; ++i) {
            Cone cone;
            cone.halfDeg = uniform(random, 1.0, 14.0);
            cone.widthMm = uniform(random, 0.5, 1.1);
            cone.occlusalMm = uniform(random, 0.8, 1.6);
            cone.chamferMm = uniform(random, 0.1, 0.45);
            cone.edgeMm = uniform(random, 0.05, 0.25);
            const auto cut = test::carved(body, cone);
            Preparation p;
            p.whole = body.model;
            p.cut = cut.get();
            p.axes = body.axes();
            Selection occlusalSide, mesial;
            occlusalSide.side = "occlusal";
            mesial.side = "mesial";
            const auto got = measure(p, std::vector<Request>{{"occlusal-convergence"},
                                                             {"margin-width"},
                                                             {"reduction", occlusalSide},
                                                             {"axial-depth", mesial},
                                                             {"wall-height"},
                                                             {"wall-angle"},
                                                             {"margin-continuity"},
                                                             {"undercut-area"},
                                                             {"floor-depth"}});
            table["occlusal-convergence deg"].add(got[0], 2.0 * cone.halfDeg);
            table["margin-width mm"].add(got[1], cone.widthMm);
            table["reduction occlusal mm"].add(got[2], cone.occlusalMm);
            // Between what is gone at the margin and at the wall's top.
            ASSERT_TRUE(got[3].value) << got[3].reason;
            EXPECT_GT(*got[3].value, cone.widthMm - 0.05);
            EXPECT_LT(*got[3].value, kRadius - cone.radiusAt(kTop - cone.occlusalMm) + 0.2);
            table["wall-angle deg"].add(got[5], cone.halfDeg);
            EXPECT_EQ(got[6].value, 100.0);
            EXPECT_EQ(got[7].value, 0.0);
            EXPECT_FALSE(got[8].value);
            EXPECT_FALSE(got[8].reason.empty());
        }
        std::printf("voxel %.3f mm\n", voxel);
        test::print(table);
        const std::pair<const char*, double> most[] = {{"occlusal-convergence deg", 0.5},
                                                       {"margin-width mm", 0.05},
                                                       {"reduction occlusal mm", 0.03},
                                                       {"wall-angle deg", 0.5}};
        for (const auto& [name, bound] : most)
            for (const double error : table.at(name).error)
                EXPECT_LE(std::abs(error), bound) << name;
    }
}

}  // namespace
}  // namespace handpiece::measures
