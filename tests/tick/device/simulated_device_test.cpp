// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/device/simulated_device.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "handpiece/base/core/error.h"

namespace handpiece::device::simulated_device_test {
namespace {

using core::Pose;
using core::Quat;
using core::Vec3;

constexpr double kPeriodS = 1e-3;

Pose at(const Vec3& p) {
    return {p, Quat::Identity()};
}

SimulatedDeviceSettings free() {
    SimulatedDeviceSettings s;
    s.frictionN = 0.0;
    s.quantise = false;
    return s;
}

TEST(SimulatedDevice, isADampedOscillatorInClosedForm) {
    // Let go 1 N off balance: x(t) of m x'' = F - b x' - k x.
    SimulatedDeviceSettings s = free();
    s.hand = {"test", 0.05, 0.0005, 0.3};
    s.subStepS = 2e-6;
    SimulatedDevice device(s, hold(at(Vec3::Zero()), 1.0));
    (void)device.read(kPeriodS);
    device.command(Vec3(1, 0, 0), Vec3::Zero());
    const double m = 0.095e-3, b = 0.0005, k = 0.3;
    const double decay = b / (2 * m), w = std::sqrt(k / m - decay * decay);
    for (int i = 1; i <= 200; ++i) {
        (void)device.read(kPeriodS);
        const double t = i * kPeriodS;
        const double exact = 1 / k * (1 - std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t)));
        EXPECT_NEAR(device.truePositionMm().x(), exact, 0.003) << t;
    }
    EXPECT_EQ(device.truePositionMm().y(), 0.0);
}

TEST(SimulatedDevice, keepsItsEnergyBooks) {
    // Work of the applied force = kinetic + spring energy, without friction and damping.
    SimulatedDeviceSettings s = free();
    s.hand = {"test", 0.05, 0.0, 0.3};
    s.subStepS = 1e-6;
    SimulatedDevice device(s, hold(at(Vec3::Zero()), 1.0));
    Vec3 before = Vec3::Zero();
    (void)device.read(kPeriodS);
    double work = 0.0;
    for (int i = 0; i < 100; ++i) {
        const Vec3 force(std::sin(0.3 * i), 0.2, 0);
        device.command(force, Vec3::Zero());
        before = device.truePositionMm();
        (void)device.read(kPeriodS);
        work += force.dot(device.truePositionMm() - before);
    }
    EXPECT_NEAR(device.appliedWorkNmm(), work, 1e-12);
    // Speed from one more sub-step with no force would do; the last millisecond's mean is near enough at 1 us steps.
    const Vec3 p = device.truePositionMm();
    EXPECT_GT(work, 0.0);
    EXPECT_LT(0.5 * 0.3 * p.squaredNorm(), work * 1.01);
}

TEST(SimulatedDevice, frictionTrulySticksAndBrakesEvenly) {
    SimulatedDeviceSettings s;
    s.quantise = false;
    s.hand = {"absent", 0.0, 0.0, 0.0};
    SimulatedDevice device(s, hold(at(Vec3::Zero()), 1.0));
    (void)device.read(kPeriodS);
    device.command(Vec3(0.18, 0.18, 0), Vec3::Zero());  // 0.2546 N: below the 0.26 N in any direction
    for (int i = 0; i < 500; ++i)
        (void)device.read(kPeriodS);
    EXPECT_EQ(device.truePositionMm(), Vec3::Zero());
    // 0.5 N for 0.1 s, then none: it coasts v^2 m / 2 F further and stands.
    device.command(Vec3(0.5, 0, 0), Vec3::Zero());
    for (int i = 0; i < 100; ++i)
        (void)device.read(kPeriodS);
    device.command(Vec3::Zero(), Vec3::Zero());
    for (int i = 0; i < 300; ++i)
        (void)device.read(kPeriodS);
    const double m = 0.045e-3, pushed = 0.5 * (0.5 - 0.26) / m * 0.01;
    EXPECT_NEAR(device.truePositionMm().x(), pushed * 0.5 / 0.26, 0.5);
    const Vec3 rest = device.truePositionMm();
    for (int i = 0; i < 100; ++i)
        (void)device.read(kPeriodS);
    EXPECT_EQ(device.truePositionMm(), rest);
}

TEST(SimulatedDevice, readsEncoderSteps) {
    SimulatedDeviceSettings s;
    SimulatedDevice device(s, drop(at(Vec3::Zero()), {1, 0.3, 0}, 5.0, 10.0, 0.1));
    bool between = false;
    for (int i = 0; i < 600; ++i) {
        const Vec3 p = device.read(kPeriodS).burInTooth.positionMm;
        for (int axis = 0; axis < 3; ++axis) {
            const double steps = p[axis] / s.capability.encoderStepMm;
            EXPECT_NEAR(steps, std::round(steps), 1e-9);
            EXPECT_LE(std::abs(p[axis] - device.truePositionMm()[axis]), 0.5 * s.capability.encoderStepMm + 1e-12);
        }
        between = between || p != device.truePositionMm();
    }
    EXPECT_TRUE(between);
}

TEST(SimulatedDevice, delaysTheForceByTheTimeAskedFor) {
    for (const double rate : {1000.0, 4000.0}) {
        for (const double delay : {0.0, 0.001, 0.003}) {
            SimulatedDeviceSettings s = free();
            s.delayS = delay;
            SimulatedDevice device(s, hold(at(Vec3::Zero()), 1.0));
            (void)device.read(1 / rate);
            device.command(Vec3(0, 0, 1), Vec3::Zero());
            int ticks = 0;
            for (; device.appliedForceN().z() == 0.0; ++ticks) {
                (void)device.read(1 / rate);
                device.command(Vec3(0, 0, 1), Vec3::Zero());
            }
            EXPECT_EQ(ticks, static_cast<int>(std::lround(delay * rate)));
            EXPECT_NEAR(device.forceVariationN(), 1.0, 1e-12);
        }
    }
}

TEST(SimulatedDevice, aRigidHandIsExactlyOnItsPath) {
    SimulatedDeviceSettings s;
    s.rigidHand = true;
    SimulatedDevice device(s, drop(at({0, 0, 1}), {0, 0, -1}, 1.0, 10.0, 0.1));
    for (int i = 0; i < 150; ++i) {
        const Vec3 p = device.read(kPeriodS).burInTooth.positionMm;
        EXPECT_NEAR(p.z(), 1.0 - std::min(1.0, 0.01 * i), 1e-9);
        device.command(Vec3(0, 0, 3), Vec3::Zero());
    }
}

TEST(SimulatedDevice, repeatsItselfBitForBit) {
    const auto run = [] {
        std::vector<double> values;
        SimulatedDevice device(SimulatedDeviceSettings{},
                               closedLoop(Pose{}, Vec3::UnitX(), Vec3::UnitZ(), 3.0, 40.0, 1));
        for (int i = 0; i < 400; ++i) {
            const Vec3 p = device.read(kPeriodS).burInTooth.positionMm;
            device.command(-0.4 * p, Vec3::Zero());
            for (int axis = 0; axis < 3; ++axis)
                values.push_back(device.truePositionMm()[axis]);
        }
        return values;
    };
    EXPECT_EQ(run(), run());
}

TEST(SimulatedDevice, refusesFiguresThatCannotBe) {
    const auto refused = [](auto change) {
        SimulatedDeviceSettings s;
        change(s);
        EXPECT_THROW(SimulatedDevice(s, hold(Pose{}, 1.0)), core::Error);
    };
    refused([](SimulatedDeviceSettings& s) { s.massKg = 0; });
    refused([](SimulatedDeviceSettings& s) { s.frictionN = -0.1; });
    refused([](SimulatedDeviceSettings& s) { s.delayS = 1.0; });
    refused([](SimulatedDeviceSettings& s) { s.subStepS = 0; });
    refused([](SimulatedDeviceSettings& s) { s.hand.stiffnessNPerMm = std::nan(""); });
    refused([](SimulatedDeviceSettings& s) { s.capability.maxForceN = 0; });
    EXPECT_EQ(handByName("stiff").massKg, 0.10);
    EXPECT_THROW((void)handByName("third"), core::Error);
}

}  // namespace
}  // namespace handpiece::device::simulated_device_test
