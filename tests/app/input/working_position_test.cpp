// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/input/working_position.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "handpiece/base/core/error.h"

namespace handpiece::input::working_position_test {
namespace {

using core::Quat;
using core::Vec3;

struct Stood {
    int fdi;
    Vec3 placeMm;
    double w, x, y, z;
};
/// Of a mouth that the program made (make mouth --fdi 16 --json): the upper teeth that say most.
const std::vector<Stood> kUpper = {
    {11, {30.82, -10.74, -4.46}, 0.8507, -0.0901, 0.1806, -0.4854},
    {21, {33.21, -18.41, -6.06}, -0.6408, -0.1997, -0.0999, -0.7345},
    {13, {21.49, -1.11, -2.14}, 0.9673, -0.0018, 0.1522, -0.2030},
    {23, {30.71, -31.54, -8.51}, -0.8485, -0.1479, -0.1034, -0.4975},
    {16, {0.00, 0.00, 0.00}, 1.0000, 0.0000, 0.0000, 0.0000},
    {26, {13.71, -44.90, -9.42}, -0.9388, -0.1906, -0.0004, -0.2871},
    {17, {-8.88, -0.09, -1.34}, 0.9956, -0.0193, -0.0857, 0.0325},
    {27, {6.03, -49.05, -11.61}, -0.9403, -0.2335, 0.0676, -0.2383},
};

Quat turnOf(const Stood& s) {
    return {s.w, s.x, s.y, s.z};
}
cases::Case upperMouth() {
    cases::Case made;
    made.fdiNumber = 16;
    for (const Stood& s : kUpper) {
        if (s.fdi == 16) continue;
        cases::PlacedTooth other;
        other.fdiNumber = s.fdi;
        other.inCase = {s.placeMm, turnOf(s)};
        made.others.push_back(std::move(other));
    }
    return made;
}
Vec3 placeOf(int fdi) {
    return std::find_if(kUpper.begin(), kUpper.end(), [fdi](const Stood& s) { return s.fdi == fdi; })->placeMm;
}
cases::Case alone(int fdi) {
    cases::Case made;
    made.fdiNumber = fdi;
    return made;
}
double degreesBetween(const Vec3& a, const Vec3& b) {
    return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)) * 180.0 / M_PI;
}

TEST(WorkingPosition, HoursAreThoseOfTheOperator) {
    for (int hour = 0; hour <= 13; ++hour)
        EXPECT_EQ(isOperatorsHour(hour), (hour >= 8 && hour <= 12) || (hour >= 1 && hour <= 4)) << hour;
    EXPECT_THROW((void)workingPosition(Quat::Identity(), true, 6), core::Error);
    EXPECT_THROW((void)workingPosition(Quat::Identity(), true, 0), core::Error);
    for (std::size_t i = 0; i < kRightHandedHours.size(); ++i)
        EXPECT_EQ(mirroredHour(kRightHandedHours[kRightHandedHours.size() - 1 - i]), kLeftHandedHours[i]);
}

TEST(WorkingPosition, TheEyeIsAboveTheFaceOnTheOperatorsSide) {
    const Quat upright = Quat::Identity();  // directions in the mouth frame
    for (const bool isUpper : {true, false}) {
        for (const int hour : {8, 9, 10, 11, 12, 1, 2, 3, 4}) {
            const WorkingPosition at = workingPosition(upright, isUpper, hour);
            EXPECT_NEAR(at.toEye.norm(), 1.0, 1e-12);
            EXPECT_LT(at.toEye.y(), -0.5) << "in front of the face, " << hour;
            EXPECT_NEAR(at.toEye.x(), 0.5 * std::sin(hour * M_PI / 6.0), 1e-12) << hour;
            EXPECT_LT(at.toHand.y(), -0.5) << "out of the mouth, " << hour;
            EXPECT_LT(std::abs(at.up.dot(at.toEye)), 0.6);
        }
        // Behind the head one sees the face upside down.
        EXPECT_LT(workingPosition(upright, isUpper, 12).up.z(), -0.9);
        // From the left what one sees from the right, mirrored.
        for (const int hour : kRightHandedHours) {
            const WorkingPosition a = workingPosition(upright, isUpper, hour),
                                  b = workingPosition(upright, isUpper, mirroredHour(hour));
            EXPECT_LT((a.toEye.cwiseProduct(Vec3(-1, 1, 1)) - b.toEye).norm(), 1e-12);
            EXPECT_LT((a.toHand.cwiseProduct(Vec3(-1, 1, 1)) - b.toHand).norm(), 1e-12);
        }
    }
}

TEST(WorkingPosition, TheHeadOfAMouthLiesAsItsTeethStand) {
    const std::optional<Quat> head = headInCase(upperMouth());
    ASSERT_TRUE(head);
    // Where the teeth stand says the same as how they are turned, and nobody used that.
    const Vec3 left = placeOf(26) - placeOf(16) + placeOf(27) - placeOf(17) + placeOf(23) - placeOf(13);
    const Vec3 back = placeOf(17) + placeOf(27) - placeOf(11) - placeOf(21);
    EXPECT_LT(degreesBetween(*head * Vec3::UnitX(), left), 2.0);
    EXPECT_LT(degreesBetween(*head * Vec3::UnitY(), back), 10.0);  // the molars stand higher: the curve of Spee
    // Whatever tooth the case has for its own.
    std::mt19937 random(7);
    std::normal_distribution<double> any;
    for (int i = 0; i < 20; ++i) {
        const Quat turn = Quat(any(random), any(random), any(random), any(random)).normalized();
        cases::Case turned = upperMouth();
        turned.fdiNumber = 0;
        for (cases::PlacedTooth& other : turned.others)
            other.inCase.orientation = turn * other.inCase.orientation;
        cases::Case same = upperMouth();
        same.fdiNumber = 0;
        EXPECT_LT(headInCase(turned)->angularDistance(turn * *headInCase(same)), 1e-6);
    }
    EXPECT_FALSE(headInCase(alone(0)));
    EXPECT_FALSE(headInCase(alone(19)));
}

TEST(WorkingPosition, OneToothAloneLiesAsInAMouth) {
    const std::optional<Quat> mouth = headInCase(upperMouth()), own = headInCase(alone(16));
    ASSERT_TRUE(mouth && own);
    EXPECT_LT(mouth->angularDistance(*own) * 180.0 / M_PI, 6.0);
    // Of a lower one mesial is forwards and buccal outwards: from 9 o'clock one is at the cheek of 46, and not of 36.
    const auto from = [](int fdi, int hour) { return workingPosition(*headInCase(alone(fdi)), fdi < 30, hour).toEye; };
    const double buccalOf46 = -1.0, buccalOf36 = 1.0;  // y of buccal, as the program's teeth have it
    EXPECT_GT(buccalOf46 * from(46, 9).y(), 0.2);
    EXPECT_LT(buccalOf36 * from(36, 9).y(), 0.0);
    EXPECT_GT(buccalOf36 * from(36, 3).y(), 0.2);
    for (const int hour : kRightHandedHours)
        EXPECT_GT(from(46, hour).x(), 0.0) << "through the lips, " << hour;
}

TEST(WorkingPosition, WhatIsSeenDirectlyFacesTheEye) {
    for (int fdi = 11; fdi <= 48; ++fdi) {
        if (fdi % 10 < 1 || fdi % 10 > 8) continue;
        for (int s = 0; s < 3; ++s)
            for (const bool left : {false, true}) {
                const UsualPosition usual = usualPosition(fdi, static_cast<Surface>(s), left);
                EXPECT_TRUE(isOperatorsHour(usual.hour));
                EXPECT_TRUE(left ? usual.hour <= 4 || usual.hour == 12 : usual.hour >= 8);
                const double buccal = fdi / 10 == 1 || fdi / 10 == 3 ? 1.0 : -1.0;
                const Vec3 outwards[] = {{0, 0, 1}, {0, buccal, 0}, {0, -buccal, 0}};
                const Vec3 eye = workingPosition(*headInCase(alone(fdi)), fdi < 30, usual.hour).toEye;
                const double faces = eye.dot(outwards[s]);
                if (usual.byMirror)
                    EXPECT_LT(faces, 0.35) << fdi << " " << kSurfaces[s];
                else
                    EXPECT_GT(faces, 0.0) << fdi << " " << kSurfaces[s];
            }
    }
    EXPECT_THROW((void)usualPosition(0, Surface::occlusal, false), core::Error);
}

TEST(WorkingPosition, ThingsFallTowardsTheBackOfTheHead) {
    // Of a lower molar that is distal and, the head tilted forward, towards its roots; of an upper one distal, and
    // towards its crown.
    const Vec3 lower = downInCase(alone(46)), upper = downInCase(alone(16));
    EXPECT_NEAR(lower.norm(), 1.0, 1e-12);
    EXPECT_LT(lower.x(), -0.6);
    EXPECT_LT(upper.x(), -0.6);
    // The same for left and right.
    const Vec3 left = downInCase(alone(36));
    EXPECT_NEAR(left.x(), lower.x(), 1e-9);
    EXPECT_NEAR(left.y(), -lower.y(), 1e-9);
    EXPECT_NEAR(left.z(), lower.z(), 1e-9);
    EXPECT_EQ(downInCase(cases::Case{}), Vec3(-Vec3::UnitZ())) << "nobody knows";
    // From every seat one looks down.
    for (const int hour : kRightHandedHours)
        EXPECT_GT(workingPosition(*headInCase(alone(46)), false, hour).toEye.dot(-lower), 0.8);
}

TEST(WorkingPosition, TheHandleGoesToTheHandAndTheBurStaysUpright) {
    std::mt19937 random(11);
    std::normal_distribution<double> any;
    for (int i = 0; i < 100; ++i) {
        const Quat held = Quat(any(random), any(random), any(random), any(random)).normalized();
        const Vec3 hand = Vec3(any(random), any(random), any(random)).normalized();
        const Quat turned = handleTowards(held, hand);
        const Vec3 axis = held * Vec3::UnitZ();
        EXPECT_LT((turned * Vec3::UnitZ() - axis).norm(), 1e-9);
        // No other turn about the axis brings it nearer.
        const double got = (turned * Vec3::UnitX()).dot(hand);
        EXPECT_NEAR(got, (hand - axis * axis.dot(hand)).norm(), 1e-9);
    }
    const Quat held = Quat::Identity();
    EXPECT_LT(handleTowards(held, Vec3::UnitZ()).angularDistance(held), 1e-12);
}

TEST(WorkingPosition, TheWholeToothIsSeenFromThere) {
    const core::Box tooth{Vec3(-5, -5, -3), Vec3(5, 5, 4)};
    const view::Viewport port{800, 600};
    for (const int hour : kRightHandedHours) {
        const WorkingPosition at = workingPosition(*headInCase(alone(46)), false, hour);
        const view::Camera eye = seenFrom(at, tooth, port);
        EXPECT_LT(degreesBetween(-eye.forward(), at.toEye), 1e-6);
        for (int corner = 0; corner < 8; ++corner)
            EXPECT_TRUE(
                view::pixelOf(eye, port,
                              {(corner & 1 ? tooth.max : tooth.min).x(), (corner & 2 ? tooth.max : tooth.min).y(),
                               (corner & 4 ? tooth.max : tooth.min).z()}));
    }
}

}  // namespace
}  // namespace handpiece::input::working_position_test
