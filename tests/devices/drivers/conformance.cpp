// SPDX-License-Identifier: Apache-2.0
#include "devices/drivers/conformance.h"

#include "handpiece/base/core/error.h"
#include "handpiece/tick/device/capability.h"
#include "support/error_of.h"

namespace handpiece::drivers {
namespace {

using core::Pose;
using core::Quat;
using core::Vec3;
using link::DeviceFault;
using test::errorOf;

Vec3 positionOf(const link::DriverReading& r) {
    return {r.positionMm[0], r.positionMm[1], r.positionMm[2]};
}
Quat turnOf(const link::DriverReading& r) {
    return {r.orientation[0], r.orientation[1], r.orientation[2], r.orientation[3]};
}
double secondsSince(std::chrono::steady_clock::time_point then) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count();
}

TEST_P(Conformance, tellsWhatItIsAndStreams) {
    Probe probe;
    auto driver = adaptor->open(0);
    const link::DriverInfo& info = driver->info();
    EXPECT_EQ(info.driver, traits.driver);
    EXPECT_FALSE(info.model.empty());
    EXPECT_FALSE(info.sources.empty()) << "where the figures come from";
    EXPECT_EQ(info.pushes, traits.force);
    EXPECT_EQ(info.hasOrientation, traits.orientation);
    EXPECT_GT(info.servoHz, 0.0);
    if (info.pushes) {
        EXPECT_NO_THROW(device::validate(info.capability));
        EXPECT_EQ(info.capability.maxTorqueNmm > 0, traits.torque);
    }
    EXPECT_EQ(probe.count(), 0u) << "nothing is exchanged before start()";
    driver->start(probe);
    ASSERT_TRUE(await([&] { return probe.count() > 20 && probe.last().trouble == DeviceFault::none; }))
        << link::idOf(probe.last().trouble);
    EXPECT_EQ(probe.faultsOfOrder(), 0u);
    EXPECT_GT(probe.last().timeNs, 0);
    driver->stop();
    EXPECT_EQ(adaptor->breaches(), 0u) << adaptor->lastBreach();
}

TEST_P(Conformance, posesAreExactInTheDeviceFrame) {
    if (!traits.absolute || !traits.steered) GTEST_SKIP() << "its hand cannot be put somewhere";
    Probe probe;
    auto driver = started(0, probe);
    const Vec3 w = traits.workMm;
    for (const Vec3& at : {Vec3(w.x(), 0, 0), Vec3(0, w.y(), 0), Vec3(0, 0, w.z()), Vec3(-w.x(), 0, 0),
                           Vec3(0, -w.y(), 0), Vec3(0, 0, -w.z()), Vec3(0.31 * w.x(), -0.17 * w.y(), 0.53 * w.z())}) {
        adaptor->move(0, {at, Quat::Identity()});
        // A frame that a busy machine keeps waiting is told late, and the next one is whole again.
        EXPECT_TRUE(await([&] {
            const auto last = probe.last();
            return (positionOf(last) - at).norm() <= 2.0 * traits.stepMm && last.trouble == DeviceFault::none;
        })) << "asked for "
            << at.transpose() << ", told " << positionOf(probe.last()).transpose() << ' '
            << link::idOf(probe.last().trouble);
    }
    driver->stop();
    EXPECT_EQ(adaptor->breaches(), 0u) << adaptor->lastBreach();
}

TEST_P(Conformance, aDeflectionSteersAlongItsAxis) {
    if (traits.absolute) GTEST_SKIP() << "tells poses";
    Probe probe;
    auto driver = started(0, probe);
    for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {1.0, -1.0}) {
            const Vec3 before = positionOf(probe.last());
            adaptor->move(0, {sign * traits.workMm[axis] * Vec3::Unit(axis), Quat::Identity()});
            EXPECT_TRUE(await([&] { return sign * (positionOf(probe.last()) - before)[axis] > 0.5; }))
                << "axis " << axis << ", sign " << sign << ": " << (positionOf(probe.last()) - before).transpose();
            Vec3 across = positionOf(probe.last()) - before;
            const double along = std::abs(across[axis]);
            across[axis] = 0;
            EXPECT_LT(across.norm(), 0.1 * along + 1e-6) << "axis " << axis << ", sign " << sign;
            adaptor->move(0, {});
        }
    }
    driver->stop();
    EXPECT_EQ(adaptor->breaches(), 0u) << adaptor->lastBreach();
}

TEST_P(Conformance, turnsAreRightHandedAndUnit) {
    if (!traits.orientation || !traits.absolute || !traits.steered) GTEST_SKIP() << "its hand cannot be turned";
    Probe probe;
    auto driver = started(0, probe);
    std::vector<Quat> turns;
    for (int axis = 0; axis < 3; ++axis)
        for (const double angle : {0.5, -0.5, 3.0})
            turns.emplace_back(Eigen::AngleAxisd(angle, Vec3::Unit(axis)));
    turns.emplace_back(turns[0] * turns[4] * turns[7]);
    for (const Quat& turn : turns) {
        adaptor->move(0, {Vec3(1, 2, 3).cwiseMin(traits.workMm), turn});
        EXPECT_TRUE(await([&] { return turnOf(probe.last()).angularDistance(turn) <= 2.0 * traits.angleRad; }))
            << "asked for " << turn.coeffs().transpose() << ", told " << turnOf(probe.last()).coeffs().transpose();
        EXPECT_NEAR(turnOf(probe.last()).norm(), 1.0, 1e-9);
    }
    driver->stop();
}

TEST_P(Conformance, buttonsAreToldAsTheyArePressed) {
    if (traits.buttons == 0) GTEST_SKIP() << "has no buttons";
    Probe probe;
    auto driver = started(0, probe);
    for (int bit = 0; bit < traits.buttons; ++bit) {
        adaptor->press(0, 1u << bit);
        EXPECT_TRUE(await([&] { return probe.last().buttons == 1u << bit; }))
            << "bit " << bit << ", told " << probe.last().buttons;
        adaptor->press(0, 0);
        EXPECT_TRUE(await([&] { return probe.last().buttons == 0; }));
    }
    if (traits.buttons > 1) {
        adaptor->press(0, 3);
        EXPECT_TRUE(await([&] { return probe.last().buttons == 3; }));
    }
    driver->stop();
}

TEST_P(Conformance, forceArrivesWithItsSignAndAxis) {
    if (!felt()) GTEST_SKIP() << "input only, or what arrives cannot be read";
    Probe probe;
    auto driver = started(0, probe);
    EXPECT_TRUE(await([&] { return adaptor->arrived(0).count > 2; }));
    EXPECT_EQ(adaptor->arrived(0).forceN, Vec3::Zero()) << "nothing asked for, nothing sent";
    for (int axis = 0; axis < 3; ++axis) {
        for (const double newton : {0.7, -0.7}) {
            const Vec3 force = newton * Vec3::Unit(axis);
            probe.push(force);
            EXPECT_TRUE(await([&] { return (adaptor->arrived(0).forceN - force).norm() <= 2.0 * traits.forceStepN; }))
                << "asked for " << force.transpose() << ", arrived " << adaptor->arrived(0).forceN.transpose();
        }
    }
    driver->stop();
    EXPECT_EQ(adaptor->breaches(), 0u) << adaptor->lastBreach();
}

TEST_P(Conformance, torqueArrivesWithItsSignAndAxis) {
    if (!traits.torque) GTEST_SKIP() << "drives no torque";
    Probe probe;
    auto driver = started(0, probe);
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 torque = (axis == 1 ? -20.0 : 20.0) * Vec3::Unit(axis);
        probe.push(Vec3::Zero(), torque);
        EXPECT_TRUE(await([&] {
            return (adaptor->arrived(0).torqueNmm - torque).norm() <= 2.0 * traits.torqueStepNmm;
        })) << "asked for "
            << torque.transpose() << ", arrived " << adaptor->arrived(0).torqueNmm.transpose();
    }
    driver->stop();
}

TEST_P(Conformance, stopLeavesNoForceAndNoThread) {
    Probe probe;
    auto driver = started(0, probe);
    if (felt()) {
        probe.push({0, 1, 0});
        EXPECT_TRUE(await([&] { return adaptor->arrived(0).forceN.norm() > 0.5; }));
    }
    const auto then = std::chrono::steady_clock::now();
    driver->stop();
    EXPECT_LT(secondsSince(then), 2.0) << "a second, on a machine that is busy";
    const std::uint64_t count = probe.count();
    if (felt()) {
        EXPECT_EQ(adaptor->arrived(0).forceN, Vec3::Zero());
    }
    const std::uint64_t sent = adaptor->arrived(0).count;
    driver->stop();
    EXPECT_EQ(adaptor->arrived(0).count, sent) << "a second stop() sends";
    driver.reset();
    anotherRound();
    EXPECT_EQ(probe.count(), count) << "exchanges after stop()";
    EXPECT_EQ(adaptor->breaches(), 0u) << adaptor->lastBreach();
}

TEST_P(Conformance, unpluggingIsTroubleAndNoForce) {
    if (!traits.tellsUnplug) GTEST_SKIP() << "its interface cannot tell";
    Probe probe;
    auto driver = started(0, probe);
    if (felt()) {
        probe.push({1, 0, 0});
        EXPECT_TRUE(await([&] { return adaptor->arrived(0).forceN.norm() > 0.5; }));
    }
    adaptor->unplug(0);
    ASSERT_TRUE(await([&] { return probe.last().trouble == DeviceFault::unplugged; }))
        << "told " << link::idOf(probe.last().trouble);
    if (felt()) {
        EXPECT_TRUE(await([&] { return adaptor->arrived(0).forceN.isZero(); }));
    }
    const std::uint64_t count = probe.count();
    EXPECT_TRUE(await([&] { return probe.count() > count + 2; })) << "a device in trouble is still exchanged";
    const auto then = std::chrono::steady_clock::now();
    driver->stop();
    EXPECT_LT(secondsSince(then), 2.0);
    driver.reset();
    adaptor->reset();
    Probe again;
    started(0, again)->stop();
}

TEST_P(Conformance, lateFramesAreSeenAndOutlived) {
    if (!traits.stalls) GTEST_SKIP() << "it cannot be held up";
    Probe probe;
    auto driver = started(0, probe);
    probe.forget();
    const std::uint64_t before = probe.count();
    adaptor->stall(0, 0.15);
    // Either the driver says so itself or the gap stands in the times of its readings, where the gate sees it.
    EXPECT_TRUE(await([&] { return probe.longestNs() >= 100'000'000 || probe.trouble() == DeviceFault::stalled; }));
    EXPECT_TRUE(await([&] { return probe.count() > before + 5 && probe.last().trouble == DeviceFault::none; }))
        << "told " << link::idOf(probe.last().trouble);
    EXPECT_EQ(probe.faultsOfOrder(), 0u);
    driver->stop();
}

TEST_P(Conformance, wrongOrderIsRefusedOrHarmless) {
    {
        auto driver = adaptor->open(0);
        driver->stop();
        driver->stop();
        Probe probe;
        EXPECT_EQ(test::errorIdOf([&] { driver->start(probe); }), "device-stopped") << "stop() has closed it";
        if (traits.calibrates) {
            EXPECT_EQ(test::errorIdOf([&] { (void)driver->calibrate(); }), "not-started") << "stopped";
        }
    }
    {
        auto driver = adaptor->open(0);
        if (traits.calibrates) {
            const auto said = test::errorFrom([&] { (void)driver->calibrate(); });
            ASSERT_TRUE(said.has_value()) << "not started";
            EXPECT_EQ(said->id(), "not-started");
            EXPECT_EQ(said->problem(), "the device cannot be calibrated before it is connected");
            EXPECT_EQ(said->where(), driver->info().model);
        } else {
            EXPECT_EQ(driver->calibration(), link::CalibrationState::notNeeded);
        }
        Probe probe, other;
        driver->start(probe);
        EXPECT_EQ(test::errorIdOf([&] { driver->start(other); }), "device-started");
        EXPECT_TRUE(await([&] { return probe.count() > 2; })) << "the first start goes on";
        EXPECT_EQ(other.count(), 0u);
        if (traits.exclusive) {
            EXPECT_NE(errorOf([&] { (void)adaptor->open(0); }), "") << "it is open already";
        }
        driver->stop();  // before its servo goes
    }
    {  // A driver that is dropped without a word frees the device.
        Probe probe;
        (void)started(0, probe);
    }
    {
        (void)adaptor->open(0);
        Probe probe;
        started(0, probe)->stop();
    }
    EXPECT_EQ(adaptor->breaches(), 0u) << adaptor->lastBreach();
}

TEST_P(Conformance, everyErrorIsToldWithItsCode) {
    const std::vector<VendorError> errors = adaptor->errors();
    if (errors.empty()) GTEST_SKIP() << "its interface tells none";
    for (const VendorError& error : errors) {
        SCOPED_TRACE(error.name);
        adaptor->reset();
        Probe probe;
        auto driver = started(0, probe);
        if (felt()) {
            probe.push({0, 0.5, 0});
            EXPECT_TRUE(await([&] { return adaptor->arrived(0).forceN.norm() > 0.4; }));
        }
        probe.forget();
        adaptor->raise(0, error);
        if (error.code != 0) {
            EXPECT_TRUE(await([&] { return probe.code() == error.code; })) << "told " << probe.code();
        }
        if (error.fatal) {
            EXPECT_TRUE(await([&] { return probe.trouble() == error.told; })) << link::idOf(probe.trouble());
            if (felt()) {
                EXPECT_TRUE(await([&] { return adaptor->arrived(0).forceN.isZero(); }));
            }
        } else {
            const std::uint64_t count = probe.count();
            EXPECT_TRUE(await([&] { return probe.count() > count + 5 && probe.last().trouble == DeviceFault::none; }));
            if (felt()) {
                EXPECT_TRUE(await([&] { return adaptor->arrived(0).forceN.norm() > 0.4; }));
            }
        }
        driver->stop();
        EXPECT_EQ(adaptor->breaches(), 0u) << adaptor->lastBreach();
    }
}

TEST_P(Conformance, calibrationIsAskedForAndDone) {
    if (!traits.calibrates) GTEST_SKIP() << "needs none";
    adaptor->uncalibrate(0);
    Probe probe;
    auto driver = adaptor->open(0);
    driver->start(probe);
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::notCalibrated; }))
        << link::idOf(probe.last().trouble);
    const link::CalibrationState state = driver->calibration();
    EXPECT_TRUE(state == link::CalibrationState::wanted || state == link::CalibrationState::wantedByHand);
    EXPECT_FALSE(driver->calibrationStep().empty());
    adaptor->finishCalibration(0);
    EXPECT_TRUE(await([&] { return driver->calibrate(); }));
    EXPECT_EQ(driver->calibration(), link::CalibrationState::good);
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::none; })) << link::idOf(probe.last().trouble);
    driver->stop();
    EXPECT_EQ(adaptor->breaches(), 0u) << adaptor->lastBreach();
}

TEST_P(Conformance, twoDevicesDoNotMix) {
    if (traits.devices < 2) GTEST_SKIP() << "one at a time";
    Probe first, second;
    auto a = started(0, first), b = started(1, second);
    const Vec3 far = 0.5 * traits.workMm;
    adaptor->move(1, {far, Quat::Identity()});
    if (traits.absolute && traits.steered) {
        EXPECT_TRUE(await([&] { return (positionOf(second.last()) - far).norm() <= 2.0 * traits.stepMm; }));
        EXPECT_LE(positionOf(first.last()).norm(), 2.0 * traits.stepMm);
    }
    if (traits.buttons > 0) {
        adaptor->press(0, 1);
        EXPECT_TRUE(await([&] { return first.last().buttons == 1; }));
        EXPECT_EQ(second.last().buttons, 0u);
    }
    if (felt()) {
        first.push({0.6, 0, 0});
        second.push({0, 0, -0.4});
        EXPECT_TRUE(await([&] {
            return (adaptor->arrived(0).forceN - Vec3(0.6, 0, 0)).norm() <= 2.0 * traits.forceStepN &&
                   (adaptor->arrived(1).forceN - Vec3(0, 0, -0.4)).norm() <= 2.0 * traits.forceStepN;
        }));
    }
    a->stop();
    const std::uint64_t count = second.count();
    EXPECT_TRUE(await([&] { return second.count() > count + 5; })) << "stopping one stopped the other";
    EXPECT_EQ(second.last().trouble, DeviceFault::none);
    if (felt()) {
        EXPECT_TRUE(adaptor->arrived(0).forceN.isZero());
        EXPECT_GT(adaptor->arrived(1).forceN.norm(), 0.3);
    }
    b->stop();
    EXPECT_EQ(adaptor->breaches(), 0u) << adaptor->lastBreach();
}

TEST_P(Conformance, startsAgainInTheSameProgram) {
    for (int round = 0; round < 3; ++round) {
        Probe probe;
        auto driver = started(0, probe);
        EXPECT_EQ(probe.faultsOfOrder(), 0u) << "frames count from 1 again";
        driver->stop();
    }
    EXPECT_EQ(adaptor->breaches(), 0u) << adaptor->lastBreach();
}

TEST_P(Conformance, stopsWhileTheInterfaceIsDead) {
    if (!traits.stalls) GTEST_SKIP() << "it cannot be held up";
    Probe probe;
    auto driver = started(0, probe);
    adaptor->stall(0, 3.0);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // it has begun
    const auto then = std::chrono::steady_clock::now();
    driver->stop();
    EXPECT_LT(secondsSince(then), 2.0);
    const std::uint64_t count = probe.count();
    driver.reset();
    EXPECT_LT(secondsSince(then), 2.0);
    adaptor->reset();
    anotherRound();
    EXPECT_EQ(probe.count(), count) << "a frame that was held up came after stop()";
}

}  // namespace

// A program with no adaptor linked in has nothing to test; each driver adds its own.
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Conformance);

}  // namespace handpiece::drivers
