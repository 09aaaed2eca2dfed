// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/workspace/workspace_mapping.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::workspace::placing_test {
namespace {

using core::Quat;
using core::Vec3;

class PlacingTest : public testing::Test {
  protected:
    double between(double least, double most) { return test::uniform(random_, least, most); }
    double share() { return between(0.0, 1.0); }
    Vec3 somewhere(double most) { return {between(-most, most), between(-most, most), between(-most, most)}; }
    Quat turned() { return test::randomRotation(random_); }

    WorkspaceMapping anyMapping() {
        WorkspaceMapping p;
        p.deviceMm = somewhere(80);
        p.toothMm = somewhere(15);
        p.toothInDevice = turned();
        p.scale = 1.0 + std::floor(3.0 * share());
        p.leftHanded = share() < 0.5;
        p.burAlongStylus = share() < 0.2;
        p.headAngleDeg = between(60, 180);
        p.headRollDeg = between(-180, 180);
        p.tipFromStylusMm = somewhere(30);
        return p;
    }
    static link::DriverReading reading(const Vec3& at, const Quat& turn) {
        link::DriverReading r;
        r.positionMm = {at.x(), at.y(), at.z()};
        r.orientation = {turn.w(), turn.x(), turn.y(), turn.z()};
        return r;
    }

    std::mt19937_64 random_{test::seed()};
};

/// Of the bur in the device frame, when the tooth's axes are the device's: where the tip points, where the handle goes.
struct Seen {
    Vec3 points, handle;
};
Seen seen(const WorkspaceMapping& p, const Quat& stylus = Quat::Identity()) {
    const Quat bur = stylus * WorkspaceTransform(p).burInStylus();
    return {bur * -Vec3::UnitZ(), stylus * Vec3::UnitZ()};
}

TEST_F(PlacingTest, theHandHereHasTheBurThere) {
    for (int round = 0; round < 1000; ++round) {
        WorkspaceMapping p = anyMapping();
        p.tipFromStylusMm = Vec3::Zero();
        EXPECT_LT((WorkspaceTransform(p).burInTooth(reading(p.deviceMm, turned())).positionMm - p.toothMm).norm(),
                  1e-9);
    }
}

TEST_F(PlacingTest, theHandleIsTheStylusAndTheBurStandsAtTheHeadsAngleToIt) {
    for (const double angle : {90.0, 100.0, 120.0, 180.0}) {
        WorkspaceMapping p;
        p.headAngleDeg = angle;
        const Seen s = seen(p);
        EXPECT_NEAR(std::acos(s.points.dot(s.handle)) * 180.0 / std::numbers::pi, angle, 1e-6);
    }
    // Held level, tail to the user, buttons up: the bur points down, and leans a little away from the user.
    WorkspaceMapping p;
    EXPECT_LT(seen(p).points.y(), -0.98);
    EXPECT_LT(seen(p).points.z(), 0.0);
    EXPECT_NEAR(seen(p).points.x(), 0.0, 1e-12);
    // In the bur's frame the handle runs along +x and rises, as the mesh of the turbine does.
    const Vec3 handle = WorkspaceTransform(p).burInStylus().conjugate() * Vec3::UnitZ();
    EXPECT_GT(handle.x(), 0.9);
    EXPECT_GT(handle.z(), 0.0);
    EXPECT_NEAR(handle.y(), 0.0, 1e-12);
}

TEST_F(PlacingTest, alongTheStylusTheBurGoesOnWhereTheStylusPoints) {
    WorkspaceMapping p;
    p.burAlongStylus = true;
    p.headRollDeg = 70.0;
    EXPECT_LT((seen(p).points + Vec3::UnitZ()).norm(), 1e-12);
}

TEST_F(PlacingTest, directionsOfTheHandAreTrueForBothHands) {
    for (int round = 0; round < 1000; ++round) {
        WorkspaceMapping p = anyMapping();
        const Quat stylus = turned();
        const Vec3 from = somewhere(60), step = somewhere(5);
        const Vec3 a = WorkspaceTransform(p).burInTooth(reading(from, stylus)).positionMm;
        const Vec3 b = WorkspaceTransform(p).burInTooth(reading(from + step, stylus)).positionMm;
        // The tooth as it lies in the device: what goes to the right there goes to the right here.
        EXPECT_LT((p.toothInDevice * (b - a) * p.scale - step).norm(), 1e-9);
        WorkspaceMapping other = p;
        other.leftHanded = !p.leftHanded;
        const Vec3 c = WorkspaceTransform(other).burInTooth(reading(from, stylus)).positionMm;
        const Vec3 d = WorkspaceTransform(other).burInTooth(reading(from + step, stylus)).positionMm;
        EXPECT_LT(((d - c) - (b - a)).norm(), 1e-9);
        EXPECT_LT((WorkspaceTransform(p).inDevice(step) - WorkspaceTransform(other).inDevice(step)).norm(), 1e-12);
    }
}

TEST_F(PlacingTest, aLeftHandsInstrumentIsTheMirrorImageOfARightHands) {
    const Vec3 mirror(-1, 1, 1);
    for (int round = 0; round < 1000; ++round) {
        WorkspaceMapping right = anyMapping();
        right.leftHanded = false;
        right.toothInDevice = Quat::Identity();
        right.deviceMm = right.toothMm = Vec3::Zero();
        WorkspaceMapping left = right;
        left.leftHanded = true;
        // The same grip in the mirror: a turn whose matrix is M R M.
        const Quat grip = turned();
        const core::Mat3 m = mirror.asDiagonal();
        const Quat mirrored(core::Mat3(m * grip.toRotationMatrix() * m));
        const Vec3 at = somewhere(50);
        const core::Pose a = WorkspaceTransform(right).burInTooth(reading(at, grip));
        const core::Pose b = WorkspaceTransform(left).burInTooth(reading(mirror.cwiseProduct(at), mirrored));
        EXPECT_LT((mirror.cwiseProduct(a.positionMm) - b.positionMm).norm(), 1e-9);
        EXPECT_LT((mirror.cwiseProduct(a.orientation * Vec3::UnitZ()) - b.orientation * Vec3::UnitZ()).norm(), 1e-9);
        EXPECT_LT((mirror.cwiseProduct(a.orientation * Vec3::UnitX()) - b.orientation * Vec3::UnitX()).norm(), 1e-9);
    }
}

TEST_F(PlacingTest, theHeadsRollTurnsWhereTheBurPoints) {
    WorkspaceMapping p;
    p.headRollDeg = 40.0;
    EXPECT_GT(seen(p).points.x(), 0.3);
    p.leftHanded = true;
    EXPECT_LT(seen(p).points.x(), -0.3);
}

// The hand does the scale's times the work of the bur, for any small motion, turning or not, with any lever: so a
// passive tooth is passive in the hand.
TEST_F(PlacingTest, forceAndTorqueDoTheScaleTimesTheWorkDoneAtTheTooth) {
    for (int round = 0; round < 1000; ++round) {
        const WorkspaceMapping p = anyMapping();
        const WorkspaceTransform mapping(p);
        const Quat stylus = turned();
        const Vec3 at = somewhere(60), forceN = somewhere(3), push = somewhere(20);
        constexpr double kSmall = 1e-6;
        const Vec3 step = kSmall * somewhere(1), turn = kSmall * somewhere(0.05);  // of the stylus, device frame
        const Quat after = Quat(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * stylus;
        const core::Pose before = mapping.burInTooth(reading(at, stylus));
        const core::Pose then = mapping.burInTooth(reading(at + step, after));
        // The force acts on a point of the bur; the torque is about the grip, as the force model has it.
        const Vec3 pointInBur = before.applyInverse(before.positionMm + push);
        const Vec3 gripMm = before.apply(mapping.gripInBurMm());
        const Vec3 torqueNmm = (before.apply(pointInBur) - gripMm).cross(forceN);
        const double atTooth = forceN.dot(then.apply(pointInBur) - before.apply(pointInBur));
        const double atHand = mapping.inDevice(forceN).dot(step) + mapping.torqueInDevice(torqueNmm).dot(turn);
        EXPECT_NEAR(atHand, p.scale * atTooth, 1e-3 * kSmall) << "round " << round;
    }
}

TEST_F(PlacingTest, forcesGoThereAndBackUnchanged) {
    for (int round = 0; round < 1000; ++round) {
        const WorkspaceMapping p = anyMapping();
        const WorkspaceTransform mapping(p);
        const Vec3 f = somewhere(10);
        EXPECT_LT((mapping.inTooth(mapping.inDevice(f)) - f).norm(), 1e-12);
        EXPECT_NEAR(mapping.inDevice(f).norm(), f.norm(), 1e-12);  // whatever the scale
    }
}

TEST_F(PlacingTest, theClutchLeavesTheBurWhereItWas) {
    for (int round = 0; round < 300; ++round) {
        WorkspaceMapping p = anyMapping();
        WorkspaceTransform mapping(p);
        const Quat stylus = turned();
        const Vec3 held = somewhere(60), letGo = somewhere(60), step = somewhere(5);
        const Vec3 bur = mapping.burInTooth(reading(held, stylus)).positionMm;
        mapping.regrip(reading(letGo, stylus), bur);
        EXPECT_LT((mapping.burInTooth(reading(letGo, stylus)).positionMm - bur).norm(), 1e-9);
        const Vec3 on = mapping.burInTooth(reading(letGo + step, stylus)).positionMm;
        EXPECT_LT((p.toothInDevice * (on - bur) * p.scale - step).norm(), 1e-9);
    }
}

TEST_F(PlacingTest, limitsHoldPerMillimetreOfTheHand) {
    const device::Capability hand;
    for (const double scale : {1.0, 2.0, 3.0}) {
        WorkspaceMapping p;
        p.scale = scale;
        const device::Capability bur = atTheBur(hand, p);
        const WorkspaceTransform mapping(p);
        // A wall of the largest stiffness at the bur, felt over 1 mm of the hand.
        const Vec3 in = mapping.burInTooth(reading(Vec3(0, -1, 0), Quat::Identity())).positionMm;
        EXPECT_NEAR(bur.maxStiffnessNPerMm * in.norm(), hand.maxStiffnessNPerMm * 1.0, 1e-12);
        EXPECT_NEAR(bur.maxDampingNSPerMm * in.norm(), hand.maxDampingNSPerMm * 1.0, 1e-12);
        EXPECT_NEAR(bur.encoderStepMm, hand.encoderStepMm * in.norm(), 1e-12);
        EXPECT_NEAR(bur.workspaceMm.x(), hand.workspaceMm.x() * in.norm(), 1e-9);
        EXPECT_EQ(bur.maxForceN, hand.maxForceN);
        EXPECT_EQ(bur.maxForceSlopeNPerS, hand.maxForceSlopeNPerS);
    }
}

TEST_F(PlacingTest, whatCannotBeIsRefused) {
    const auto refused = [](auto change) {
        WorkspaceMapping p;
        change(p);
        return test::errorOf([&] { validate(p); });
    };
    EXPECT_NO_THROW(validate(WorkspaceMapping{}));
    EXPECT_NE(refused([](WorkspaceMapping& p) { p.scale = 1.5; }).find("scale"), std::string::npos);
    EXPECT_NE(refused([](WorkspaceMapping& p) { p.scale = std::nan(""); }).find("scale"), std::string::npos);
    EXPECT_NE(refused([](WorkspaceMapping& p) { p.headAngleDeg = 30; }).find("head_angle_deg"), std::string::npos);
    EXPECT_NE(refused([](WorkspaceMapping& p) { p.headRollDeg = 181; }).find("head_roll_deg"), std::string::npos);
    EXPECT_NE(refused([](WorkspaceMapping& p) { p.toothInDevice = Quat(1, 1, 0, 0); }).find("tooth_in_device"),
              std::string::npos);
    EXPECT_NE(refused([](WorkspaceMapping& p) { p.deviceMm.x() = std::nan(""); }).find("device_mm"), std::string::npos);
    EXPECT_NE(refused([](WorkspaceMapping& p) { p.tipFromStylusMm.z() = 1e6; }).find("tip_from_stylus_mm"),
              std::string::npos);
}

}  // namespace
}  // namespace handpiece::workspace::placing_test
