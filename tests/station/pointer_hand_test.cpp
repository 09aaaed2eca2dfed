// SPDX-License-Identifier: Apache-2.0
#include "station/pointer_hand.h"

#include <gtest/gtest.h>

#include <cmath>

#include "handpiece/base/core/error.h"

namespace handpiece::station {
namespace {

using core::Quat;
using core::Vec2;
using core::Vec3;
using device::PointerTarget;

constexpr double kRadius = 5.0;
const view::Viewport kViewport{800, 600};

measure::Hit hitAt(const view::Ray& ray, double at, const Vec3& normal) {
    measure::Hit hit;
    hit.distanceMm = at;
    hit.pointMm = ray.originMm + at * ray.direction;
    hit.normal = normal;
    hit.tissue = tooth::Tissue::enamel;
    return hit;
}
/// A tooth below z = 0.
std::optional<measure::Hit> plane(const view::Ray& ray) {
    if (std::abs(ray.direction.z()) < 1e-12) return {};
    const double at = -ray.originMm.z() / ray.direction.z();
    if (at <= 0.0) return {};
    return hitAt(ray, at, Vec3::UnitZ());
}
/// A ball about the origin; from within, its far side.
std::optional<measure::Hit> ball(const view::Ray& ray) {
    const double b = ray.originMm.dot(ray.direction), c = ray.originMm.squaredNorm() - kRadius * kRadius;
    const double inner = b * b - c;
    if (inner < 0.0) return {};
    const double first = -b - std::sqrt(inner), last = -b + std::sqrt(inner);
    const double at = first > 0.0 ? first : last;
    if (at <= 0.0) return {};
    return hitAt(ray, at, (ray.originMm + at * ray.direction).normalized());
}
/// A pit of radius 1 and depth 2 in a plane.
std::optional<measure::Hit> pit(const view::Ray& ray) {
    std::optional<measure::Hit> best;
    const auto keep = [&](double at, const Vec3& normal) {
        if (at > 1e-9 && (!best || at < best->distanceMm)) best = hitAt(ray, at, normal);
    };
    for (const double z : {0.0, -2.0}) {
        if (std::abs(ray.direction.z()) < 1e-12) continue;
        const double at = (z - ray.originMm.z()) / ray.direction.z();
        const Vec3 p = ray.originMm + at * ray.direction;
        if ((p.head<2>().norm() > 1.0) == (z == 0.0)) keep(at, Vec3::UnitZ());
    }
    const Vec2 o = ray.originMm.head<2>(), d = ray.direction.head<2>();
    const double a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - 1.0, inner = b * b - a * c;
    if (a > 1e-12 && inner > 0.0)
        for (const double at : {(-b - std::sqrt(inner)) / a, (-b + std::sqrt(inner)) / a}) {
            const Vec3 p = ray.originMm + at * ray.direction;
            if (p.z() < 0.0 && p.z() > -2.0) keep(at, Vec3(-p.x(), -p.y(), 0.0).normalized());
        }
    return best;
}

view::Camera from(const Vec3& eye, const Vec3& up = Vec3::UnitZ()) {
    view::Camera camera;
    camera.eyeMm = eye;
    camera.targetMm = Vec3::Zero();
    camera.up = up;
    return camera;
}

struct Scene {
    explicit Scene(PointerHand::Cast cast, const Vec3& eye = Vec3(0, -40, 30), const Vec3& up = Vec3::UnitZ())
        : camera(from(eye, up)),
          mailbox(std::make_shared<device::PointerMailbox>()),
          hand(mailbox, {Vec3(0, 0, 12), Quat::Identity()}, std::move(cast)) {
        hand.setEye(camera, kViewport);
        hand.setBur(3.0, 0.5);
    }
    [[nodiscard]] Vec2 pixel(const Vec3& p) const { return view::pixelOf(camera, kViewport, p).value(); }
    [[nodiscard]] Vec3 tip() const { return Vec3(hand.target().positionMm); }
    [[nodiscard]] Quat turn() const {
        const double(&q)[4] = hand.target().orientation;
        return {q[0], q[1], q[2], q[3]};
    }
    [[nodiscard]] Vec3 axis() const { return turn() * Vec3::UnitZ(); }
    void tell(const Vec3& proxy, double depthMm) {
        messages::HapticSample sample;
        for (std::size_t k = 0; k < 3; ++k)
            sample.proxyPositionMm[k] = proxy[static_cast<int>(k)];
        sample.depthMm = depthMm;
        hand.follow(sample);
    }
    view::Camera camera;
    std::shared_ptr<device::PointerMailbox> mailbox;
    PointerHand hand;
};

TEST(PointerHand, theTipHoversHalfAMillimetreOffUnderThePointer) {
    Scene s(plane);
    for (const Vec3& p : {Vec3(0, 0, 0), Vec3(2, 1, 0), Vec3(-3, 2, 0)}) {
        s.hand.move(s.pixel(p));
        EXPECT_NEAR((s.tip() - p - Vec3(0, 0, kHoverMm)).norm(), 0.0, 1e-9);
        EXPECT_EQ(s.hand.target().loadN, 0.0);
        EXPECT_EQ(s.hand.target().pedal, 0.0);
        EXPECT_FALSE(s.hand.target().hasStop);
        // And the device reads just that.
        EXPECT_EQ(s.mailbox->read().positionMm[0], s.hand.target().positionMm[0]);
    }
}

TEST(PointerHand, theWholeHeadIsClearOfAWallOrASlope) {
    Scene s(ball, Vec3(0, -40, 5));
    for (double angle = -1.2; angle <= 1.3; angle += 0.1) {
        const Vec3 p = kRadius * Vec3(0, -std::cos(angle), std::sin(angle));
        const Vec3 seen = (s.camera.eyeMm - p).normalized();
        if (seen.dot(p.normalized()) < 0.05) continue;
        s.hand.move(s.pixel(p));
        // The head: balls of its radius from the round end up.
        double least = 1e9;
        for (double z = 0.5; z <= 2.5; z += 0.1)
            least = std::min(least, (s.tip() + z * s.axis()).norm() - kRadius - 0.5);
        EXPECT_GT(least, kHoverMm - 1e-6) << angle;
        EXPECT_LT((s.tip() - p).norm(), 4.5) << angle;
        if (angle > 0.0) {
            EXPECT_LT(least, kHoverMm + 0.15) << angle;
        }
    }
}

TEST(PointerHand, inItsOwnCavityItStandsOverTheFloorBesideTheWall) {
    Scene s(pit, Vec3(0, -1, 40), Vec3::UnitY());
    s.hand.move(s.pixel(Vec3(0.9, 0, -2)));
    EXPECT_NEAR(s.tip().z(), -1.5, 1e-9);
    EXPECT_LT(s.tip().head<2>().norm() + 0.5, 1.0);
    EXPECT_GT(s.tip().x(), 0.3);
}

TEST(PointerHand, offTheToothItMovesInTheViewPlaneThroughTheLastPlace) {
    Scene s(ball);
    s.hand.move(s.pixel(Vec3(0, 0, kRadius)));
    const Vec3 last = s.tip();
    s.hand.move(Vec2(20, 300));
    EXPECT_NEAR((s.tip() - last).dot(s.camera.forward()), 0.0, 1e-9);
    EXPECT_NEAR((s.pixel(s.tip()) - Vec2(20, 300)).norm(), 0.0, 1e-6);
}

TEST(PointerHand, aPressTurnsAndLoadsWithoutAJump) {
    Scene s(plane);
    const Vec2 pixel = s.pixel(Vec3(1, 1, 0));
    s.hand.move(pixel);
    const Vec3 before = s.tip();
    s.hand.press(pixel, true);
    EXPECT_TRUE(s.hand.isPressed());
    EXPECT_EQ(s.tip(), before);
    EXPECT_EQ(s.hand.target().loadN, kFirstLoadN);
    EXPECT_EQ(s.hand.target().pedal, 1.0);
    s.hand.move(pixel);
    EXPECT_NEAR((s.tip() - before).norm(), 0.0, 1e-9);
    // By now it is 0.3 mm in; let go, it lifts off the surface.
    s.tell(Vec3(1, 1, -0.3), 1.9);
    s.hand.release();
    EXPECT_NEAR((s.tip() - Vec3(1, 1, kHoverMm)).norm(), 0.0, 1e-9);
    EXPECT_EQ(s.hand.target().loadN, 0.0);
    EXPECT_EQ(s.hand.target().pedal, 0.0);
    EXPECT_FALSE(s.hand.isPressed());
    // Touching only.
    s.tell(Vec3(1, 1, 0.5), -0.5);
    s.hand.press(pixel, false);
    EXPECT_EQ(s.hand.target().pedal, 0.0);
    EXPECT_EQ(s.hand.target().loadN, kFirstLoadN);
}

TEST(PointerHand, aBurIsWithdrawnFromACavityTurning) {
    for (const bool hangs : {false, true}) {
        Scene s(plane);
        const Vec2 pixel = s.pixel(Vec3(1, 1, 0)), elsewhere = s.pixel(Vec3(2, 1, 0));
        s.hand.move(pixel);
        s.hand.press(pixel, true);
        s.tell(Vec3(1, 1, -1.4), 1.9);
        s.hand.release();
        const Vec3 out(1, 1, kHoverMm);
        EXPECT_NEAR((s.tip() - out).norm(), 0.0, 1e-9);
        EXPECT_EQ(s.hand.target().pedal, 1.0);
        EXPECT_EQ(s.hand.target().loadN, 0.0);
        // Not sideways through the wall.
        s.hand.move(elsewhere);
        EXPECT_NEAR((s.tip() - out).norm(), 0.0, 1e-9);
        if (hangs) {
            int pictures = 0;
            for (; s.hand.target().pedal > 0.0 && pictures < 1000; ++pictures)
                s.tell(Vec3(1, 1, -1.0), -0.1);
            EXPECT_GT(pictures, 10);
            EXPECT_LT(pictures, 100);
        } else {
            s.tell(Vec3(1, 1, 0.0), -0.1);
            EXPECT_EQ(s.hand.target().pedal, 1.0);
            s.tell(Vec3(1, 1, kHoverMm - 0.05), -0.5);
            EXPECT_EQ(s.hand.target().pedal, 0.0);
            s.hand.move(elsewhere);
            EXPECT_GT((s.tip() - out).norm(), 0.5);
        }
    }
    // A still bur only touched: nothing turns.
    Scene s(plane);
    const Vec2 pixel = s.pixel(Vec3(1, 1, 0));
    s.hand.move(pixel);
    s.hand.press(pixel, false);
    s.tell(Vec3(1, 1, -1.4), 1.9);
    s.hand.release();
    EXPECT_EQ(s.hand.target().pedal, 0.0);
}

TEST(PointerHand, draggingStaysInThePlaneOfThePress) {
    struct Row {
        const char* what;
        Vec3 eye;
        bool edgeOn;
    };
    for (const Row& row : {Row{"from above", Vec3(0, -10, 40), false}, Row{"aslant", Vec3(0, -40, 30), false},
                           Row{"from the side", Vec3(0, -50, 1), true}}) {
        SCOPED_TRACE(row.what);
        Scene s(plane, row.eye);
        const Vec3 p(0.5, 0, 0);
        s.hand.move(s.pixel(p));
        const Vec3 start = s.tip();
        s.hand.press(s.pixel(p), true);
        Vec3 last = start;
        for (int i = 1; i <= 20; ++i) {
            s.hand.move(s.pixel(p) + Vec2(2.0 * i, row.edgeOn ? 0.0 : -1.0 * i));
            EXPECT_NEAR(s.tip().z(), start.z(), 1e-9);
            EXPECT_LT((s.tip() - last).norm(), 0.4);
            EXPECT_GT((s.tip() - last).norm(), 0.01);
            last = s.tip();
        }
        // What was under the pointer goes with it.
        const Vec2 moved = s.pixel(last) - s.pixel(start);
        EXPECT_NEAR(moved.x(), 40.0, 1.0);
    }
}

TEST(PointerHand, aPressOnAWallPushesIntoIt) {
    Scene s(ball, Vec3(0, -40, 0));
    const Vec2 pixel = s.pixel(Vec3(0, -kRadius, 0));
    s.hand.move(pixel);
    EXPECT_NEAR(s.tip().y(), -kRadius - kHoverMm - 0.5, 1e-6);
    s.hand.press(pixel, true);
    EXPECT_EQ(s.hand.target().loadN, 0.0);
    EXPECT_EQ(s.hand.target().pedal, 1.0);
    // The bur's side meets the wall 0.5 mm on; from there 1 N takes 0.25 mm of the hand's spring and 0.5 mm of
    // enamel's.
    EXPECT_NEAR(s.tip().y(), -kRadius - 0.5 + 0.75, 1e-6);
    s.hand.setLoad(2.0);
    EXPECT_NEAR(s.tip().y(), -kRadius - 0.5 + 1.5, 1e-6);
    s.tell(Vec3(0, -kRadius - 0.4, 0), 1.0);
    s.hand.release();
    EXPECT_NEAR(s.tip().y(), -kRadius - 0.4 - kHoverMm, 1e-6);
}

TEST(PointerHand, aPressInTheAirDoesNotFall) {
    Scene s(ball);
    s.hand.move(Vec2(20, 300));
    const Vec3 before = s.tip();
    s.hand.press(Vec2(20, 300), true);
    EXPECT_EQ(s.hand.target().loadN, 0.0);
    EXPECT_EQ(s.hand.target().pedal, 1.0);
    s.hand.move(Vec2(60, 300));
    EXPECT_GT((s.tip() - before).norm(), 0.5);
    EXPECT_NEAR((s.tip() - before).dot(s.axis()), 0.0, 1e-9);
}

TEST(PointerHand, draggedOffTheEdgeItKeepsItsHeight) {
    // A table that ends at x = 2.
    Scene s([](const view::Ray& ray) {
        auto hit = plane(ray);
        if (hit && hit->pointMm.x() > 2.0) hit.reset();
        return hit;
    });
    s.hand.move(s.pixel(Vec3(1.5, 0, 0)));
    s.hand.press(s.pixel(Vec3(1.5, 0, 0)), true);
    s.tell(Vec3(1.5, 0, 0), 2.0);
    s.hand.move(s.pixel(Vec3(1.7, 0, 0)));
    EXPECT_EQ(s.hand.target().loadN, kFirstLoadN);
    s.hand.move(s.pixel(Vec3(2.6, 0, 0)));
    EXPECT_EQ(s.hand.target().loadN, 0.0);
    EXPECT_NEAR(s.tip().z(), 0.0, 1e-9);
    s.hand.move(s.pixel(Vec3(1.6, 0, 0)));
    EXPECT_EQ(s.hand.target().loadN, kFirstLoadN);
}

TEST(PointerHand, slowIsAFifthFromWhereItBegan) {
    Scene s(plane, Vec3(0, -1, 40), Vec3::UnitY());
    const Vec2 start = s.pixel(Vec3(0, 0, 0));
    s.hand.move(start);
    s.hand.press(start, true);
    s.hand.move(start + Vec2(10, 0));
    const double fast = s.tip().x();
    s.hand.move(start + Vec2(20, 0), true);
    EXPECT_NEAR(s.tip().x(), fast * 1.2, 1e-6);
    s.hand.move(start + Vec2(60, 0), true);
    EXPECT_NEAR(s.tip().x(), fast * 2.0, 1e-6);
    // Shift let go: no jump while pressed.
    s.hand.move(start + Vec2(60, 0));
    EXPECT_NEAR(s.tip().x(), fast * 2.0, 1e-6);
    s.hand.move(start + Vec2(70, 0));
    EXPECT_NEAR(s.tip().x(), fast * 3.0, 1e-6);
    s.hand.release();
    s.hand.move(start + Vec2(70, 0));
    EXPECT_NEAR((s.pixel(s.tip() - Vec3(0, 0, kHoverMm)) - start - Vec2(70, 0)).norm(), 0.0, 1e-6);
}

TEST(PointerHand, theStopIsBelowTheSurfaceOfThePress) {
    Scene s(plane);
    s.hand.move(s.pixel(Vec3::Zero()));
    s.hand.setStop(1.5);
    s.hand.press(s.pixel(Vec3::Zero()), true);
    ASSERT_TRUE(s.hand.target().hasStop);
    EXPECT_NEAR(s.hand.target().stopMm[2], -1.5, 1e-9);
    s.hand.setStop(0.7);
    EXPECT_NEAR(s.hand.target().stopMm[2], -0.7, 1e-9);
    // Without one, what it may fall is bounded all the same.
    s.hand.setStop({});
    EXPECT_FALSE(s.hand.stopMm());
    EXPECT_TRUE(s.hand.target().hasStop);
    EXPECT_NEAR(s.hand.target().stopMm[2], -10.0, 1e-9);
    s.hand.release();
    EXPECT_FALSE(s.hand.target().hasStop);
}

TEST(PointerHand, theStopCountsFromTheUncutSurface) {
    Scene s(plane);  // the floor of a cavity 0.9 mm deep
    s.hand.setGoneOver([](const Vec3&, const Vec3& axis) { return 0.9 * axis.z(); });
    s.hand.move(s.pixel(Vec3::Zero()));
    s.hand.setStop(1.5);
    s.hand.press(s.pixel(Vec3::Zero()), true);
    EXPECT_NEAR(s.hand.target().stopMm[2], 0.9 - 1.5, 1e-9);
}

TEST(PointerHand, theLoadIsHeldWithinWhatAHandPresses) {
    Scene s(plane);
    for (const auto& [asked, held] :
         {std::pair{1.7, 1.7}, {0.01, kLeastLoadN}, {9.0, kMostLoadN}, {-1.0, kLeastLoadN}}) {
        s.hand.setLoad(asked);
        EXPECT_EQ(s.hand.loadN(), held);
    }
    s.hand.setLoad(2.0);
    s.hand.setLoad(std::nan(""));
    EXPECT_EQ(s.hand.loadN(), 2.0);
    s.hand.move(s.pixel(Vec3::Zero()));
    s.hand.press(s.pixel(Vec3::Zero()), true);
    EXPECT_EQ(s.hand.target().loadN, 2.0);
}

TEST(PointerHand, pivotTurnsAboutTheTipTowardsThePointer) {
    Scene s(plane);
    s.hand.move(s.pixel(Vec3::Zero()));
    const Vec3 tip = s.tip();
    s.hand.pivot(Vec2(40, 0));
    EXPECT_EQ(s.tip(), tip);
    EXPECT_NEAR(std::acos(s.axis().z()), 40 * 0.005, 1e-6);
    EXPECT_GT(s.axis().dot(s.camera.right()), 0.0);
    EXPECT_NEAR(s.turn().norm(), 1.0, 1e-12);
    s.hand.alignToTooth();
    EXPECT_NEAR(s.axis().z(), 1.0, 1e-12);
    const Vec3 handle = s.turn() * Vec3::UnitX();
    s.hand.roll(0.3);
    EXPECT_NEAR(s.axis().z(), 1.0, 1e-12);
    EXPECT_NEAR((s.turn() * Vec3::UnitX()).dot(handle), std::cos(0.3), 1e-12);
}

TEST(PointerHand, alignsToTheSurfaceUnderTheTip) {
    Scene s(ball, Vec3(0, -30, 30));
    const Vec3 p = kRadius * Vec3(0.3, -0.5, std::sqrt(1 - 0.09 - 0.25));
    s.hand.move(s.pixel(p));
    s.hand.alignToNormal();
    EXPECT_NEAR(s.axis().dot(p.normalized()), 1.0, 1e-9);
    s.hand.move(s.pixel(p));
    EXPECT_NEAR(s.tip().norm(), kRadius + kHoverMm, 1e-9);
}

TEST(PointerHand, nudgesGoAlongTheScreenAndTheAxis) {
    Scene s(plane);
    s.hand.move(s.pixel(Vec3::Zero()));
    const Vec3 start = s.tip();
    s.hand.nudge(kNudgeMm, 0, 0);
    EXPECT_NEAR((s.tip() - start - kNudgeMm * s.camera.right()).norm(), 0.0, 1e-12);
    s.hand.nudge(0, kNudgeMm, kFineNudgeMm);
    EXPECT_NEAR((s.tip() - start - kNudgeMm * (s.camera.right() + s.camera.upward()) + kFineNudgeMm * s.axis()).norm(),
                0.0, 1e-12);
    // Into the tooth only so far ahead of the bur.
    s.tell(Vec3(0, 0, 0), 0.4);
    for (int i = 0; i < 50; ++i)
        s.hand.nudge(0, 0, kNudgeMm);
    EXPECT_GT(s.tip().z(), -0.51);
}

TEST(PointerHand, frozenStaysAndGoesOnFromThere) {
    Scene s(plane);
    const Vec2 pixel = s.pixel(Vec3::Zero());
    s.hand.move(pixel);
    s.hand.press(pixel, true);
    const Vec3 before = s.tip();
    s.hand.freeze(true);
    EXPECT_TRUE(s.hand.target().frozen);
    s.hand.move(pixel + Vec2(100, 0));
    EXPECT_EQ(s.tip(), before);
    s.camera = from(Vec3(-20, -40, 30));
    s.hand.setEye(s.camera, kViewport);
    s.hand.freeze(false);
    // Pressed, it goes on from where it stands, whatever is under the pointer now.
    s.hand.move(pixel + Vec2(100, 0));
    EXPECT_NEAR((s.tip() - before).norm(), 0.0, 1e-9);
    s.hand.move(pixel + Vec2(101, 0));
    EXPECT_LT((s.tip() - before).norm(), 0.1);
}

TEST(PointerHand, escapeEndsEverythingAndTheNextMoveBringsItBack) {
    Scene s(plane);
    const Vec2 pixel = s.pixel(Vec3::Zero());
    s.hand.move(pixel);
    s.hand.latchPedal(true);
    EXPECT_EQ(s.hand.target().pedal, 1.0);
    EXPECT_TRUE(s.hand.pedalLatched());
    s.hand.press(pixel, true);
    s.hand.escape();
    EXPECT_TRUE(s.hand.isAway());
    EXPECT_TRUE(s.hand.target().away);
    EXPECT_EQ(s.hand.target().pedal, 0.0);
    EXPECT_EQ(s.hand.target().loadN, 0.0);
    EXPECT_FALSE(s.hand.isPressed());
    EXPECT_FALSE(s.hand.pedalLatched());
    s.hand.move(pixel);
    EXPECT_FALSE(s.hand.isAway());
    EXPECT_EQ(s.hand.target().pedal, 0.0);
    s.hand.escape();
    s.hand.press(pixel, true);
    EXPECT_FALSE(s.hand.isAway());
    EXPECT_EQ(s.hand.target().loadN, kFirstLoadN);
}

TEST(PointerHand, theHandleBeginsOutOfTheMouth) {
    const core::Box box{Vec3(-5, -4, -10), Vec3(5, 4, 8)};
    const core::Pose molar = startPose(box, 36, 1), incisor = startPose(box, 11, -1);
    EXPECT_GT((molar.orientation * Vec3::UnitX()).x(), 0.9);
    EXPECT_GT((molar.orientation * Vec3::UnitX()).y(), 0.0);
    EXPECT_LT((incisor.orientation * Vec3::UnitX()).y(), -0.99);
    EXPECT_GT(molar.positionMm.z(), 8.0);
    EXPECT_NEAR((molar.orientation * Vec3::UnitZ()).z(), 1.0, 1e-12);
}

TEST(PointerHand, whatMakesNoSenseChangesNothing) {
    EXPECT_THROW(PointerHand(nullptr, {}, plane), core::Error);
    EXPECT_THROW(PointerHand(std::make_shared<device::PointerMailbox>(), {}, {}), core::Error);
    Scene s(plane);
    s.hand.move(s.pixel(Vec3::Zero()));
    const Vec3 before = s.tip();
    s.hand.move(Vec2(std::nan(""), 0));
    s.hand.nudge(std::nan(""), 0, 0);
    s.hand.roll(INFINITY);
    s.hand.pivot(Vec2(0, std::nan("")));
    s.hand.release();
    EXPECT_EQ(s.tip(), before);
}

}  // namespace
}  // namespace handpiece::station
