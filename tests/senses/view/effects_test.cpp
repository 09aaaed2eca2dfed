// SPDX-License-Identifier: Apache-2.0
// What lies over the tooth, found again in pictures: where optics, lengths and pixels say that it must be.
#include "handpiece/senses/view/effects.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/senses/view/renderer.h"
#include "support/random.h"

namespace handpiece::view::effects_test {
namespace {

using core::Vec2;
using core::Vec3;

constexpr Viewport kViewport{480, 360};

/// A ball of 12 x 24 patches.
geometry::TriangleMesh ballAt(const Vec3& centre, double radiusMm) {
    geometry::TriangleMesh mesh;
    constexpr int kRows = 12, kAround = 24;
    for (int i = 0; i <= kRows; ++i)
        for (int j = 0; j < kAround; ++j) {
            const double a = std::numbers::pi * i / kRows, b = 2.0 * std::numbers::pi * j / kAround;
            mesh.vertices.push_back(centre +
                                    radiusMm * Vec3(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)));
        }
    for (int i = 0; i < kRows; ++i)
        for (int j = 0; j < kAround; ++j) {
            const auto at = [&](int row, int k) { return static_cast<std::uint32_t>(row * kAround + k % kAround); };
            if (i > 0) mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
            if (i + 1 < kRows) mesh.triangles.push_back({at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
        }
    return mesh;
}

Look plain() {
    Look look;
    look.quality = Quality::fine;
    look.wet = look.shadows = look.bur = look.turbine = false;
    return look;
}

Camera frontal() {
    Camera camera;
    camera.eyeMm = {0, -60, 0};
    return camera;
}

Image drawn(Renderer& renderer, const Camera& camera, const Look& look, const Moment& moment) {
    Image image;
    for (int i = 0; i < 4; ++i)
        if (!renderer.draw(camera, kViewport, look, moment, image).refining) break;
    return image;
}

struct Found {
    std::size_t count = 0;
    Vec2 middle = Vec2::Zero(), low{1e9, 1e9}, high{-1e9, -1e9};
};
Found find(const Image& image, const std::function<bool(int, int)>& wanted) {
    Found found;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            if (wanted(x, y)) {
                const Vec2 p(x + 0.5, y + 0.5);
                found.middle += p;
                found.low = found.low.cwiseMin(p - Vec2(0.5, 0.5));
                found.high = found.high.cwiseMax(p + Vec2(0.5, 0.5));
                ++found.count;
            }
    if (found.count > 0) found.middle /= static_cast<double>(found.count);
    return found;
}
bool isRed(const Image& image, int x, int y) {
    const std::uint8_t* p = image.at(x, y);
    return p[0] > 60 && p[0] > 2 * p[1] && p[0] > 2 * p[2];
}
bool differs(const Image& a, const Image& b, int x, int y, int by = 12) {
    for (int c = 0; c < 3; ++c)
        if (std::abs(static_cast<int>(a.at(x, y)[c]) - static_cast<int>(b.at(x, y)[c])) > by) return true;
    return false;
}

Vec3 reflectedIn(const MirrorPose& mirror, const Vec3& p) {
    return p - 2.0 * (p - mirror.centreMm).dot(mirror.normal) * mirror.normal;
}

TEST(Effects, TheMirrorShowsABallWhereItsReflectionIs) {
    Renderer renderer;
    std::mt19937_64 generator(test::seed());
    const Camera camera = frontal();
    MirrorPose mirror;
    mirror.centreMm = {0, 4, 0};
    int seen = 0;
    for (int i = 0; i < 40; ++i) {
        // In front of the glass, which leans; the ball itself is passed over where it is seen directly.
        mirror.normal =
            Vec3(test::uniform(generator, -0.5, 0.5), -1.0, test::uniform(generator, -0.4, 0.4)).normalized();
        const Vec3 along = (Vec3::UnitX() - mirror.normal * mirror.normal.x()).normalized();
        const Vec3 up = mirror.normal.cross(along);
        const Vec3 apparent = mirror.centreMm + test::uniform(generator, -4, 4) * along +
                              test::uniform(generator, -4, 4) * up - test::uniform(generator, 12, 25) * mirror.normal;
        const Vec3 ball = reflectedIn(mirror, apparent);
        const auto direct = pixelOf(camera, kViewport, ball), expected = pixelOf(camera, kViewport, apparent);
        if (!expected || (direct && (*direct - *expected).norm() < 60.0)) continue;
        // Nor where a part of it looks in at the picture's edge.
        const Vec2 edge = (*expected - 0.5 * Vec2(kViewport.width, kViewport.height)).cwiseAbs();
        if (edge.x() > 0.5 * kViewport.width - 60.0 || edge.y() > 0.5 * kViewport.height - 60.0) continue;
        // The whole of it must be seen through the glass.
        const Vec3 sight = (apparent - camera.eyeMm).normalized();
        const double reach = (mirror.centreMm - camera.eyeMm).dot(mirror.normal) / sight.dot(mirror.normal);
        if ((camera.eyeMm + reach * sight - mirror.centreMm).norm() > 7.0) continue;
        renderer.setMesh(ballAt(ball, 0.7), cases::Tissue::pulp);
        Moment moment;
        moment.burShown = false;
        moment.mirror = mirror;
        const Image image = drawn(renderer, camera, plain(), moment);
        const Found red =
            find(image, [&](int x, int y) { return isRed(image, x, y) && (Vec2(x, y) - *expected).norm() < 40.0; });
        ASSERT_GT(red.count, 8u) << "no reflection, case " << i;
        EXPECT_LT((red.middle - *expected).norm(), 2.5) << "case " << i;
        ++seen;
    }
    EXPECT_GE(seen, 5);
}

TEST(Effects, WhatLiesBehindTheMirrorIsNotInIt) {
    Renderer renderer;
    renderer.setMesh(ballAt({0, 14, 0}, 2.0), cases::Tissue::pulp);
    Moment moment;
    moment.burShown = false;
    const auto red = [&] {
        const Image image = drawn(renderer, frontal(), plain(), moment);
        return find(image, [&](int x, int y) { return isRed(image, x, y); }).count;
    };
    EXPECT_GT(red(), 100u);
    moment.mirror = MirrorPose{{0, 4, 0}, -Vec3::UnitY(), Vec3::UnitX(), 11.0};
    EXPECT_EQ(red(), 0u) << "hidden by the glass, and not reflected";
    moment.mirror->normal = Vec3::UnitY();
    EXPECT_EQ(red(), 0u) << "the mirror's back is metal";
}

TEST(Effects, TheForceArrowIsTwoMillimetresANewton) {
    Renderer renderer;
    renderer.setMesh(ballAt({0, 8, 0}, 0.5), cases::Tissue::enamel);
    Look look = plain();
    Moment moment;
    moment.contactPointMm = {-1.0, 0.0, 0.5};
    moment.contact = true;
    const Image without = drawn(renderer, frontal(), look, moment);
    look.forceArrow = true;
    for (const double newtons : {0.8, 1.5, 3.0}) {
        moment.forceN = {newtons, 0.0, 0.0};
        const Image with = drawn(renderer, frontal(), look, moment);
        const Found arrow = find(with, [&](int x, int y) { return differs(with, without, x, y); });
        const Vec2 tail = *pixelOf(frontal(), kViewport, moment.contactPointMm);
        const Vec2 head = *pixelOf(frontal(), kViewport, moment.contactPointMm + 2.0 * moment.forceN);
        EXPECT_NEAR(arrow.low.x(), tail.x(), 2.0);
        EXPECT_NEAR(arrow.high.x(), head.x(), 3.0) << newtons << " N";
        EXPECT_NEAR(arrow.middle.y(), tail.y(), 2.0);
    }
    moment.forceN = Vec3::Zero();
    const Image none = drawn(renderer, frontal(), look, moment);
    EXPECT_EQ(none.rgba, without.rgba) << "without a force there is no arrow";
}

TEST(Effects, TheScaleBarIsFiveMillimetresAtTheTarget) {
    Renderer renderer;
    renderer.setMesh(ballAt({0, 0, 9}, 0.5), cases::Tissue::enamel);
    Moment moment;
    Look look = plain();
    for (const double distance : {45.0, 60.0, 110.0}) {
        Camera camera = frontal();
        camera.eyeMm.y() = -distance;
        look.scaleBar = false;
        const Image without = drawn(renderer, camera, look, moment);
        look.scaleBar = true;
        const Image with = drawn(renderer, camera, look, moment);
        const Found bar = find(with, [&](int x, int y) { return differs(with, without, x, y); });
        const double expected = 5.0 / mmPerPixel(camera, kViewport, camera.targetMm);
        EXPECT_NEAR(bar.high.x() - bar.low.x(), expected, 5.0) << "with its edge";
        EXPECT_LT(bar.high.x(), 0.5 * kViewport.width);
        EXPECT_GT(bar.low.y(), 0.8 * kViewport.height) << "lower left";
    }
}

TEST(Effects, SprayAndChipsAreSeenWhereTheBurIsAndGoWhenNotWanted) {
    Renderer renderer;
    renderer.setMesh(ballAt({0, 0, -6}, 2.0), cases::Tissue::enamel);
    Look look = plain();
    Moment moment;
    moment.timeS = 2.0;
    moment.burInTooth.positionMm = {0, 0, -4};
    moment.speedRpm = 250000;
    moment.removalMm3S = 2.0;
    moment.tissue = cases::Tissue::enamel;
    moment.contact = true;
    moment.contactPointMm = {0.4, 0, -4};
    moment.water = true;
    const Image with = drawn(renderer, frontal(), look, moment);
    const Image again = drawn(renderer, frontal(), look, moment);
    EXPECT_EQ(with.rgba, again.rgba) << "time stands still";
    look.debris = look.spray = false;
    const Image without = drawn(renderer, frontal(), look, moment);
    const Found seen = find(with, [&](int x, int y) { return differs(with, without, x, y); });
    EXPECT_GT(seen.count, 200u);
    const Vec2 tip = *pixelOf(frontal(), kViewport, moment.burInTooth.positionMm);
    EXPECT_LT((seen.middle - tip).norm(), 80.0);
    moment.removalMm3S = 0.0;
    moment.water = false;
    look.debris = look.spray = true;
    moment.timeS = 9.0;
    EXPECT_EQ(drawn(renderer, frontal(), look, moment).rgba, without.rgba);
}

TEST(Stereo, BothEyesAgreeAtTheTargetAndDifferInFrontAndBehind) {
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 50; ++i) {
        Camera camera;
        camera.eyeMm = test::uniform(generator, 20, 100) * test::randomDirection(generator);
        camera.up = camera.forward().unitOrthogonal();
        const double apart = test::uniform(generator, 0.5, 5.0), d = camera.distanceMm();
        const auto x = [&](int side, const Vec3& p) {
            const gl::Vec4f c =
                stereoEye(camera, kViewport, apart, side).viewProjection() * gl::Vec4f(p.cast<float>().homogeneous());
            return static_cast<double>(c.x() / c.w());
        };
        const double perMm = std::abs(eyeOf(camera, kViewport).projection(0, 0));
        for (const double off : {0.0, -0.3, 0.5}) {
            const Vec3 p = camera.targetMm + off * d * camera.forward() + 1.5 * camera.right() + camera.upward();
            // By similar triangles: the eyes' distance, seen from there, against that in the target's plane.
            const double expected = perMm * apart * (1.0 / (d * (1.0 + off)) - 1.0 / d);
            EXPECT_NEAR(x(-1, p) - x(1, p), expected, 1e-4);
        }
    }
}

Image grey(int width, int height, std::uint8_t r, std::uint8_t g, std::uint8_t b) {
    Image image{width, height, {}};
    for (int i = 0; i < width * height; ++i)
        image.rgba.insert(image.rgba.end(), {r, g, b, 255});
    return image;
}

TEST(Stereo, AnaglyphKeepsGreysAndGivesEachEyeItsPicture) {
    const Viewport size{8, 4};
    Image out;
    for (const std::uint8_t level : {0, 40, 128, 200, 255}) {
        const Image both = grey(8, 4, level, level, level);
        composeStereo(both, both, size, Stereo::anaglyph, out);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(out.at(3, 2)[c], level, 2);
    }
    composeStereo(grey(8, 4, 255, 255, 255), grey(8, 4, 0, 0, 0), size, Stereo::anaglyph, out);
    EXPECT_GT(out.at(0, 0)[0], 240) << "the left eye's white is red";
    EXPECT_LT(out.at(0, 0)[1] + out.at(0, 0)[2], 20);
    composeStereo(grey(8, 4, 0, 0, 0), grey(8, 4, 255, 255, 255), size, Stereo::anaglyph, out);
    EXPECT_LT(out.at(0, 0)[0], 20) << "the right eye's is cyan";
    EXPECT_GT(out.at(0, 0)[1], 240);
    EXPECT_GT(out.at(0, 0)[2], 240);
}

TEST(Stereo, SideBySideHasTheLeftEyeOnTheLeft) {
    Image out;
    for (const int width : {16, 17}) {
        composeStereo(grey(8, 4, 10, 20, 30), grey(8, 4, 200, 210, 220), {width, 4}, Stereo::sideBySide, out);
        ASSERT_EQ(out.width, width);
        EXPECT_EQ(out.at(7, 3)[0], 10);
        EXPECT_EQ(out.at(8, 0)[0], 200);
        EXPECT_EQ(out.at(15, 3)[2], 220);
        EXPECT_EQ(out.at(width - 1, 0)[3], 255);
    }
    EXPECT_THROW(composeStereo(grey(8, 4, 1, 1, 1), grey(7, 4, 1, 1, 1), {16, 4}, Stereo::sideBySide, out),
                 core::Error);
}

}  // namespace
}  // namespace handpiece::view::effects_test
