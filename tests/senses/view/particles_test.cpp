// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/particles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "handpiece/senses/view/renderer.h"
#include "support/random.h"

namespace handpiece::view::particles_test {
namespace {

using core::Vec3;

Moment cutting(double timeS) {
    Moment moment;
    moment.timeS = timeS;
    moment.speedRpm = 300000;
    moment.removalMm3S = 1.5;
    moment.tissue = cases::Tissue::dentine;
    moment.contact = true;
    moment.contactPointMm = {0.4, 0.0, 0.2};
    moment.contactNormal = Vec3(0.3, 0.0, 1.0).normalized();
    return moment;
}

Look dry() {
    Look look;
    look.spray = false;
    return look;
}

bool same(std::span<const Speck> a, std::span<const Speck> b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

std::vector<Speck> after(Particles& particles, double fromS, double toS, double pictureS, bool water) {
    for (double t = fromS; t < toS; t += pictureS) {
        Moment moment = cutting(t);
        moment.water = water;
        particles.advance(moment, Look{}, 0.4);
    }
    Moment moment = cutting(toS);
    moment.water = water;
    particles.advance(moment, Look{}, 0.4);
    return {particles.specks().begin(), particles.specks().end()};
}

TEST(Particles, TheSameWhetherLookedAtOftenOrSeldom) {
    Particles often(7), seldom(7), other(8);
    const auto a = after(often, 3.0, 4.0, 1.0 / 144.0, true), b = after(seldom, 3.0, 4.0, 0.1, true);
    ASSERT_FALSE(a.empty());
    EXPECT_TRUE(same(a, b));
    EXPECT_FALSE(same(a, after(other, 3.0, 4.0, 0.1, true))) << "another seed, other specks";
}

TEST(Particles, TimeThatStandsStillChangesNothing) {
    Particles particles;
    const auto before = after(particles, 1.0, 1.5, 0.016, true);
    for (int i = 0; i < 50; ++i)
        EXPECT_TRUE(same(before, after(particles, 1.5, 1.5, 1.0, true)));
}

TEST(Particles, AJumpGivesThePictureThatOneMomentAloneGives) {
    Particles fresh, forward, backward;
    const auto alone = after(fresh, 20.0, 20.0, 1.0, true);
    ASSERT_GT(alone.size(), 50u) << "one picture alone shows chips and spray";
    (void)after(forward, 0.0, 1.0, 0.02, false);
    EXPECT_TRUE(same(alone, after(forward, 20.0, 20.0, 1.0, true)));
    (void)after(backward, 50.0, 51.0, 0.02, true);
    EXPECT_TRUE(same(alone, after(backward, 20.0, 20.0, 1.0, true)));
}

TEST(Particles, NeverMoreThanThereIsRoomFor) {
    Particles particles;
    for (int i = 0; i < 400; ++i) {
        Moment moment = cutting(0.01 * i);
        moment.removalMm3S = 1e9;
        moment.water = true;
        particles.advance(moment, Look{}, 0.4);
        ASSERT_LE(particles.specks().size(), kMaxSpecks);
    }
    EXPECT_GT(particles.specks().size(), kMaxChips / 2);
}

TEST(Particles, MoreIsSeenWhereMoreIsCutAndNothingWithoutCutting) {
    const auto count = [](double removal) {
        Particles particles;
        std::size_t sum = 0;
        for (int i = 0; i < 100; ++i) {
            Moment moment = cutting(0.01 * i);
            moment.removalMm3S = removal;
            particles.advance(moment, dry(), 0.4);
            sum += particles.specks().size();
        }
        return static_cast<double>(sum);
    };
    EXPECT_EQ(count(0.0), 0.0);
    EXPECT_GT(count(0.3), 0.0);
    EXPECT_NEAR(count(0.6) / count(0.3), 2.0, 0.3) << "as long as there is room, as many as is removed";
}

TEST(Particles, ChipsAreOfTheTissuesColourAndEndWithTheCutting) {
    Particles particles;
    for (int i = 0; i < 50; ++i)
        particles.advance(cutting(0.01 * i), dry(), 0.4);
    ASSERT_FALSE(particles.specks().empty());
    const auto dentine = colourOf(cases::Tissue::dentine, Palette::natural);
    for (const Speck& s : particles.specks()) {
        const double shade = static_cast<double>(s.rgba[0]) / dentine[0];
        EXPECT_NEAR(s.rgba[1], shade * dentine[1], 1.5);
        EXPECT_NEAR(s.rgba[2], shade * dentine[2], 1.5);
    }
    for (int i = 50; i < 90; ++i) {
        Moment moment = cutting(0.01 * i);
        moment.removalMm3S = 0.0;
        particles.advance(moment, dry(), 0.4);
    }
    EXPECT_TRUE(particles.specks().empty());
}

Vec3 placeOf(const Speck& s) {
    return {s.positionMm[0], s.positionMm[1], s.positionMm[2]};
}

TEST(Particles, ChipsFlyOffTheSurfaceAndTheWayTheEdgeGoes) {
    Particles particles;
    Moment moment = cutting(0.0);
    moment.contactNormal = Vec3::UnitZ();
    moment.removalMm3S = 0.5;
    Vec3 sum = Vec3::Zero();
    double most = 0.0;
    for (int i = 0; i < 100; ++i) {
        moment.timeS = 0.002 * i;
        particles.advance(moment, dry(), 0.4);
        for (const Speck& s : particles.specks()) {
            sum += placeOf(s) - moment.contactPointMm;
            most = std::max(most, placeOf(s).z());
        }
    }
    // The contact lies at +x of the axis; clockwise seen from the shank the edge goes by towards -y there.
    EXPECT_LT(sum.y(), 0.0);
    EXPECT_GT(std::abs(sum.y()), 3.0 * std::abs(sum.x()));
    EXPECT_GT(most, 1.0) << "up to some millimetres above the surface";
    EXPECT_LT(most, 10.0);
}

TEST(Particles, WhatHasFlownSinks) {
    Particles particles;
    Moment moment = cutting(0.0);
    moment.contactNormal = Vec3::UnitZ();
    for (int i = 0; i < 100; ++i) {
        moment.timeS = 0.002 * i;
        particles.advance(moment, dry(), 0.4);
    }
    moment.removalMm3S = 0.0;
    moment.timeS += 0.08;
    particles.advance(moment, dry(), 0.4);
    ASSERT_GT(particles.specks().size(), 3u);
    // Stokes: v = g tau, straight down; a streak reaches back, so up.
    for (const Speck& s : particles.specks()) {
        EXPECT_GT(s.streakMm[2], 0.004 * 9810 * 0.0024);
        EXPECT_LT(s.streakMm[2], 0.004 * 9810 * 0.0061);
        EXPECT_LT(std::hypot(s.streakMm[0], s.streakMm[1]), 0.05 * s.streakMm[2]);
    }
}

TEST(Particles, JetsGoFromTheHeadToTheTipAndOnlyWithWaterOn) {
    Particles particles;
    std::mt19937_64 generator(test::seed());
    Moment moment;
    moment.speedRpm = 200000;
    moment.burInTooth.positionMm = {3, -2, 7};
    moment.burInTooth.orientation = test::randomRotation(generator);
    moment.water = true;
    particles.advance(moment, Look{}, 0.4);
    std::size_t jets = 0;
    for (const Speck& s : particles.specks()) {
        const Vec3 head = placeOf(s);
        const Vec3 streak(s.streakMm[0], s.streakMm[1], s.streakMm[2]);
        if (streak.norm() < 2.0) continue;
        ++jets;
        const Vec3 port = moment.burInTooth.applyInverse(head), end = moment.burInTooth.applyInverse(head + streak);
        EXPECT_GT(port.z(), 7.0) << "they come from the head, which is towards the shank";
        EXPECT_LT(end.head<2>().norm(), port.head<2>().norm()) << "and go towards the tip";
        EXPECT_GT(end.norm(), 1.0) << "at the tip they are mist";
        EXPECT_LT((port - end).normalized().dot(end.normalized()) - 1.0, 0.0);
        EXPECT_GT((port - end).normalized().dot(end.normalized()), 0.97) << "the line leads to the tip";
    }
    EXPECT_EQ(jets, kJets);
    moment.timeS += 0.004;
    particles.advance(moment, dry(), 0.4);
    EXPECT_TRUE(particles.specks().empty()) << "spray that is not wanted";
    for (const bool stands : {true, false}) {
        Particles none;
        Moment still = moment;
        still.water = stands;
        still.speedRpm = stands ? 0.0 : 200000;
        none.advance(still, Look{}, 0.4);
        EXPECT_TRUE(none.specks().empty()) << (stands ? "the turbine stands" : "the water is off");
    }
}

TEST(Particles, InputsThatAreNoNumbersGiveNothing) {
    Particles particles;
    Moment moment = cutting(std::numeric_limits<double>::quiet_NaN());
    particles.advance(moment, Look{}, 0.4);
    EXPECT_TRUE(particles.specks().empty());
    moment = cutting(1.0);
    moment.burInTooth.positionMm.x() = std::numeric_limits<double>::infinity();
    particles.advance(moment, Look{}, 0.4);
    EXPECT_TRUE(particles.specks().empty());
}

}  // namespace
}  // namespace handpiece::view::particles_test
