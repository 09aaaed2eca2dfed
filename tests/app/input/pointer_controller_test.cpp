// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/input/pointer_controller.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <utility>

#include "handpiece/base/core/error.h"

namespace handpiece::input::pointer_controller_test {
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
    hit.tissue = cases::Tissue::enamel;
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
/// The bur: balls of half a millimetre, from its round end to 3 mm up. The tooth was cut `cutMm` deep, the same
/// everywhere, when the stroke began; `body`: how far the handpiece behind it is clear.
class Felt final : public HandFeel {
  public:
    using Distance = std::function<double(const Vec3&)>;
    explicit Felt(Distance distance) : distance_(std::move(distance)) {}
    Clearance ofBur(const core::Pose& pose) override {
        double clear = kFarClearMm;
        for (double z = 0.5; z <= 2.5; z += 0.125)
            clear = std::min(clear, distance_(pose.apply(Vec3(0, 0, z))) - 0.5);
        return {clear, what ? what(pose) : std::uint16_t{0}, true};
    }
    double ofBodyMm(const core::Pose& pose) override { return body ? body(pose) : kFarClearMm; }
    double ofSideMm(const core::Pose& pose) override { return side ? side(pose) : kFarClearMm; }
    double inStrokeMm(const core::Pose& pose) override { return ofBur(pose).mm + cutMm; }
    void beginStroke() override { ++strokes; }

    std::function<double(const core::Pose&)> body, side;
    std::function<std::uint16_t(const core::Pose&)> what;
    double cutMm = 0.0;
    int strokes = 0;

  private:
    Distance distance_;
};
double planeMm(const Vec3& p) {
    return p.z();
}
double ballMm(const Vec3& p) {
    return p.norm() - kRadius;
}
/// A step: low for x < 0, 3 mm higher for x > 0.
double stepMm(const Vec3& p) {
    const double low = p.z();
    const Vec3 out(std::max(0.0, -p.x()), 0.0, std::max(0.0, p.z() - 3.0));
    const double block = out.norm() > 0.0 ? out.norm() : std::max(-p.x(), p.z() - 3.0);
    return std::min(low, block);
}

view::Camera from(const Vec3& eye, const Vec3& up = Vec3::UnitZ()) {
    view::Camera camera;
    camera.eyeMm = eye;
    camera.targetMm = Vec3::Zero();
    camera.up = up;
    return camera;
}

struct Scene {
    explicit Scene(double (&distance)(const Vec3&), const Vec3& eye = Vec3(0, -40, 30), const Vec3& up = Vec3::UnitZ())
        : camera(from(eye, up)),
          mailbox(std::make_shared<device::PointerMailbox>()),
          felt(std::make_shared<Felt>(distance)),
          hand(mailbox, {Vec3(0, 0, 12), Quat::Identity()}, distance == ballMm ? ball : plane) {
        hand.setEye(camera, kViewport);
        hand.setFeel(felt);
    }
    [[nodiscard]] Vec3 way() const { return Vec3(hand.target().way); }
    [[nodiscard]] double clearMm(double (&distance)(const Vec3&)) const {
        return Felt(distance).ofBur({tip(), turn()}).mm;
    }
    /// Of a place from the line of sight through a pixel [px].
    [[nodiscard]] double besides(const Vec2& at, const Vec3& p) const { return (pixel(p) - at).norm(); }
    [[nodiscard]] Vec2 pixel(const Vec3& p) const { return view::pixelOf(camera, kViewport, p).value(); }
    [[nodiscard]] Vec3 tip() const { return Vec3(hand.target().positionMm); }
    [[nodiscard]] Quat turn() const {
        const double(&q)[4] = hand.target().orientation;
        return {q[0], q[1], q[2], q[3]};
    }
    [[nodiscard]] Vec3 axis() const { return turn() * Vec3::UnitZ(); }
    void tell(const Vec3& proxy, double depthMm) {
        messages::HapticSample sample;
        sample.tick = 1;
        sample.timeS = timeS += 0.033;
        for (std::size_t k = 0; k < 3; ++k)
            sample.proxyPositionMm[k] = proxy[static_cast<int>(k)];
        sample.depthMm = depthMm;
        hand.follow(sample);
    }
    view::Camera camera;
    std::shared_ptr<device::PointerMailbox> mailbox;
    std::shared_ptr<Felt> felt;
    PointerController hand;
    double timeS = 0.0;  // told last: a picture every 33 ms
};

TEST(PointerController, theTipHoversHalfAMillimetreOffUnderThePointer) {
    for (const auto distance : {planeMm, ballMm}) {
        Scene s(*distance);
        for (const Vec3& p : {Vec3(0, 0, 1), Vec3(2, 1, 2), Vec3(-3, 2, 1), Vec3(1, -2, 4)}) {
            const Vec2 at = s.pixel(p);
            // Over the ball it may go by a way of several parts.
            for (int i = 0; i < 10 && (i == 0 || s.hand.target().regrips); ++i) {
                s.hand.move(at);
                s.tell(s.tip(), 0.0);
            }
            EXPECT_NEAR(s.besides(at, s.tip()), 0.0, 1e-6);
            EXPECT_NEAR(s.clearMm(*distance), kHoverMm, 0.002);
            EXPECT_EQ(s.hand.target().loadN, 0.0);
            EXPECT_EQ(s.hand.target().pedal, 0.0);
            // And the device reads just that.
            EXPECT_EQ(s.mailbox->read().positionMm[0], s.hand.target().positionMm[0]);
        }
    }
}

TEST(PointerController, offTheToothItMovesInTheViewPlaneThroughTheLastPlace) {
    Scene s(ballMm);
    s.hand.move(s.pixel(Vec3(0, 0, kRadius)));
    const Vec3 last = s.tip();
    s.hand.move(Vec2(20, 300));
    EXPECT_NEAR((s.tip() - last).dot(s.camera.forward()), 0.0, 1e-9);
    EXPECT_NEAR((s.pixel(s.tip()) - Vec2(20, 300)).norm(), 0.0, 1e-6);
}

TEST(PointerController, aPressGoesInAlongTheLineOfSight) {
    for (const Vec3& eye : {Vec3(0, -1, 40), Vec3(0, -40, 30), Vec3(-30, -30, 12)}) {
        Scene s(ballMm, eye);
        const Vec2 at = s.pixel(Vec3(-1, -2, 3));
        s.hand.move(at);
        s.hand.press(at, true);
        EXPECT_TRUE(s.hand.isPressed());
        EXPECT_EQ(s.hand.target().loadN, kFirstLoadN);
        EXPECT_EQ(s.hand.target().pedal, 1.0);
        EXPECT_NEAR(s.clearMm(ballMm), 0.0, 0.002) << "from where the bur touches";
        EXPECT_NEAR((s.way() - view::rayThrough(s.camera, kViewport, at).direction).norm(), 0.0, 1e-12);
        for (const double deep : {0.0, 1.0, 3.0})
            EXPECT_NEAR(s.besides(at, s.tip() + deep * s.way()), 0.0, 1e-6);
        EXPECT_GT(s.hand.target().farMm, 2.0);
        s.hand.release();
        EXPECT_EQ(s.hand.target().pedal, 0.0);
        EXPECT_FALSE(s.hand.isPressed());
    }
}

TEST(PointerController, withControlItOnlyTouches) {
    Scene s(planeMm);
    const Vec2 pixel = s.pixel(Vec3(1, 1, 0));
    s.hand.move(pixel);
    s.hand.press(pixel, false);
    EXPECT_EQ(s.hand.target().pedal, 0.0);
    EXPECT_EQ(s.hand.target().loadN, kFirstLoadN);
}

TEST(PointerController, aBurIsWithdrawnFromACavityTurningAndLed) {
    for (const bool hangs : {false, true}) {
        Scene s(planeMm);
        const Vec2 pixel = s.pixel(Vec3(1, 1, 0)), elsewhere = s.pixel(Vec3(2, 1, 0));
        s.hand.move(pixel);
        s.hand.press(pixel, true);
        s.tell(Vec3(1, 1, -1.4), 1.9);
        s.hand.release();
        // Along the bur, which is shorter than back along the line of sight.
        const Vec3 out(1, 1, kHoverMm);
        EXPECT_NEAR((s.tip() - out).norm(), 0.0, 0.01);
        EXPECT_NEAR(s.way().z(), 1.0, 1e-9);
        EXPECT_TRUE(s.hand.target().isLed);
        EXPECT_EQ(s.hand.target().pedal, 1.0);
        // Not sideways through the wall.
        s.hand.move(elsewhere);
        EXPECT_NEAR((s.tip() - out).norm(), 0.0, 0.01);
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
            EXPECT_NEAR(s.besides(elsewhere, s.tip()), 0.0, 1e-6) << "where the pointer is by now";
        }
    }
    // A still bur only touched: nothing turns.
    Scene s(planeMm);
    const Vec2 pixel = s.pixel(Vec3(1, 1, 0));
    s.hand.move(pixel);
    s.hand.press(pixel, false);
    s.tell(Vec3(1, 1, -0.2), 1.9);
    s.hand.release();
    EXPECT_EQ(s.hand.target().pedal, 0.0);
}

TEST(PointerController, whatWasCutMovesNothing) {
    // Its hand knows the tooth before any cut alone: told of any place of the tip, its target is the same.
    Scene s(ballMm);
    const Vec2 at = s.pixel(Vec3(-1, -2, 3));
    s.hand.move(at);
    s.hand.press(at, true);
    const Vec3 before = s.tip(), way = s.way();
    for (const double deep : {0.2, 1.0, 2.0}) {
        s.tell(before + deep * way, deep);
        s.hand.move(at + Vec2(1, 0));
        s.hand.move(at);
        EXPECT_NEAR((s.tip() - before).norm(), 0.0, 1e-9);
    }
}

TEST(PointerController, overAnEdgeItIsLiftedAndPutDownAgain) {
    // From the low side to the top of the step, which hides part of the low side.
    Scene s(stepMm, Vec3(30, 0, 25));
    const Vec2 low = s.pixel(Vec3(-7, 0, 0)), high = s.pixel(Vec3(2, 0, 3));
    s.hand.move(low);
    s.hand.press(low, true);
    ASSERT_EQ(s.hand.target().loadN, kFirstLoadN);
    Vec3 bur = s.tip() + 0.3 * s.way();
    bool lifted = false;
    for (int i = 0; i <= 200; ++i) {
        s.hand.move(low + (i / 200.0) * (high - low));
        if (s.hand.target().loadN > 0.0 && !s.hand.target().isLed) {
            // Pressed on, the way between two places leads through no tooth.
            for (double share = 0.0; share <= 1.0; share += 0.1) {
                const Vec3 between = bur + share * (s.tip() - bur);
                EXPECT_LT(-Felt(stepMm).ofBur({between, Quat::Identity()}).mm, 0.5) << i;
            }
            bur = s.tip();
        } else {
            lifted = true;
            EXPECT_EQ(s.hand.idle(), PointerController::Idle::onItsWay);
            bur = s.tip();
        }
        s.tell(bur, lifted ? -0.1 : 0.1);
    }
    EXPECT_TRUE(lifted);
    s.tell(bur, -0.1);
    s.hand.move(high);
    s.tell(bur, -0.1);
    EXPECT_EQ(s.hand.target().loadN, kFirstLoadN);
    EXPECT_NEAR(s.besides(high, s.tip()), 0.0, 1e-6);
}

TEST(PointerController, aPressInTheAirSaysSo) {
    Scene s(ballMm);
    s.hand.move(Vec2(20, 300));
    s.hand.press(Vec2(20, 300), true);
    EXPECT_EQ(s.hand.target().loadN, 0.0);
    EXPECT_EQ(s.hand.target().pedal, 1.0);
    EXPECT_EQ(s.hand.idle(), PointerController::Idle::offTooth);
    const Vec3 before = s.tip();
    s.hand.move(Vec2(60, 300));
    EXPECT_GT((s.tip() - before).norm(), 0.5);
    EXPECT_NEAR((s.tip() - before).dot(s.camera.forward()), 0.0, 1e-9);
}

TEST(PointerController, aToothPutBackRoundTheBurIsLeftFirst) {
    Scene s(planeMm);
    const Vec2 at = s.pixel(Vec3::Zero());
    s.hand.move(at);
    s.hand.press(at, true);
    messages::HapticSample sample;
    sample.tick = 1;
    sample.proxyPositionMm = {0, 0, -1};
    sample.flags = messages::kWaiting;
    s.hand.follow(sample);
    EXPECT_EQ(s.hand.idle(), PointerController::Idle::onItsWay);
    EXPECT_GT(s.tip().z(), 0.4);
    s.tell(s.tip(), -0.5);
    s.tell(s.tip(), -0.5);
    EXPECT_EQ(s.hand.target().loadN, kFirstLoadN) << "and it presses again";
}

TEST(PointerController, slowIsAFifthFromWhereItBegan) {
    Scene s(planeMm, Vec3(0, -1, 40), Vec3::UnitY());
    const Vec2 start = s.pixel(Vec3(0, 0, 0));
    const auto lead = [&] { return Vec2(s.pixel(s.tip()) - start); };
    s.hand.move(start);
    s.hand.press(start, true);
    s.hand.move(start + Vec2(10, 0));
    EXPECT_NEAR(lead().x(), 10.0, 1e-6);
    s.hand.move(start + Vec2(20, 0), true);
    EXPECT_NEAR(lead().x(), 12.0, 1e-6);
    s.hand.move(start + Vec2(60, 0), true);
    EXPECT_NEAR(lead().x(), 20.0, 1e-6);
    // Shift let go: no jump while pressed.
    s.hand.move(start + Vec2(60, 0));
    EXPECT_NEAR(lead().x(), 20.0, 1e-6);
    s.hand.move(start + Vec2(70, 0));
    EXPECT_NEAR(lead().x(), 30.0, 1e-6);
    s.hand.release();
    s.tell(s.tip(), -0.5);
    s.hand.move(start + Vec2(70, 0));
    EXPECT_NEAR(lead().x(), 70.0, 1e-6);
}

TEST(PointerController, theStopCountsFromTheFirstTouchOfTheUncutTooth) {
    for (const Vec3& eye : {Vec3(0, -1, 40), Vec3(0, -40, 30)}) {
        Scene s(planeMm, eye);
        s.hand.move(s.pixel(Vec3::Zero()));
        s.hand.setStop(1.5);
        s.hand.press(s.pixel(Vec3::Zero()), true);
        const auto end = [&] { return Vec3(s.tip() + s.hand.target().farMm * s.way()).z(); };
        EXPECT_NEAR(end(), -1.5, 0.01) << "whichever way one looks";
        s.hand.setStop(0.7);
        EXPECT_NEAR(end(), -0.7, 0.01);
        // It holds on a bur that is deeper by now, and where the bur is held back beside the pointer.
        s.tell(s.tip() + 1.2 * s.way(), 0.1);
        EXPECT_NEAR(end(), -0.7, 0.01);
        // Without one, what it may go is bounded all the same.
        s.hand.setStop({});
        EXPECT_FALSE(s.hand.stopMm());
        EXPECT_GT(end(), -10.1);
    }
}

TEST(PointerController, heldBackBesideThePointerItGoesNoDeeperThanItMayThere) {
    // Down a slope: under the pointer the stop lies lower than where the bur still is.
    Scene s(ballMm, Vec3(0, -1, 40), Vec3::UnitY());
    const Vec2 at = s.pixel(Vec3(0, 0, 5));
    s.hand.setStop(0.5);
    s.hand.move(at);
    s.hand.press(at, true);
    const Vec3 bur = s.tip() + 0.5 * s.way();
    s.tell(bur, 0.1);
    const Vec2 ahead = s.pixel(Vec3(2, 0, 5));
    for (int i = 1; i <= 20; ++i)
        s.hand.move(at + (i / 20.0) * (ahead - at));
    s.tell(bur, 0.1);
    EXPECT_NEAR(s.tip().z() + s.hand.target().farMm * s.way().z(), bur.z(), 0.15);
}

TEST(PointerController, theLoadIsHeldWithinWhatAHandPresses) {
    Scene s(planeMm);
    for (const auto& [asked, held] : {std::pair{1.7, 1.7}, {0.01, kMinLoadN}, {9.0, kMaxLoadN}, {-1.0, kMinLoadN}}) {
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

TEST(PointerController, pivotTurnsAboutTheTipTowardsThePointer) {
    Scene s(planeMm);
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

TEST(PointerController, alignsToTheSurfaceUnderTheTip) {
    Scene s(ballMm, Vec3(0, -30, 30));
    const Vec3 p = kRadius * Vec3(0.3, -0.5, std::sqrt(1 - 0.09 - 0.25));
    s.hand.move(s.pixel(p));
    s.hand.alignToNormal();
    EXPECT_NEAR(s.axis().dot(p.normalized()), 1.0, 1e-9);
}

TEST(PointerController, nudgesGoAlongTheScreenAndTheAxis) {
    Scene s(planeMm);
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

TEST(PointerController, pressedKeysLeadItAcrossAndTheLoadIn) {
    Scene s(planeMm);
    const Vec2 at = s.pixel(Vec3::Zero());
    s.hand.move(at);
    s.hand.press(at, true);
    const Vec3 before = s.tip();
    s.hand.nudge(kNudgeMm, 0, 0);
    EXPECT_NEAR((s.tip() - before).norm(), kNudgeMm, 0.01);
    EXPECT_GT((s.tip() - before).dot(s.camera.right()), 0.09);
    EXPECT_NEAR(s.tip().z(), before.z(), 0.01);
}

TEST(PointerController, aBurThatKeysMovedIsPressedWhereItIs) {
    Scene s(planeMm);
    const Vec2 at = s.pixel(Vec3::Zero());
    s.hand.move(at);
    for (int i = 0; i < 10; ++i)
        s.hand.nudge(kNudgeMm, 0, 0);
    const Vec2 there = s.pixel(s.tip());
    s.hand.press(at, true);
    EXPECT_NEAR(s.besides(there, s.tip()), 0.0, 1e-6);
    s.hand.move(at + Vec2(5, 0));
    EXPECT_NEAR(s.besides(there + Vec2(5, 0), s.tip()), 0.0, 1e-6);
}

TEST(PointerController, frozenStaysAndGoesOnFromThere) {
    Scene s(planeMm);
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
    s.tell(before, 0.0);
    s.hand.freeze(false);
    // Pressed, it goes on from where it stands, whatever is under the pointer now.
    s.hand.move(pixel + Vec2(100, 0));
    EXPECT_LT((s.tip() - before).norm(), 0.01);
    s.hand.move(pixel + Vec2(101, 0));
    EXPECT_LT((s.tip() - before).norm(), 0.1);
}

TEST(PointerController, anotherViewEndsTheStrokeAndAZoomUnderThePointerDoesNot) {
    Scene s(planeMm);
    const Vec2 pixel = s.pixel(Vec3::Zero());
    s.hand.move(pixel);
    s.hand.press(pixel, true);
    const Vec3 before = s.tip();
    s.tell(before, 0.1);
    s.camera = view::zoomed(s.camera, kViewport, pixel, 1.25, before);
    s.hand.setEye(s.camera, kViewport);
    EXPECT_TRUE(s.hand.isPressed());
    // Ten millimetres beside: the pointer would lead it across the tooth, or it would stay behind by as much.
    s.camera.eyeMm += Vec3(10, 0, 0);
    s.camera.targetMm += Vec3(10, 0, 0);
    s.hand.setEye(s.camera, kViewport);
    EXPECT_FALSE(s.hand.isPressed());
    EXPECT_EQ(s.hand.target().farMm, 0.0);
    s.tell(s.tip(), -0.5);
    s.hand.move(pixel);
    s.tell(s.tip(), -0.5);
    EXPECT_NEAR(s.besides(pixel, s.tip()), 0.0, 0.5) << "it hovers under the pointer";
    EXPECT_EQ(s.hand.target().pedal, 0.0);
}

TEST(PointerController, whyNothingIsCutIsToldAfterATimeHoweverFewThePictures) {
    Scene s(planeMm);
    const Vec2 pixel = s.pixel(Vec3::Zero());
    s.hand.setPerPass(0.3);
    s.hand.move(pixel);
    s.hand.press(pixel, true);
    const Vec3 end = s.tip() + s.hand.target().farMm * s.way();
    s.tell(end, 0.1);
    EXPECT_FALSE(s.hand.isIdleForLong());
    s.timeS += 0.3;  // no picture meanwhile
    s.tell(end, 0.1);
    EXPECT_TRUE(s.hand.isIdleForLong());
    EXPECT_EQ(s.hand.idle(), PointerController::Idle::passDone);
}

TEST(PointerController, aScribbleIsToldThatItCutsNextToNothing) {
    for (const double mmS : {3.0, 40.0}) {
        Scene s(planeMm);
        const Vec2 pixel = s.pixel(Vec3::Zero());
        s.hand.move(pixel);
        s.hand.press(pixel, true);
        const Vec3 at = s.tip();
        bool isTold = false;
        for (int i = 0; i < 60; ++i) {
            // To and fro, with every picture.
            s.tell(at + Vec3(i % 2 == 0 ? 0.033 * mmS : 0.0, 0, 0), i % 3 == 0 ? 0.0 : 0.1);
            isTold = isTold || (s.hand.isIdleForLong() && s.hand.idle() == PointerController::Idle::hurries);
        }
        EXPECT_EQ(isTold, mmS > 10.0) << mmS << " mm/s";
    }
}

TEST(PointerController, escapeEndsEverythingAndTheNextMoveBringsItBack) {
    Scene s(planeMm);
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

TEST(PointerController, theHandleBeginsOutOfTheMouth) {
    const core::Box box{Vec3(-5, -4, -10), Vec3(5, 4, 8)};
    const core::Pose molar = startPose(box, 36, 1), incisor = startPose(box, 11, -1);
    EXPECT_GT((molar.orientation * Vec3::UnitX()).x(), 0.9);
    EXPECT_GT((molar.orientation * Vec3::UnitX()).y(), 0.0);
    EXPECT_LT((incisor.orientation * Vec3::UnitX()).y(), -0.99);
    EXPECT_GT(molar.positionMm.z(), 8.0);
    EXPECT_NEAR((molar.orientation * Vec3::UnitZ()).z(), 1.0, 1e-12);
}

TEST(PointerController, withAFingerRestItGoesHalfAsFarAndTurnsAboutTheRest) {
    const Vec3 rest(-9, 2, 1);
    Scene s(planeMm);
    const Vec2 start = s.pixel(Vec3(0, 0, 1));
    s.hand.move(start);
    const Vec3 before = s.tip() - rest;
    const Quat held = s.turn();
    s.hand.setRest(rest);
    EXPECT_EQ(s.hand.rest(), rest);
    // In many small steps: what each turns adds up to no more than the way from the first to the last.
    for (int i = 1; i <= 60; ++i)
        s.hand.move(start + Vec2(i, 0.5 * i));
    EXPECT_LT(s.besides(start + kRestFactor * Vec2(60, 30), s.tip()), 0.05);
    EXPECT_NEAR(s.clearMm(planeMm), kHoverMm, 0.002);
    const Vec3 after = s.tip() - rest;
    const double turned = held.angularDistance(s.turn());
    const double swung = std::acos(before.normalized().dot(after.normalized()));
    EXPECT_GT(swung, 0.05);
    EXPECT_NEAR(turned, swung, 0.1 * swung);
    EXPECT_LT((s.turn() * held.conjugate() * before.normalized() - after.normalized()).norm(), 0.1 * swung);
    // Off again it is where the pointer is, and turns no more.
    s.hand.setRest({});
    const Quat last = s.turn();
    s.hand.move(start);
    EXPECT_LT(s.besides(start, s.tip()), 1e-6);
    EXPECT_EQ(s.turn().coeffs(), last.coeffs());
}

TEST(PointerController, theHandleTurnsToTheHandAndTheBurStaysWhereItIs) {
    Scene s(planeMm);
    const Vec3 tip = s.tip(), axis = s.axis();
    s.hand.turnHandle(Vec3(0, -1, 0));
    EXPECT_EQ(s.tip(), tip);
    EXPECT_LT((s.axis() - axis).norm(), 1e-12);
    EXPECT_LT((s.turn() * Vec3::UnitX() - Vec3(0, -1, 0)).norm(), 1e-9);
}

TEST(PointerController, whatMakesNoSenseChangesNothing) {
    EXPECT_THROW(PointerController(nullptr, {}, plane), core::Error);
    EXPECT_THROW(PointerController(std::make_shared<device::PointerMailbox>(), {}, {}), core::Error);
    Scene s(planeMm);
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
}  // namespace handpiece::input::pointer_controller_test
