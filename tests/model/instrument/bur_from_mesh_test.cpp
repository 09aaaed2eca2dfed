// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/instrument/envelope.h"
#include "outlines.h"

namespace handpiece::instrument::bur_from_mesh_test {
namespace {

using core::Vec3;
using geometry::TriangleMesh;
using handpiece::test::uniform;
constexpr double kPi = std::numbers::pi;

TriangleMesh moved(TriangleMesh mesh, const std::function<Vec3(const Vec3&)>& map) {
    for (Vec3& v : mesh.vertices)
        v = map(v);
    return mesh;
}

/// Radius of the mesh at one height, from every triangle cut by that plane.
double radiusAt(const TriangleMesh& mesh, double z) {
    double most = 0.0;
    for (const geometry::Triangle& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 &a = mesh.vertices[t[k]], &b = mesh.vertices[t[(k + 1) % 3]];
            if ((a.z() - z) * (b.z() - z) > 0.0 || a.z() == b.z()) continue;
            const Vec3 p = a + (z - a.z()) / (b.z() - a.z()) * (b - a);
            most = std::max(most, std::hypot(p.x(), p.y()));
        }
    return most;
}

std::string refusal(const TriangleMesh& mesh) {
    try {
        (void)burFromMesh("bur", mesh);
    } catch (const core::Error& error) {
        return error.what();
    }
    return "accepted";
}

TEST(BurFromMesh, EnvelopeOfATurnedMeshIsItsOutlineWithinTheSagitta) {
    std::mt19937_64 generator(handpiece::test::seed());
    for (const ShapeInfo& info : shapes())
        for (int i = 0; i < 3; ++i) {
            const Profile profile = test::randomProfile(info.shape, generator);
            const double spacing = 0.05;
            const Profile envelope = envelopeOfRevolution(turnedMesh(profile, 24, spacing));
            double least = 1e300;
            for (const ProfilePiece& piece : profile.pieces)
                if (piece.isArc) least = std::min(least, piece.radiusMm);
            const double sagitta = std::min(least, spacing * spacing / (8.0 * least)) + kEnvelopeToleranceMm;
            EXPECT_NEAR(envelope.lengthMm(), profile.lengthMm(), 1e-9) << info.name;
            for (int k = 0; k < 300; ++k) {
                const double rho = uniform(generator, 0.0, 1.3 * profile.maxRadiusMm());
                const double z = uniform(generator, -0.2, profile.lengthMm() + 0.2);
                ASSERT_NEAR(signedDistanceMm(envelope, rho, z), signedDistanceMm(profile, rho, z), sagitta)
                    << info.name;
            }
        }
}

TEST(BurFromMesh, EnvelopeOfFlutesAndFacetsIsTheLargestRadius) {
    // Twisted by height, the edges sweep hyperbolas; wobbling around, the largest radius decides.
    std::mt19937_64 generator(handpiece::test::seed());
    for (int sides : {4, 6, 9}) {
        const TriangleMesh mesh = moved(turnedMesh(makeProfile(Shape::pear, 1.2, 3.0), sides, 0.4), [](const Vec3& v) {
            const double angle = 0.7 * v.z(), c = std::cos(angle), s = std::sin(angle);
            return Vec3(c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z());
        });
        const Profile envelope = envelopeOfRevolution(mesh);
        for (int i = 0; i < 300; ++i) {
            const double z = uniform(generator, 0.01, 2.99);
            ASSERT_NEAR(signedDistanceMm(envelope, radiusAt(mesh, z), z), 0.0, kEnvelopeToleranceMm);
        }
        // Every point of the mesh's surface is inside or on it.
        for (int i = 0; i < 2000; ++i) {
            const geometry::Triangle& t = mesh.triangles[generator() % mesh.triangles.size()];
            double u = uniform(generator, 0, 1), w = uniform(generator, 0, 1);
            if (u + w > 1.0) u = 1.0 - u, w = 1.0 - w;
            const Vec3 p = mesh.vertices[t[0]] + u * (mesh.vertices[t[1]] - mesh.vertices[t[0]]) +
                           w * (mesh.vertices[t[2]] - mesh.vertices[t[0]]);
            ASSERT_LE(signedDistanceMm(envelope, std::hypot(p.x(), p.y()), p.z()), kEnvelopeToleranceMm);
        }
    }
}

TEST(BurFromMesh, FindsAxisAndTipWhereverTheMeshStands) {
    const TriangleMesh upright = turnedMesh(makeProfile(Shape::flame, 1.2, 6.0), 48, 0.05);
    const Bur expected = burFromMesh("flame", upright);
    const Bur shifted =
        burFromMesh("flame", moved(upright, [](const Vec3& v) { return Vec3(v + Vec3(3.0, -2.0, 11.0)); }));
    const Bur upsideDown =
        burFromMesh("flame", moved(upright, [](const Vec3& v) { return Vec3(v.x(), -v.y(), 20.0 - v.z()); }));
    std::mt19937_64 generator(handpiece::test::seed());
    for (int i = 0; i < 300; ++i) {
        const Vec3 p(uniform(generator, -1, 1), uniform(generator, -1, 1), uniform(generator, -1, 7));
        ASSERT_NEAR(shifted.signedDistance(p), expected.signedDistance(p), kEnvelopeToleranceMm);
        ASSERT_NEAR(upsideDown.signedDistance(p), expected.signedDistance(p), kEnvelopeToleranceMm);
    }
    EXPECT_NEAR(upsideDown.mesh().bounds().min.z(), 0.0, 1e-12);
    EXPECT_GT(geometry::enclosedVolumeMm3(upsideDown.mesh()), 0.0);
    // Two flat ends: neither is pointed, the lower stays the tip.
    const Bur cone = burFromMesh("cone", turnedMesh(makeProfile(Shape::invertedCone, 1.2, 0.9), 48, 0.05));
    EXPECT_NEAR(cone.signedDistance({0.6, 0, 0}), 0.0, 1e-6);
}

TEST(BurFromMesh, OpenTopAndSoupAreGoodEnough) {
    TriangleMesh mesh = turnedMesh(makeProfile(Shape::cylinderRound, 1.0, 4.0), 32, 0.05);
    TriangleMesh open = mesh;
    open.triangles.resize(open.triangles.size() - 32);  // the fan that closes the top
    TriangleMesh soup;
    for (const geometry::Triangle& t : mesh.triangles) {
        const auto first = static_cast<std::uint32_t>(soup.vertices.size());
        for (const std::uint32_t v : t)
            soup.vertices.push_back(mesh.vertices[v]);
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    const double volume = volumeMm3(burFromMesh("whole", mesh).profile());
    EXPECT_NEAR(volumeMm3(burFromMesh("open", open).profile()), volume, 1e-6);
    EXPECT_NEAR(volumeMm3(burFromMesh("soup", soup).profile()), volume, 1e-9);
}

TEST(BurFromMesh, WhatIsNoBurIsRefusedWithItsReason) {
    const TriangleMesh good = turnedMesh(makeProfile(Shape::cylinderRound, 1.0, 4.0), 32, 0.05);
    ASSERT_EQ(refusal(good), "accepted");
    const auto scaled = [&](double k) { return moved(good, [k](const Vec3& v) { return Vec3(k * v); }); };
    EXPECT_NE(refusal({}).find("no triangles"), std::string::npos);
    EXPECT_NE(refusal(scaled(1e-3)).find("metres"), std::string::npos);
    EXPECT_NE(refusal(scaled(1e3)).find("micrometres"), std::string::npos);
    EXPECT_NE(refusal(scaled(1.0 / 25.4)).find("inches"), std::string::npos);
    EXPECT_NE(refusal(scaled(1e9)).find("long"), std::string::npos);
    EXPECT_NE(refusal(moved(good, [](const Vec3& v) { return Vec3(v.x(), v.y(), 0.0); })).find("flat"),
              std::string::npos);
    EXPECT_NE(refusal(moved(good, [](const Vec3& v) { return Vec3(v.z(), v.x(), v.y()); })).find("off z"),
              std::string::npos);
    const double tilt = 2.0 * kPi / 180.0;
    const auto tilted = [&](double angle) {
        return moved(good, [angle](const Vec3& v) {
            return Vec3(std::cos(angle) * v.x() + std::sin(angle) * v.z(), v.y(),
                        std::cos(angle) * v.z() - std::sin(angle) * v.x());
        });
    };
    EXPECT_NE(refusal(tilted(tilt)).find("2.0 degrees off z"), std::string::npos) << refusal(tilted(tilt));
    EXPECT_EQ(refusal(tilted(0.4 * tilt)), "accepted");
    EXPECT_NE(refusal(moved(good, [](const Vec3& v) { return Vec3(1.5 * v.x(), v.y(), v.z()); })).find("not round"),
              std::string::npos);
    TriangleMesh half = good;
    std::vector<geometry::Triangle> kept;
    for (const geometry::Triangle& t : good.triangles)
        if (good.vertices[t[0]].x() + good.vertices[t[1]].x() + good.vertices[t[2]].x() > 0.0) kept.push_back(t);
    half.triangles = kept;
    EXPECT_NE(refusal(half), "accepted");
    TriangleMesh broken = good;
    broken.vertices[5].x() = std::nan("");
    EXPECT_NE(refusal(broken).find("not finite"), std::string::npos);
    broken = good;
    broken.triangles[3][1] = 1000000;
    EXPECT_NE(refusal(broken).find("missing"), std::string::npos);
    TriangleMesh apart = good;  // two burs one above the other
    const auto offset = static_cast<std::uint32_t>(good.vertices.size());
    for (const Vec3& v : good.vertices)
        apart.vertices.push_back(v + Vec3(0, 0, 6.0));
    for (const geometry::Triangle& t : good.triangles)
        apart.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
    EXPECT_NE(refusal(apart).find("two pieces"), std::string::npos);
    // As many triangles inwards as outwards: surface, but no volume.
    TriangleMesh doubled = good;
    for (const geometry::Triangle& t : good.triangles)
        doubled.triangles.push_back({t[0], t[2], t[1]});
    EXPECT_NE(refusal(doubled).find("no volume"), std::string::npos);
}

TEST(BurFromMesh, ATaperedBurOfRealData) {
    const std::filesystem::path folder = handpiece::test::realDataFolder();
    const std::filesystem::path file = folder / "tools" / "tapered_bur.stl";
    if (folder.empty() || !std::filesystem::exists(file)) GTEST_SKIP() << "no real data beside this checkout";
    const TriangleMesh mesh = geometry::readMesh(file);
    const Bur bur = burFromMesh("tapered", mesh);
    std::printf("tapered bur: diameter %.3f mm, length %.3f mm, %zu pieces, %zu medial curves, %zu rings\n",
                2.0 * bur.maxRadiusMm(), bur.lengthMm(), bur.profile().pieces.size(), bur.medialAxis().size(),
                bur.rings().size());
    EXPECT_NEAR(2.0 * bur.maxRadiusMm(), 1.355, 0.01);
    EXPECT_NEAR(bur.lengthMm(), 6.0, 0.01);
    // The tip, narrower, is at the origin; every vertex lies in or on the envelope and some on it at every height.
    EXPECT_LT(bur.profile().pieces.front().to.x(), 0.5);
    for (const Vec3& v : bur.mesh().vertices)
        ASSERT_LE(bur.signedDistance(v), kEnvelopeToleranceMm) << v.transpose();
    const double enclosed = geometry::enclosedVolumeMm3(mesh);
    EXPECT_NEAR(volumeMm3(bur.profile()), std::abs(enclosed), 0.01 * std::abs(enclosed));
}

}  // namespace
}  // namespace handpiece::instrument::bur_from_mesh_test
