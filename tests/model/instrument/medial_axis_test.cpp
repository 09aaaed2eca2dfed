// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/instrument/medial_axis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "handpiece/model/instrument/piece.h"
#include "outlines.h"

namespace handpiece::instrument::medial_axis_test {
namespace {

using core::Vec2;
using core::Vec3;
using handpiece::test::uniform;

/// max over u in [0, 1] of R(u) - |c(u) - q|: linear minus convex, so it has one maximum in closed form.
double deepest(const MedialBall& a, const MedialBall& b, const Vec2& q) {
    const Vec2 start(a.rhoMm, a.zMm), d = Vec2(b.rhoMm, b.zMm) - start, w = q - start;
    const double length = d.norm(), grow = b.radiusMm - a.radiusMm;
    const auto at = [&](double u) { return a.radiusMm + u * grow - (w - u * d).norm(); };
    double best = std::max(at(0.0), at(1.0));
    if (length > 1e-12 && std::abs(grow) < length) {
        const double k = grow / length, along = w.dot(d) / length, off = (w - d * (along / length)).norm();
        best = std::max(best, at(std::clamp((along + off * k / std::sqrt(1.0 - k * k)) / length, 0.0, 1.0)));
    }
    return best;
}

double deepest(const std::vector<MedialCurve>& curves, const Vec2& q) {
    double best = -std::numeric_limits<double>::infinity();
    for (const MedialCurve& curve : curves)
        for (std::size_t i = 0; i + 1 < curve.balls.size(); ++i)
            best = std::max(best, deepest(curve.balls[i], curve.balls[i + 1], q));
    return best;
}

std::size_t ballCount(const std::vector<MedialCurve>& curves) {
    std::size_t count = 0;
    for (const MedialCurve& curve : curves)
        count += curve.balls.size();
    return count;
}

TEST(MedialAxis, BallsMakeTheBurInAndAroundIt) {
    std::mt19937_64 generator(handpiece::test::seed());
    for (const test::NamedProfile& outline : test::manyOutlines(4, generator)) {
        const std::string& name = outline.first;
        const Profile& profile = outline.second;
        const std::vector<MedialCurve> curves = medialAxis(profile);
        const double r = profile.maxRadiusMm(), length = profile.lengthMm();
        const auto check = [&](const Vec2& q) {
            const double phi = signedDistanceMm(profile, q.x(), q.y());
            // Inside, the ball that leaves most around q; outside, the nearest ball: both are the distance of their
            // union.
            ASSERT_NEAR(deepest(curves, q), -phi, 3.0 * kMedialToleranceMm) << name << " at " << q.transpose();
        };
        for (int i = 0; i < 500; ++i)
            check({uniform(generator, 0.0, 1.3 * r), uniform(generator, -0.3, length + 0.3)});
        // On the outline itself, densest where its pieces meet.
        for (const ProfilePiece& piece : profile.pieces)
            for (int i = 0; i <= 60; ++i)
                check(pointAt(piece, 0.5 - 0.5 * std::cos(3.14159265358979 * i / 60.0)));
    }
}

TEST(MedialAxis, BallsMakeTheSolidInSpace) {
    std::mt19937_64 generator(handpiece::test::seed());
    for (const auto& [name, profile] : test::manyOutlines(1, generator)) {
        const Bur bur(name, profile);
        const double r = 1.2 * bur.maxRadiusMm();
        for (int i = 0; i < 50; ++i) {
            const Vec3 q(uniform(generator, -r, r), uniform(generator, -r, r),
                         uniform(generator, -0.2, bur.lengthMm() + 0.2));
            // Turned about the axis the ball nearest to q stands in q's half-plane; the others are tried all the same.
            double best = -1e300;
            for (int turn = 0; turn < 16; ++turn) {
                const double angle = turn * 3.14159265358979 / 8.0;
                const Vec2 side(std::cos(angle), std::sin(angle));
                const double along = std::hypot(q.x(), q.y()) * side.x(), off = std::hypot(q.x(), q.y()) * side.y();
                for (const MedialCurve& curve : bur.medialAxis())
                    for (const MedialBall& ball : curve.balls)
                        best = std::max(best, ball.radiusMm - Vec3(along - ball.rhoMm, off, q.z() - ball.zMm).norm());
            }
            ASSERT_LE(best, -bur.signedDistance(q) + 1e-7) << name;
            best = std::max(best, deepest(bur.medialAxis(), {std::hypot(q.x(), q.y()), q.z()}));
            ASSERT_NEAR(best, -bur.signedDistance(q), 3.0 * kMedialToleranceMm) << name;
        }
    }
}

TEST(MedialAxis, EveryBallIsInscribedAndTouchesTheOutline) {
    std::mt19937_64 generator(handpiece::test::seed());
    for (const auto& [name, profile] : test::manyOutlines(6, generator))
        for (const MedialCurve& curve : medialAxis(profile)) {
            ASSERT_GE(curve.balls.size(), 2u) << name;
            for (const MedialBall& ball : curve.balls) {
                ASSERT_NEAR(ball.radiusMm, -signedDistanceMm(profile, ball.rhoMm, ball.zMm), 1e-9)
                    << name << " at " << ball.rhoMm << " " << ball.zMm;
                ASSERT_GE(ball.rhoMm, 0.0);
                if (curve.onAxis) {
                    ASSERT_EQ(ball.rhoMm, 0.0);
                }
            }
        }
}

TEST(MedialAxis, InterpolatedBallsStayWithinTheTolerance) {
    std::mt19937_64 generator(handpiece::test::seed());
    for (const auto& [name, profile] : test::manyOutlines(2, generator))
        for (const MedialCurve& curve : medialAxis(profile))
            for (std::size_t i = 0; i + 1 < curve.balls.size(); ++i)
                for (int k = 1; k < 8; ++k) {
                    const double u = k / 8.0;
                    const MedialBall &a = curve.balls[i], &b = curve.balls[i + 1];
                    const double phi =
                        signedDistanceMm(profile, a.rhoMm + u * (b.rhoMm - a.rhoMm), a.zMm + u * (b.zMm - a.zMm));
                    ASSERT_NEAR(a.radiusMm + u * (b.radiusMm - a.radiusMm), -phi, 2.0 * kMedialToleranceMm) << name;
                }
}

TEST(MedialAxis, SharpCornersStartASheetWithoutRadius) {
    std::mt19937_64 generator(handpiece::test::seed());
    for (const auto& [name, profile] : test::manyOutlines(2, generator)) {
        const std::vector<MedialCurve> curves = medialAxis(profile);
        for (std::size_t i = 0; i + 1 < profile.pieces.size(); ++i) {
            if (jointBetween(profile.pieces[i], profile.pieces[i + 1]) != Joint::convex) continue;
            const Vec2& corner = profile.pieces[i].to;
            const bool found = std::any_of(curves.begin(), curves.end(), [&](const MedialCurve& curve) {
                return std::any_of(curve.balls.begin(), curve.balls.end(), [&](const MedialBall& ball) {
                    return ball.radiusMm == 0.0 && ball.rhoMm == corner.x() && ball.zMm == corner.y();
                });
            });
            EXPECT_TRUE(found) << name << " corner " << corner.transpose();
        }
    }
}

TEST(MedialAxis, SimpleBursNeedFewBalls) {
    const std::vector<MedialCurve> capsule = medialAxis(makeProfile(Shape::cylinderRound, 1.0, 4.0));
    ASSERT_EQ(capsule.size(), 2u);
    ASSERT_TRUE(capsule[0].onAxis);
    ASSERT_EQ(capsule[0].balls.size(), 2u);
    EXPECT_NEAR(capsule[0].balls[0].zMm, 0.5, 1e-12);
    EXPECT_NEAR(capsule[0].balls[0].radiusMm, 0.5, 1e-12);
    EXPECT_NEAR(capsule[0].balls[1].zMm, 3.5, 1e-9);
    EXPECT_NEAR(capsule[0].balls[1].radiusMm, 0.5, 1e-12);
    EXPECT_FALSE(capsule[1].onAxis);  // the 45 degree sheet under the flat top
    EXPECT_EQ(capsule[1].balls.size(), 2u);

    for (const double diameter : {0.9, 1.1, 1.2, 1.3, 1.7}) {
        const std::vector<MedialCurve> curves = medialAxis(makeProfile(Shape::cylinderRound, diameter, 4.0));
        ASSERT_EQ(curves[0].balls.size(), 2u);
        EXPECT_EQ(curves[0].balls[0].radiusMm, curves[0].balls[1].radiusMm);
    }

    const std::vector<MedialCurve> ball = medialAxis(makeProfile(Shape::round, 1.4, 1.4));
    ASSERT_EQ(ball.size(), 1u);
    ASSERT_EQ(ball[0].balls.size(), 2u);  // one point, given twice
    EXPECT_TRUE(ball[0].onAxis);
    EXPECT_NEAR(ball[0].balls[0].zMm, 0.7, 1e-12);
    EXPECT_NEAR(ball[0].balls[0].radiusMm, 0.7, 1e-12);
    EXPECT_NEAR(ball[0].balls[1].zMm, ball[0].balls[0].zMm, 1e-12);

    const std::vector<MedialCurve> taper = medialAxis(makeProfile(Shape::taperRound, 1.6, 8.0));
    ASSERT_EQ(taper.size(), 2u);
    EXPECT_EQ(taper[0].balls.size(), 2u);
    EXPECT_EQ(ballCount(medialAxis(makeProfile(Shape::cylinderFlat, 1.0, 4.0))), 6u);
    EXPECT_LE(ballCount(medialAxis(makeProfile(Shape::wheel, 3.0, 1.0))), 6u);
    EXPECT_LE(ballCount(medialAxis(makeProfile(Shape::invertedCone, 1.0, 0.9))), 6u);
}

}  // namespace
}  // namespace handpiece::instrument::medial_axis_test
