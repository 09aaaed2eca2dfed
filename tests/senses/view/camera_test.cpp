// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/camera.h"

#include <gtest/gtest.h>

#include <numbers>

#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::view::camera_test {
namespace {

using core::Vec2;
using core::Vec3;

constexpr Viewport kViewport{1280, 800};

Camera randomCamera(std::mt19937_64& generator) {
    Camera camera;
    camera.targetMm = 8.0 * test::randomDirection(generator);
    camera.eyeMm = camera.targetMm + test::uniform(generator, 6.0, 300.0) * test::randomDirection(generator);
    do
        camera.up = test::randomDirection(generator);
    while (std::abs(camera.up.dot(camera.forward())) > 0.95);
    camera.fieldOfViewRad = test::uniform(generator, 0.2, 1.2);
    return camera;
}

Vec2 randomPixel(std::mt19937_64& generator) {
    return {test::uniform(generator, 1.0, kViewport.width - 1.0),
            test::uniform(generator, 1.0, kViewport.height - 1.0)};
}

TEST(Camera, APointOnTheRayOfAPixelAppearsAtThatPixel) {
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 500; ++i) {
        const Camera camera = randomCamera(generator);
        const Vec2 pixel = randomPixel(generator);
        const Ray ray = rayThrough(camera, kViewport, pixel);
        EXPECT_NEAR(ray.direction.norm(), 1.0, 1e-12);
        const Vec3 point = ray.originMm + test::uniform(generator, 0.1, 500.0) * ray.direction;
        const auto seen = pixelOf(camera, kViewport, point);
        ASSERT_TRUE(seen);
        EXPECT_LT((*seen - pixel).norm(), 1e-6);
    }
}

TEST(Camera, PixelsCountFromTheTopLeft) {
    Camera camera;  // looks along +y
    camera.eyeMm = {0, -50, 0};
    const double half = 50.0 * std::tan(0.5 * camera.fieldOfViewRad);
    EXPECT_LT((*pixelOf(camera, kViewport, {0, 0, 0}) - Vec2(640, 400)).norm(), 1e-9);
    EXPECT_NEAR(pixelOf(camera, kViewport, {0, 0, half - 1e-9})->y(), 0.0, 1e-4)
        << "up in the tooth is up on the screen";
    EXPECT_GT(pixelOf(camera, kViewport, {1, 0, 0})->x(), 640) << "what is to the right is seen to the right";
    EXPECT_FALSE(pixelOf(camera, kViewport, {0, -51, 0})) << "behind the eye";
    EXPECT_FALSE(pixelOf(camera, kViewport, {0, 0, half + 0.01})) << "above the picture";
}

TEST(Camera, AMillimetreCoversAsManyPixelsAsSaid) {
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 100; ++i) {
        const Camera camera = randomCamera(generator);
        const Vec3 a = camera.targetMm, b = a + 0.01 * camera.right();
        const double pixels = (*pixelOf(camera, kViewport, b) - *pixelOf(camera, kViewport, a)).norm();
        EXPECT_NEAR(0.01 / pixels, mmPerPixel(camera, kViewport, a), 1e-9);
    }
}

TEST(Camera, OrbitKeepsDistanceAndWhatIsInFrontFollowsTheHand) {
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 200; ++i) {
        const Camera camera = randomCamera(generator);
        const double right = test::uniform(generator, -3, 3), up = test::uniform(generator, -3, 3);
        const Camera turned = orbited(camera, right, up);
        EXPECT_NEAR(turned.distanceMm(), camera.distanceMm(), 1e-9);
        EXPECT_EQ(turned.targetMm, camera.targetMm);
        EXPECT_NEAR(turned.up.dot(turned.forward()), 0.0, 1e-9);

        const Vec3 front = camera.targetMm - 0.3 * camera.forward();
        const Camera little = orbited(camera, 0.01 * right, 0.01 * up);
        const Vec2 way = *pixelOf(little, kViewport, front) - *pixelOf(camera, kViewport, front);
        const Vec2 hand(right, -up);  // the screen's y points down
        EXPECT_GT(way.dot(hand) / (way.norm() * hand.norm()), 0.999);
    }
}

TEST(Camera, OrbitGoesOverThePoleWithoutAFlip) {
    Camera camera;
    camera.eyeMm = {0, -60, 0};
    const Camera start = camera;
    Vec3 upward = camera.upward(), right = camera.right();
    constexpr int kSteps = 720;
    for (int i = 0; i < kSteps; ++i) {
        camera = orbited(camera, 0.0, -2.0 * std::numbers::pi / kSteps);
        EXPECT_GT(camera.upward().dot(upward), 0.999) << "step " << i;
        EXPECT_GT(camera.right().dot(right), 0.999) << "step " << i;
        upward = camera.upward();
        right = camera.right();
    }
    EXPECT_LT((camera.eyeMm - start.eyeMm).norm(), 1e-6) << "a whole turn comes home";
    EXPECT_LT((camera.upward() - start.upward()).norm(), 1e-6);
}

TEST(Camera, PanMovesTheTargetsPlaneWithThePointer) {
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 200; ++i) {
        const Camera camera = randomCamera(generator);
        const Vec2 by(test::uniform(generator, -200, 200), test::uniform(generator, -200, 200));
        const Vec3 point = camera.targetMm + 0.3 * camera.right() - 0.2 * camera.upward();
        const Vec2 before = *pixelOf(camera, kViewport, point);
        const auto after = pixelOf(panned(camera, kViewport, by), kViewport, point);
        if (!after) continue;
        EXPECT_LT((*after - before - by).norm(), 1e-6);
    }
}

TEST(Camera, WhatIsZoomedToKeepsItsPixel) {
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 300; ++i) {
        Camera camera = randomCamera(generator);
        const Vec2 pixel = randomPixel(generator);
        const Ray ray = rayThrough(camera, kViewport, pixel);
        const Vec3 point = ray.originMm + test::uniform(generator, 0.7, 1.4) * camera.distanceMm() * ray.direction;
        const double factor = test::uniform(generator, 0.5, 2.0);
        const Camera nearer = zoomed(camera, kViewport, pixel, factor, point);
        const auto seen = pixelOf(nearer, kViewport, point);
        ASSERT_TRUE(seen);
        EXPECT_LT((*seen - pixel).norm(), 0.01);
        EXPECT_NEAR(nearer.distanceMm(), std::clamp(camera.distanceMm() / factor, 4.0, 400.0), 1e-9);
        EXPECT_LT((nearer.forward() - camera.forward()).norm(), 1e-9);

        const Camera free = zoomed(camera, kViewport, pixel, factor);
        const Vec3 atTarget = camera.eyeMm + camera.distanceMm() / ray.direction.dot(camera.forward()) * ray.direction;
        EXPECT_LT((*pixelOf(free, kViewport, atTarget) - pixel).norm(), 0.01) << "at the target's depth";
    }
}

TEST(Camera, ZoomEndsAtItsLimitsAndDoesNotJumpToThem) {
    Camera camera;
    for (int i = 0; i < 100; ++i)
        camera = zoomed(camera, kViewport, {640, 400}, 1.5);
    EXPECT_NEAR(camera.distanceMm(), 4.0, 1e-9);
    for (int i = 0; i < 100; ++i)
        camera = zoomed(camera, kViewport, {640, 400}, 0.7);
    EXPECT_NEAR(camera.distanceMm(), 400.0, 1e-6);
    camera.eyeMm = camera.targetMm + Vec3(0, -700, 0);
    EXPECT_NEAR(zoomed(camera, kViewport, {640, 400}, 0.5).distanceMm(), 700.0, 1e-9);
    EXPECT_NEAR(zoomed(camera, kViewport, {640, 400}, 1.1).distanceMm(), 700.0 / 1.1, 1e-9);
}

void expectFills(const Camera& camera, const core::Box& box, const Viewport& viewport) {
    Vec2 low(1e9, 1e9), high(-1e9, -1e9);
    for (int i = 0; i < 8; ++i) {
        const Vec3 corner((i & 1 ? box.max : box.min).x(), (i & 2 ? box.max : box.min).y(),
                          (i & 4 ? box.max : box.min).z());
        const auto pixel = pixelOf(camera, viewport, corner);
        ASSERT_TRUE(pixel) << "a corner is out of the picture";
        low = low.cwiseMin(*pixel);
        high = high.cwiseMax(*pixel);
    }
    const Vec2 share = (high - low).cwiseQuotient(Vec2(viewport.width, viewport.height));
    EXPECT_GT(share.maxCoeff(), 0.9) << "it could be larger";
    EXPECT_LT(share.maxCoeff(), 0.96) << "there is no margin";
    const Vec2 middle = 0.5 * (low + high);
    EXPECT_LT(std::abs(middle.x() - 0.5 * viewport.width), 1e-6 * viewport.width);
    EXPECT_LT(std::abs(middle.y() - 0.5 * viewport.height), 1e-6 * viewport.height);
}

TEST(Camera, AFittedBoxFillsThePicture) {
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 200; ++i) {
        core::Box box;
        for (int k = 0; k < 2; ++k)
            box.extend(test::uniform(generator, 0.5, 100.0) * test::randomDirection(generator));
        box = box.grown(test::uniform(generator, 2.0, 5.0));
        const Viewport viewport{static_cast<int>(test::uniform(generator, 64, 2000)),
                                static_cast<int>(test::uniform(generator, 64, 2000))};
        expectFills(fitted(randomCamera(generator), box, viewport), box, viewport);
    }
}

TEST(Camera, StandardViewsLookFromTheirSide) {
    core::Box box;
    box.extend({-5.5, -5, -14});
    box.extend({5.5, 5.2, 7});
    for (const int buccal : {-1, 0, 1}) {
        const double y = buccal < 0 ? -1.0 : 1.0;
        const auto forward = [&](StandardView view) { return standardView(view, box, buccal, kViewport).forward(); };
        const auto up = [&](StandardView view) { return standardView(view, box, buccal, kViewport).upward(); };
        EXPECT_LT((forward(StandardView::occlusal) - Vec3(0, 0, -1)).norm(), 1e-9);
        EXPECT_LT((up(StandardView::occlusal) - Vec3(0, -y, 0)).norm(), 1e-9) << "lingual on top";
        EXPECT_LT((forward(StandardView::buccal) - Vec3(0, -y, 0)).norm(), 1e-9);
        EXPECT_LT((forward(StandardView::lingual) - Vec3(0, y, 0)).norm(), 1e-9);
        EXPECT_LT((forward(StandardView::mesial) - Vec3(-1, 0, 0)).norm(), 1e-9);
        EXPECT_LT((forward(StandardView::distal) - Vec3(1, 0, 0)).norm(), 1e-9);
        for (const auto& [view, name] : standardViews()) {
            if (view != StandardView::occlusal) {
                EXPECT_GT(up(view).z(), 0.5) << name << ": the crown is up";
            }
            expectFills(standardView(view, box, buccal, kViewport), box, kViewport);
            EXPECT_EQ(viewByName(name), view);
        }
    }
    const std::string error = test::errorOf([] { (void)viewByName("from above"); });
    EXPECT_NE(error.find("occlusal, buccal, lingual, mesial, distal, oblique"), std::string::npos);
}

TEST(Camera, InAMirrorLeftAndRightChangePlacesAndTheHandTurnsWhatItSees) {
    Camera plain;
    plain.eyeMm = {20, -40, 30};
    plain.targetMm = {1, 2, 3};
    Camera mirrored = plain;
    mirrored.mirrored = true;
    const double width = kViewport.width;
    for (const Vec3& p : {Vec3(0, 0, 0), Vec3(5, -3, 2), Vec3(-4, 4, -6)}) {
        const Vec2 a = pixelOf(plain, kViewport, p).value(), b = pixelOf(mirrored, kViewport, p).value();
        EXPECT_NEAR(b.x(), width - a.x(), 1e-9);
        EXPECT_NEAR(b.y(), a.y(), 1e-9);
        // As a glass would show it: the reflection in the plane through eye and target that holds up, seen plainly.
        const Vec3 r = plain.right(), turned = p - 2.0 * r.dot(p - plain.eyeMm) * r;
        EXPECT_LT((pixelOf(plain, kViewport, turned).value() - b).norm(), 1e-9);
        EXPECT_GT(rayThrough(mirrored, kViewport, b).direction.dot((p - plain.eyeMm).normalized()), 1.0 - 1e-12);
        // What is dragged goes with the pointer.
        const Vec3 near = plain.targetMm - 4.0 * plain.forward();
        const Vec2 at = pixelOf(mirrored, kViewport, near).value();
        EXPECT_GT(pixelOf(orbited(mirrored, 0.1, 0.0), kViewport, near).value().x(), at.x() + 1.0);
        EXPECT_LT(pixelOf(orbited(mirrored, 0.0, 0.1), kViewport, near).value().y(), at.y() - 1.0);
        EXPECT_GT(pixelOf(panned(mirrored, kViewport, {10, 0}), kViewport, p).value().x(), b.x() + 5.0);
    }
}

}  // namespace
}  // namespace handpiece::view::camera_test
