// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/instrument/rotor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "support/random.h"
#include "support/realtime_trap.h"

namespace handpiece::instrument::rotor_test {
namespace {

constexpr double kRadSPerRpm = std::numbers::pi / 30.0;

Rotor spunUp(const Drive& drive) {
    Rotor rotor(drive);
    rotor.step(1.0, 0.0, 100.0);
    return rotor;
}

TEST(Rotor, RunsUpToItsFreeSpeedWithItsTimeConstant) {
    for (const Drive& drive : drives()) {
        validate(drive);
        const double freeRadS = drive.freeSpeedRpm * kRadSPerRpm;
        const double tauS = drive.inertiaNmmS2 * freeRadS / drive.stallTorqueNmm;
        Rotor rotor(drive);
        rotor.step(1.0, 0.0, tauS);
        EXPECT_NEAR(rotor.speedRadS(), freeRadS * (1.0 - std::exp(-1.0)), 1e-12 * freeRadS) << drive.name;
        rotor.step(1.0, 0.0, 100.0);
        EXPECT_NEAR(rotor.speedRpm(), drive.freeSpeedRpm, 1e-9 * drive.freeSpeedRpm) << drive.name;
    }
    // 1e-5 x 41888 / 1.2
    const Drive& turbine = driveByName("turbine");
    EXPECT_NEAR(turbine.inertiaNmmS2 * turbine.freeSpeedRpm * kRadSPerRpm / turbine.stallTorqueNmm, 0.349, 0.001);
}

TEST(Rotor, DroopsByWhatTheLoadTakes) {
    // 1 N on a 1 mm bur at mu 0.3: 0.15 N mm of 1.2.
    Rotor rotor = spunUp(driveByName("turbine"));
    for (int i = 0; i < 10000; ++i)
        rotor.step(1.0, 0.3 * 1.0 * 0.5, 1e-3);
    EXPECT_NEAR(rotor.speedRpm(), 350000, 1e-3);
    EXPECT_FALSE(rotor.stalled());
    // A moderate load, 0.8 N: the tenth that is measured (322.2 to 288.4 krpm).
    for (int i = 0; i < 10000; ++i)
        rotor.step(1.0, 0.3 * 0.8 * 0.5, 1e-3);
    EXPECT_NEAR(rotor.speedRpm(), 0.9 * 400000, 1e-3);
}

TEST(Rotor, StallsAtItsTorqueStandsAndRecovers) {
    for (const Drive& drive : drives()) {
        Rotor rotor = spunUp(drive);
        rotor.step(1.0, 0.999 * drive.stallTorqueNmm, 100.0);
        EXPECT_NEAR(rotor.speedRpm(), 0.001 * drive.freeSpeedRpm, 1e-6 * drive.freeSpeedRpm) << drive.name;
        EXPECT_FALSE(rotor.stalled());
        for (int i = 0; i < 5000; ++i) {
            rotor.step(1.0, 1.001 * drive.stallTorqueNmm, 1e-3);
            ASSERT_GE(rotor.speedRadS(), 0.0);
        }
        EXPECT_EQ(rotor.speedRadS(), 0.0) << drive.name;
        EXPECT_TRUE(rotor.stalled()) << drive.name;
        rotor.step(1.0, 0.0, 1e-3);
        EXPECT_FALSE(rotor.stalled());
        EXPECT_GT(rotor.speedRadS(), 0.0);
    }
}

TEST(Rotor, AWeakTurbineStallsWhereAStrongOneTurns) {
    const double load = 0.3 * 3.3 * 0.5;  // all a Touch can press, on a 1 mm bur
    Rotor strong = spunUp(driveByName("turbine")), weak = spunUp(driveByName("weak-turbine"));
    strong.step(1.0, load, 10.0);
    weak.step(1.0, load, 10.0);
    EXPECT_NEAR(strong.speedRpm() / 400000, 1.0 - 0.495 / 1.2, 1e-9);
    EXPECT_TRUE(weak.stalled());
}

TEST(Rotor, IsStoppedByItsBearingWhenTheAirIsOff) {
    const Drive& drive = driveByName("turbine");
    const double stopsS = drive.inertiaNmmS2 * drive.freeSpeedRpm * kRadSPerRpm / drive.bearingTorqueNmm;
    Rotor rotor = spunUp(drive);
    rotor.step(0.0, 0.0, 0.5 * stopsS);
    EXPECT_NEAR(rotor.speedRpm(), 200000, 1e-3);
    rotor.step(0.0, 0.0, 0.51 * stopsS);
    EXPECT_EQ(rotor.speedRadS(), 0.0);
    EXPECT_FALSE(rotor.stalled()) << "nobody asked it to turn";
    EXPECT_NEAR(stopsS, 2.1, 0.05);
    // Part of the air: still in balance with the bearing.
    rotor.step(0.5, 0.0, 100.0);
    EXPECT_NEAR(rotor.speedRpm() / 400000, 1.0 - 0.2 / 1.2, 1e-9);
}

TEST(Rotor, OneStepIsManySteps) {
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 200; ++i) {
        const Drive& drive = drives()[generator() % drives().size()];
        const double pedal = test::uniform(generator, 0.0, 1.0),
                     load = test::uniform(generator, 0.0, drive.stallTorqueNmm);
        Rotor one(drive), many(drive);
        one.step(1.0, 0.0, 0.2);
        many.step(1.0, 0.0, 0.2);
        one.step(pedal, load, 0.256);
        for (int k = 0; k < 256; ++k)
            many.step(pedal, load, 1e-3);
        ASSERT_NEAR(one.speedRpm(), many.speedRpm(), 1e-9 * drive.freeSpeedRpm) << drive.name << " " << pedal;
    }
}

TEST(Rotor, TakesNonsenseForNothing) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    Rotor rotor = spunUp(driveByName("turbine"));
    const double before = rotor.speedRadS();
    rotor.step(1.0, nan, 1e-3);
    rotor.step(7.0, -3.0, 1e-3);
    rotor.step(1.0, 0.5, nan);
    rotor.step(1.0, 0.5, -1.0);
    EXPECT_NEAR(rotor.speedRadS(), before, 1e-9 * before);
    rotor.step(1.0, inf, 1e-3);
    EXPECT_EQ(rotor.speedRadS(), 0.0);
    rotor.step(nan, 0.0, 1.0);
    EXPECT_EQ(rotor.speedRadS(), 0.0);
}

TEST(Rotor, StepsWithoutTouchingTheSystem) {
    Rotor rotor(driveByName("turbine"));
    const Drive weak = driveByName("weak-turbine");
    if (!test::RealtimeTrap::isActive()) GTEST_SKIP() << "the sanitizers own malloc";
    const test::RealtimeTrap trap;
    for (int i = 0; i < 1000; ++i)
        rotor.step(0.8, 0.1, 1e-3);
    rotor.setDrive(weak);
    EXPECT_EQ(trap.total(), 0u);
    EXPECT_GT(rotor.speedRpm(), 0.0);
}

TEST(Rotor, goesOnFromASpeedOfARecordButFromNoOther) {
    Rotor rotor(driveByName("turbine")), other(driveByName("turbine"));
    for (int i = 0; i < 300; ++i)
        rotor.step(0.8, 0.1, 1e-3);
    other.setSpeedRpm(rotor.speedRpm());
    for (int i = 0; i < 20; ++i) {
        rotor.step(0.0, 0.0, 1e-3);
        other.step(0.0, 0.0, 1e-3);
        EXPECT_NEAR(other.speedRpm(), rotor.speedRpm(), 1e-6);
    }
    other.setSpeedRpm(400000.0);
    other.setDrive(driveByName("low-speed"));
    EXPECT_NO_THROW(other.setSpeedRpm(other.speedRpm())) << "it still turns faster than this drive";
    for (const double bad : {-1.0, 1e7, std::numeric_limits<double>::infinity(), std::nan("")}) {
        other.setSpeedRpm(1000.0);
        EXPECT_THROW(other.setSpeedRpm(bad), core::Error) << bad;
        EXPECT_NEAR(other.speedRpm(), 1000.0, 1e-9);
    }
}

TEST(Drive, NamesWhatIsWrong) {
    const auto problem = [](auto&& work) {
        try {
            work();
        } catch (const core::Error& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    EXPECT_THAT(problem([] { (void)driveByName("steam"); }),
                testing::AllOf(testing::HasSubstr("steam"), testing::HasSubstr("weak-turbine")));
    Drive drive;
    drive.stallTorqueNmm = -1.0;
    EXPECT_THAT(problem([&] { validate(drive); }), testing::HasSubstr("stall torque"));
    drive = {};
    drive.inertiaNmmS2 = 0.0;
    EXPECT_THAT(problem([&] { validate(drive); }), testing::HasSubstr("inertia"));
    drive = {};
    drive.freeSpeedRpm = std::numeric_limits<double>::infinity();
    EXPECT_THAT(problem([&] { validate(drive); }), testing::HasSubstr("free speed"));
}

}  // namespace
}  // namespace handpiece::instrument::rotor_test
