// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/instrument/bur.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "handpiece/model/instrument/piece.h"
#include "outlines.h"

namespace handpiece::instrument::bur_test {
namespace {

using core::Vec2;

TEST(Bur, RingsLieOnTheOutlineCloseTogetherAndCoverTheSurface) {
    std::mt19937_64 generator(handpiece::test::seed());
    for (const auto& [name, profile] : test::manyOutlines(3, generator)) {
        const Bur bur(name, profile);
        double area = 0.0, along = 0.0;
        std::uint32_t next = 0;
        for (std::size_t i = 0; i < bur.rings().size(); ++i) {
            const SurfaceRing& ring = bur.rings()[i];
            ASSERT_NEAR(signedDistanceMm(bur.profile(), ring.rhoMm, ring.zMm), 0.0, 1e-12) << name;
            ASSERT_NEAR(std::hypot(ring.normalRho, ring.normalZ), 1.0, 1e-12);
            ASSERT_GT(ring.areaMm2, 0.0);
            ASSERT_EQ(ring.first, next);
            next += ring.count;
            ASSERT_TRUE(ring.count == 1 || ring.count % 8 == 0);
            ASSERT_EQ(ring.count == 1, ring.rhoMm < 1e-9) << name;
            ASSERT_LE(2.0 * std::numbers::pi * ring.rhoMm / ring.count, bur.surfaceSpacingMm() + 1e-9);
            area += ring.areaMm2 * ring.count;
            // A step along the normal leaves the bur by as much.
            const double off = 1e-6;
            ASSERT_GT(signedDistanceMm(bur.profile(), ring.rhoMm + off * ring.normalRho, ring.zMm + off * ring.normalZ),
                      0.0)
                << name;
            if (i > 0) {
                const double chord =
                    Vec2(ring.rhoMm - bur.rings()[i - 1].rhoMm, ring.zMm - bur.rings()[i - 1].zMm).norm();
                ASSERT_LE(chord, bur.surfaceSpacingMm() + 1e-9) << name;
                along += chord;
            }
        }
        EXPECT_NEAR(area, surfaceAreaMm2(bur.profile()), 1e-9 * area) << name;
        EXPECT_LE(next, 1.3 * kMaxSurfacePoints) << name;  // rounded up to eights
        if (area < 16.0) {
            EXPECT_EQ(bur.surfaceSpacingMm(), kSurfaceSpacingMm) << name;
        }
        double outline = 0.0;
        for (const ProfilePiece& piece : bur.profile().pieces)
            outline += lengthMm(piece);
        EXPECT_NEAR(along, outline, 0.01 * outline) << name;
    }
}

TEST(Bur, EveryCornerHasARing) {
    const Bur bur("wheel", makeProfile(Shape::wheel, 3.0, 1.0));
    for (const Vec2& corner : {Vec2(1.5, 0.0), Vec2(1.5, 1.0)}) {
        int rings = 0;
        for (const SurfaceRing& ring : bur.rings())
            if (ring.rhoMm == corner.x() && ring.zMm == corner.y()) {
                ++rings;
                EXPECT_NEAR(ring.normalRho, std::sqrt(0.5), 1e-12);
                EXPECT_NEAR(std::abs(ring.normalZ), std::sqrt(0.5), 1e-12);
            }
        EXPECT_EQ(rings, 1);
    }
}

TEST(Bur, EndsAreRoundedTogetherSoThatCornersHaveOnePlace) {
    Profile profile = makeProfile(Shape::cylinderFlat, 1.0, 2.0);
    profile.pieces[1].from.x() += 4e-10;
    const Bur bur("nearly", profile);
    for (std::size_t i = 1; i < bur.profile().pieces.size(); ++i)
        EXPECT_EQ(bur.profile().pieces[i].from, bur.profile().pieces[i - 1].to);
}

}  // namespace
}  // namespace handpiece::instrument::bur_test
