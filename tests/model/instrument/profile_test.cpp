// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/instrument/profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/model/instrument/piece.h"
#include "outlines.h"

namespace handpiece::instrument::profile_test {
namespace {

using core::Vec2;
using core::Vec3;
using handpiece::test::uniform;
constexpr double kPi = std::numbers::pi;

/// The outline and its mirror image as a closed polygon of short chords.
std::vector<Vec2> chords(const Profile& profile, double spacing) {
    std::vector<Vec2> right;
    for (const ProfilePiece& piece : profile.pieces) {
        const int steps = piece.isArc ? static_cast<int>(std::ceil(lengthMm(piece) / spacing)) : 1;
        for (int i = 0; i < steps; ++i)
            right.push_back(pointAt(piece, static_cast<double>(i) / steps));
    }
    right.push_back(profile.pieces.back().to);
    std::vector<Vec2> closed = right;
    for (std::size_t i = right.size() - 1; i-- > 1;)
        closed.push_back({-right[i].x(), right[i].y()});
    return closed;
}

/// Signed distance to a polygon: every edge, and the winding by crossings.
double polygonDistance(const std::vector<Vec2>& polygon, const Vec2& p) {
    double best = std::numeric_limits<double>::infinity();
    bool inside = false;
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
        const Vec2 &a = polygon[j], &b = polygon[i];
        const Vec2 d = b - a;
        const double u = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
        best = std::min(best, (p - a - u * d).norm());
        if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + d.x() * (p.y() - a.y()) / d.y()) inside = !inside;
    }
    return inside ? -best : best;
}

TEST(Profile, DistanceAgreesWithAPolygonOfTheMirroredOutline) {
    std::mt19937_64 generator(handpiece::test::seed());
    for (const auto& [name, profile] : test::manyOutlines(3, generator)) {
        const double spacing = 2e-3;
        const std::vector<Vec2> polygon = chords(profile, spacing);
        double least = std::numeric_limits<double>::infinity();  // radius of an arc
        for (const ProfilePiece& piece : profile.pieces)
            if (piece.isArc) least = std::min(least, piece.radiusMm);
        const double sagitta = spacing * spacing / (8.0 * least) + 1e-12;
        const double r = profile.maxRadiusMm(), length = profile.lengthMm();
        for (int i = 0; i < 400; ++i) {
            const Vec2 p(uniform(generator, -1.5 * r, 1.5 * r), uniform(generator, -0.5, length + 0.5));
            const double expected = polygonDistance(polygon, p), found = signedDistanceMm(profile, p.x(), p.y());
            ASSERT_NEAR(found, expected, sagitta) << name << " at " << p.transpose();
            if (std::abs(expected) > sagitta) {
                ASSERT_EQ(found < 0.0, expected < 0.0) << name << " at " << p.transpose();
            }
        }
    }
}

TEST(Profile, SignIsRightNextToCornersAndTheAxis) {
    std::mt19937_64 generator(handpiece::test::seed());
    for (const auto& [name, profile] : test::manyOutlines(1, generator)) {
        const std::vector<Vec2> polygon = chords(profile, 1e-3);
        for (const ProfilePiece& piece : profile.pieces)
            for (int i = 0; i < 100; ++i) {
                const double angle = uniform(generator, 0.0, 2.0 * kPi), off = 1e-3;
                const Vec2 p = piece.from + off * Vec2(std::cos(angle), std::sin(angle));
                const double expected = polygonDistance(polygon, p);
                if (std::abs(expected) < 2e-6) continue;
                ASSERT_EQ(signedDistanceMm(profile, p.x(), p.y()) < 0.0, expected < 0.0)
                    << name << " at " << p.transpose();
            }
    }
}

TEST(Profile, DistanceToTheSolidIsThatInTheHalfPlane) {
    // A capped cylinder has a closed form in space.
    std::mt19937_64 generator(handpiece::test::seed());
    const Bur bur("cylinder", makeProfile(Shape::cylinderFlat, 1.2, 3.0));
    for (int i = 0; i < 2000; ++i) {
        const Vec3 p(uniform(generator, -1, 1), uniform(generator, -1, 1), uniform(generator, -1, 4));
        const double side = std::hypot(p.x(), p.y()) - 0.6, cap = std::abs(p.z() - 1.5) - 1.5;
        const double expected =
            std::min(std::max(side, cap), 0.0) + std::hypot(std::max(side, 0.0), std::max(cap, 0.0));
        ASSERT_NEAR(bur.signedDistance(p), expected, 1e-14);
    }
    const Bur ball = makeBur("round-4");
    for (int i = 0; i < 2000; ++i) {
        const Vec3 p(uniform(generator, -2, 2), uniform(generator, -2, 2), uniform(generator, -2, 3));
        ASSERT_NEAR(ball.signedDistance(p), (p - Vec3(0, 0, 0.7)).norm() - 0.7, 1e-14);
    }
    EXPECT_NEAR(ball.signedDistance({0, 0, 0.7}), -0.7, 1e-14);
}

TEST(Profile, VolumeAndAreaOfBodiesWithClosedForms) {
    const Profile ball = makeProfile(Shape::round, 2.0, 2.0);
    EXPECT_NEAR(volumeMm3(ball), 4.0 / 3.0 * kPi, 1e-12);
    EXPECT_NEAR(surfaceAreaMm2(ball), 4.0 * kPi, 1e-12);
    const Profile cylinder = makeProfile(Shape::cylinderFlat, 2.0, 3.0);
    EXPECT_NEAR(volumeMm3(cylinder), 3.0 * kPi, 1e-12);
    EXPECT_NEAR(surfaceAreaMm2(cylinder), 8.0 * kPi, 1e-12);
    const Profile paper = makeProfile(Shape::cylinderRound, 1.0, 4.0);
    EXPECT_NEAR(volumeMm3(paper), kPi * (0.25 * 3.5 + 2.0 / 3.0 * 0.125), 1e-12);
    EXPECT_NEAR(surfaceAreaMm2(paper), kPi * (3.5 + 0.5 + 0.25), 1e-12);
    const Profile cut = makeProfile(Shape::round, 2.0, 1.5);  // spherical segment
    EXPECT_NEAR(volumeMm3(cut), kPi * 1.5 * 1.5 * (3.0 - 1.5) / 3.0, 1e-12);
}

TEST(Profile, VolumeAndAreaAgreeWithNumericalIntegration) {
    std::mt19937_64 generator(handpiece::test::seed());
    for (const auto& [name, profile] : test::manyOutlines(2, generator)) {
        double volume = 0.0, area = 0.0;
        for (const ProfilePiece& piece : profile.pieces) {
            const int steps = 2000;
            for (int i = 0; i < steps; ++i) {
                const Vec2 a = pointAt(piece, static_cast<double>(i) / steps), b = pointAt(piece, (i + 1.0) / steps);
                volume += kPi * (b.y() - a.y()) * (a.x() * a.x() + a.x() * b.x() + b.x() * b.x()) / 3.0;
                area += kPi * (a.x() + b.x()) * (b - a).norm();
            }
        }
        EXPECT_NEAR(volumeMm3(profile), volume, 2e-6 * volume) << name;
        EXPECT_NEAR(surfaceAreaMm2(profile), area, 2e-6 * area) << name;
    }
}

TEST(Profile, WhatIsNoOutlineIsRefused) {
    const Profile good = makeProfile(Shape::cylinderRound, 1.0, 4.0);
    EXPECT_NO_THROW(validate(good));
    const auto refused = [&](auto&& spoil) {
        Profile bad = good;
        spoil(bad);
        EXPECT_THROW(validate(bad), core::Error);
        EXPECT_THROW(Bur("bad", bad), core::Error);
    };
    refused([](Profile& p) { p.pieces.clear(); });
    refused([](Profile& p) { p.pieces.erase(p.pieces.begin() + 1); });
    refused([](Profile& p) { p.pieces.pop_back(); });
    refused([](Profile& p) { p.pieces.erase(p.pieces.begin()); });
    refused([](Profile& p) { p.pieces[1].to.x() = p.pieces[2].from.x() = std::nan(""); });
    refused([](Profile& p) { p.pieces[0].radiusMm = 0.6; });
    refused([](Profile& p) { p.pieces[1].to = p.pieces[1].from; });
    refused([](Profile& p) {
        for (ProfilePiece& piece : p.pieces)
            for (Vec2* v : {&piece.from, &piece.to, &piece.centre})
                v->y() += 0.1;
    });
    // Crossing itself, or running back along itself.
    EXPECT_THROW(
        validate(test::polygonOutline({{0, 0}, {1, 0}, {1, 1}, {0.5, 1}, {0.5, 0.2}, {2, 0.2}, {2, 2}, {0, 2}})),
        core::Error);
    EXPECT_THROW(validate(test::polygonOutline({{0, 0}, {1, 0}, {0.5, 0}, {0.5, 1}, {0, 1}})), core::Error);
    // Walked the wrong way round, the volume is negative; a sheet has none.
    EXPECT_THROW(validate(test::polygonOutline({{0, 0}, {0, 1}, {1, 1}, {1, 0}, {0, 0}})), core::Error);
    EXPECT_THROW(validate(test::polygonOutline({{0, 0}, {1, 0}, {0, 0}})), core::Error);
    EXPECT_THROW(validate(test::polygonOutline({{0, 0}, {-1, 0}, {-1, 1}, {0, 1}})), core::Error);
}

}  // namespace
}  // namespace handpiece::instrument::profile_test
