// SPDX-License-Identifier: Apache-2.0
// A driver behind its gate, as the tick has it: places, pedal, clutch, doubt, and no way past the gate.
#include "handpiece/devices/safety/guarded_device.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <thread>

#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/devices/drivers/simulated_driver.h"
#include "support/random.h"
#include "support/realtime_trap.h"

namespace handpiece::safety::guarded_device_test {
namespace {

using core::Quat;
using core::Vec3;
using link::DeviceFault;
using link::DriverCommand;
using link::DriverReading;

constexpr std::int64_t kMs = 1'000'000;

template <class Condition>
bool await(const Condition& condition) {
    for (int i = 0; i < 20000 && !condition(); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return condition();
}

/// A driver on strings, in virtual time.
class Puppet final : public link::Driver {
  public:
    struct Strings {
        DriverReading reading;
        DriverCommand got;
        link::DriverInfo info;
        std::int64_t nowNs = 3'000'000'000;
        int starts = 0, stops = 0;
        bool silent = false, refuses = false;
        link::Servo* servo = nullptr;
        void frame() {
            nowNs += kMs;
            if (silent) return;
            reading.timeNs = nowNs;
            ++reading.frame;
            got = servo->exchange(reading);
        }
    };
    explicit Puppet(Strings& strings) : strings_(strings) {}
    [[nodiscard]] const link::DriverInfo& info() const noexcept override { return strings_.info; }
    void start(link::Servo& servo) override {
        ++strings_.starts;
        strings_.servo = &servo;
        if (strings_.refuses) throw core::Error("the device is busy").as("device-busy", {"puppet"});
    }
    void stop() noexcept override { ++strings_.stops; }
    [[nodiscard]] link::CalibrationState calibration() override { return link::CalibrationState::wantedByHand; }
    [[nodiscard]] std::string calibrationStep() override { return "Press it home."; }
    bool calibrate() override { return false; }

  private:
    Strings& strings_;
};

struct Bench {
    explicit Bench(const std::function<void(GuardSettings&, Puppet::Strings&)>& change = {}) {
        GuardSettings settings;
        settings.shaping.passivityController = settings.shaping.thermalBudget = false;
        settings.nowNs = [this] { return strings.nowNs; };
        settings.advance = [this](double periodS) {
            for (int ms = 0; ms < std::lround(periodS * 1e3); ++ms)
                strings.frame();
        };
        if (change) change(settings, strings);
        device = std::make_unique<GuardedDevice>(std::make_unique<Puppet>(strings), settings);
        health = device->health();
    }
    device::Reading tick(const Vec3& forceN = Vec3::Zero(), const Vec3& torqueNmm = Vec3::Zero()) {
        const device::Reading reading = device->read(0.001);
        device->command(forceN, torqueNmm);
        return reading;
    }
    device::Reading run(int ms, const Vec3& forceN = Vec3::Zero(), const Vec3& torqueNmm = Vec3::Zero()) {
        device::Reading reading;
        for (int i = 0; i < ms; ++i)
            reading = tick(forceN, torqueNmm);
        return reading;
    }
    [[nodiscard]] Vec3 got() const { return Vec3(strings.got.forceN.data()); }

    Puppet::Strings strings;
    std::unique_ptr<GuardedDevice> device;
    std::shared_ptr<HealthBoard> health;
};

TEST(GuardedDevice, placesThePoseAndTurnsTheForce) {
    workspace::WorkspaceMapping placing;
    placing.deviceMm = Vec3(100, 0, -50);
    placing.toothMm = Vec3(0, 0, 8);
    placing.toothInDevice = Quat(Eigen::AngleAxisd(-M_PI / 2, Vec3::UnitX()));  // occlusal is up
    placing.scale = 2.0;
    Bench bench([&](GuardSettings& s, Puppet::Strings& strings) {
        s.placing = placing;
        strings.info.capability.maxTorqueNmm = 200.0;
        s.gate.maxTorqueNmm = 200.0;
    });
    bench.strings.reading.positionMm = {100, 4, -50};
    const device::Reading reading = bench.run(800, Vec3(0, 0, 1.5), Vec3(0, 30, 0));
    EXPECT_EQ(reading.status, device::ReadStatus::ok);
    EXPECT_LT((reading.burInTooth.positionMm - Vec3(0, 0, 10)).norm(), 1e-9);
    EXPECT_LT((bench.device->truePositionMm() - Vec3(0, 0, 10)).norm(), 1e-9);
    EXPECT_LT((bench.got() - Vec3(0, 1.5, 0)).norm(), 1e-9);
    EXPECT_LT((bench.device->appliedForceN() - Vec3(0, 0, 1.5)).norm(), 1e-9);
    const workspace::WorkspaceTransform mapping(placing);
    EXPECT_LT((Vec3(bench.strings.got.torqueNmm.data()) - mapping.torqueInDevice(Vec3(0, 30, 0))).norm(), 1e-9);
    EXPECT_EQ(bench.device->capability().maxStiffnessNPerMm, 1.0);  // twice, seen at the bur
    const Health health = bench.health->read();
    EXPECT_EQ(health.frames, 800u);
    EXPECT_EQ(health.gate.trouble, DeviceFault::none);
    EXPECT_EQ(health.positionMm[1], 4.0);
    EXPECT_LT((Vec3(health.sentN.data()) - Vec3(0, 1.5, 0)).norm(), 1e-9);
}

TEST(GuardedDevice, noSettingIsWiderThanTheDevicesRecord) {
    Bench bench([](GuardSettings& s, Puppet::Strings& strings) {
        strings.info.capability.maxForceN = 0.7;
        strings.info.capability.maxForceSlopeNPerS = 100.0;
        s.gate.maxForceN = 50.0;
        s.gate.maxTorqueNmm = 500.0;
        s.gate.maxSlopeNPerS = 1e5;
        s.shaping.maxForceN = 50.0;
    });
    double most = 0.0, steepest = 0.0, last = 0.0;
    for (int ms = 0; ms < 1500; ++ms) {
        bench.tick(Vec3(0, ms % 400 < 200 ? 40.0 : -40.0, 0), Vec3(0, 300, 0));
        most = std::max(most, bench.got().norm());
        steepest = std::max(steepest, std::abs(bench.got().y() - last));
        last = bench.got().y();
        EXPECT_EQ(Vec3(bench.strings.got.torqueNmm.data()).norm(), 0.0);
    }
    EXPECT_NEAR(most, 0.7, 1e-9);
    EXPECT_NEAR(steepest, 0.1, 1e-9);

    // Less than the record, as a profile may say.
    Bench half([](GuardSettings& s, Puppet::Strings& strings) {
        s.atTheHand = strings.info.capability;
        s.atTheHand->maxForceN = 1.1;
    });
    half.run(800, Vec3(0, 3, 0));
    EXPECT_NEAR(half.got().norm(), 1.1, 1e-9);
    EXPECT_EQ(half.device->capability().maxForceN, 1.1);
}

TEST(GuardedDevice, theUpperButtonIsThePedalUnlessThereIsOne) {
    Bench bench;
    bench.run(100);
    EXPECT_EQ(bench.tick().pedal, 0.0);
    bench.strings.reading.buttons = 1;
    EXPECT_EQ(bench.tick().pedal, 1.0);
    bench.strings.reading.pedal = 0.25f;
    EXPECT_EQ(bench.tick().pedal, 0.25);
    EXPECT_EQ(bench.tick().buttons, 1u);
    Bench without([](GuardSettings& s, auto&) { s.upperButtonCuts = false; });
    without.strings.reading.buttons = 1;
    without.run(100);
    EXPECT_EQ(without.tick().pedal, 0.0);
}

TEST(GuardedDevice, inDoubtThePoseIsLostAndNobodyPressesAnything) {
    Bench bench;
    EXPECT_EQ(bench.tick().status, device::ReadStatus::lost);  // starting
    bench.strings.reading.buttons = 1;
    const device::Reading good = bench.run(500, Vec3(0, 1, 0));
    ASSERT_EQ(good.status, device::ReadStatus::ok);
    bench.strings.reading.positionMm[0] = std::nan("");
    const device::Reading bad = bench.tick(Vec3(0, 1, 0));
    EXPECT_EQ(bad.status, device::ReadStatus::lost);
    EXPECT_EQ(bad.pedal, 0.0);
    EXPECT_EQ(bad.buttons, 0u);
    EXPECT_TRUE(bad.burInTooth.isValid());
    EXPECT_EQ(bad.burInTooth.positionMm, good.burInTooth.positionMm);
    bench.run(8, Vec3(0, 1, 0));
    EXPECT_EQ(bench.got().norm(), 0.0);
    EXPECT_EQ(bench.health->read().gate.trouble, DeviceFault::notFinite);
    bench.strings.reading.positionMm[0] = 0.0;
    EXPECT_EQ(bench.run(49).status, device::ReadStatus::lost);
    EXPECT_EQ(bench.run(5).status, device::ReadStatus::ok);
}

TEST(GuardedDevice, aForceThatIsNoNumberIsToldAndForgotten) {
    Bench bench;
    bench.run(500, Vec3(0, 1, 0));
    bench.tick(Vec3(0, std::nan(""), 0));
    bench.run(10, Vec3(0, 1, 0));
    EXPECT_EQ(bench.got().norm(), 0.0);
    EXPECT_EQ(bench.health->read().gate.last, DeviceFault::notFinite);
    bench.run(600, Vec3(0, 1, 0));
    EXPECT_NEAR(bench.got().y(), 1.0, 1e-9);
}

TEST(GuardedDevice, aDeviceThatSaysNothingIsLostAndRelaxed) {
    Bench bench;
    bench.run(500, Vec3(0, 1, 0));
    bench.strings.silent = true;
    bench.run(10, Vec3(0, 1, 0));
    EXPECT_EQ(bench.health->read().relaxed, 1u);
    EXPECT_EQ(bench.health->read().gate.trouble, DeviceFault::stalled);
    EXPECT_EQ(bench.tick().status, device::ReadStatus::ok);  // as old as a slow device's
    EXPECT_EQ(bench.run(15).status, device::ReadStatus::lost);
    bench.strings.silent = false;
    bench.tick(Vec3(0, 1, 0));
    EXPECT_EQ(bench.got().norm(), 0.0);
    bench.run(600, Vec3(0, 1, 0));
    EXPECT_NEAR(bench.got().y(), 1.0, 1e-9);
    EXPECT_EQ(bench.health->read().relaxed, 1u);
}

TEST(GuardedDevice, betweenTwoLoopsNothingIsCommandedForLong) {
    Bench bench;
    bench.run(500, Vec3(0, 1, 0));
    for (int ms = 0; ms < 3000; ++ms)
        bench.strings.frame();
    EXPECT_EQ(bench.got().norm(), 0.0);
    EXPECT_EQ(bench.health->read().gate.trouble, DeviceFault::tickStalled);
    bench.run(20, Vec3(0, 1, 0));
    EXPECT_EQ(bench.got().norm(), 0.0);
    bench.run(60, Vec3(0, 1, 0));
    EXPECT_GT(bench.got().norm(), 0.0);
    EXPECT_LT(bench.got().norm(), 0.3);  // it fades in
    EXPECT_EQ(bench.tick().status, device::ReadStatus::ok);
}

TEST(GuardedDevice, theClutchIsHonouredOnlyWhereTheBurIsFree) {
    Bench bench;
    bench.run(500);
    // Pressing on the tooth: not honoured.
    bench.run(100, Vec3(0, 1, 0));
    bench.strings.reading.buttons = 4;
    bench.strings.reading.positionMm = {1, 0, 0};
    EXPECT_EQ(bench.run(100, Vec3(0, 1, 0)).burInTooth.positionMm.x(), 1.0);
    EXPECT_FALSE(bench.health->read().clutched);
    EXPECT_GT(bench.got().norm(), 0.1);
    // Free, but held from before: not either.
    bench.run(100);
    EXPECT_FALSE(bench.health->read().clutched);
    bench.strings.reading.buttons = 0;
    bench.run(2);
    // Free.
    bench.strings.reading.buttons = 4 | 1;
    bench.strings.reading.buttons = 4;
    bench.run(1);
    EXPECT_TRUE(bench.run(1).burInTooth.positionMm.isApprox(Vec3(1, 0, 0)));
    EXPECT_TRUE(bench.health->read().clutched);
    for (int ms = 0; ms < 100; ++ms) {
        bench.strings.reading.positionMm[1] += 0.3;
        bench.strings.reading.buttons = 4 | 1;  // the pedal counts for nothing meanwhile
        const double angle = 0.005 * ms;
        bench.strings.reading.orientation = {std::cos(angle / 2), 0, 0, std::sin(angle / 2)};
        const device::Reading reading = bench.tick(Vec3(0, 2, 0));
        ASSERT_TRUE(reading.burInTooth.positionMm.isApprox(Vec3(1, 0, 0)));
        EXPECT_EQ(reading.pedal, 0.0);
        EXPECT_EQ(bench.got().norm(), 0.0);
    }
    const Quat turned = bench.tick().burInTooth.orientation;
    // Let go: it goes on from there, and a force fades in.
    bench.strings.reading.buttons = 0;
    EXPECT_TRUE(bench.tick(Vec3(0, 2, 0)).burInTooth.positionMm.isApprox(Vec3(1, 0, 0)));
    EXPECT_LT(bench.tick().burInTooth.orientation.angularDistance(turned), 1e-9);
    bench.strings.reading.positionMm[1] += 2.0;
    EXPECT_TRUE(bench.tick(Vec3(0, 2, 0)).burInTooth.positionMm.isApprox(Vec3(1, 2, 0)));
    bench.run(20, Vec3(0, 2, 0));
    EXPECT_LT(bench.got().norm(), 0.3);
    bench.run(400, Vec3(0, 2, 0));
    EXPECT_NEAR(bench.got().norm(), 2.0, 1e-9);
}

TEST(GuardedDevice, anotherPlacingBeginsAnew) {
    Bench bench;
    bench.run(500, Vec3(0, 1, 0));
    workspace::WorkspaceMapping placing;
    placing.toothMm = Vec3(5, 0, 0);  // less than what ForceModel's own guard takes for a jump
    bench.health->place(placing);
    EXPECT_EQ(bench.tick(Vec3(0, 1, 0)).status, device::ReadStatus::lost);
    const device::Reading reading = bench.tick();
    EXPECT_EQ(reading.status, device::ReadStatus::ok);
    EXPECT_EQ(reading.burInTooth.positionMm.x(), 5.0);
    placing.scale = 2.0;
    EXPECT_NO_THROW(bench.health->place(placing));
    placing.scale = 7.0;
    EXPECT_THROW(bench.health->place(placing), core::Error);
    stability::ShaperSettings shaping;
    shaping.forceScale = 100.0;
    EXPECT_THROW(bench.health->shape(shaping), core::Error);

    Bench coarse([](GuardSettings& s, auto&) { s.placing.scale = 2.0; });
    placing.scale = 1.0;  // the loop's stiffness is that of 2:1
    try {
        coarse.health->place(placing);
        ADD_FAILURE() << "taken";
    } catch (const core::Error& e) {
        EXPECT_EQ(e.id(), "scale-at-start");
    }
}

TEST(GuardedDevice, aDriverThatRefusesIsStoppedAndSaysWhy) {
    Puppet::Strings strings;
    strings.refuses = true;
    try {
        GuardedDevice device(std::make_unique<Puppet>(strings), {});
        ADD_FAILURE() << "opened";
    } catch (const core::Error& e) {
        EXPECT_EQ(e.id(), "device-busy");
    }
    EXPECT_EQ(strings.stops, 1);

    Puppet::Strings wrong;
    wrong.info.capability.maxForceN = -3.0;
    EXPECT_THROW(GuardedDevice(std::make_unique<Puppet>(wrong), {}), core::Error);
    EXPECT_EQ(wrong.starts, 0);
}

TEST(GuardedDevice, handsOnItsDriversCalibration) {
    Bench bench;
    EXPECT_EQ(bench.device->calibration(), link::CalibrationState::wantedByHand);
    EXPECT_EQ(bench.device->calibrationStep(), "Press it home.");
    EXPECT_FALSE(bench.device->calibrate());
    bench.device.reset();
    EXPECT_EQ(bench.strings.stops, 1);
    (void)bench.health->read();  // it outlives the device
}

TEST(GuardedDevice, neitherTickNorServoAllocatesOrWaits) {
    if (!test::RealtimeTrap::isActive()) GTEST_SKIP() << "the sanitizers own malloc: the trap is off";
    Bench bench;
    bench.health->place({});
    const test::RealtimeTrap trap;
    bench.run(300, Vec3(0, 1, 0), Vec3(1, 0, 0));
    bench.strings.reading.positionMm[2] = std::nan("");
    bench.run(20, Vec3(0, 1, 0));
    bench.strings.reading.positionMm[2] = 0.0;
    bench.strings.reading.buttons = 4;
    bench.run(300);
    bench.strings.reading.buttons = 0;
    bench.run(100);
    EXPECT_EQ(trap.total(), 0u);
}

/// Hangs in its own servo thread when it is told to, as a vendor's library may.
class Hanging final : public link::Driver {
  public:
    struct Shared {
        std::atomic<bool> hangs{false}, ends{false};
        std::atomic<int> relaxed{0}, frames{0};
    };
    explicit Hanging(Shared& shared) : shared_(shared) {}
    ~Hanging() override { stop(); }
    [[nodiscard]] const link::DriverInfo& info() const noexcept override { return info_; }
    void start(link::Servo& servo) override {
        thread_ = std::thread([this, &servo] {
            DriverReading reading;
            while (!shared_.ends) {
                std::this_thread::sleep_for(std::chrono::microseconds(500));
                if (shared_.hangs) continue;
                reading.timeNs = rt::monotonicNs();
                ++reading.frame;
                (void)servo.exchange(reading);
                ++shared_.frames;
            }
        });
    }
    void stop() noexcept override {
        shared_.ends = true;
        if (thread_.joinable()) thread_.join();
    }
    void relax() noexcept override { ++shared_.relaxed; }

  private:
    Shared& shared_;
    link::DriverInfo info_;
    std::thread thread_;
};

TEST(GuardedDevice, theWatchdogsThreadSeesAServoThatHangs) {
    Hanging::Shared shared;
    GuardedDevice device(std::make_unique<Hanging>(shared), {});
    ASSERT_TRUE(await([&] { return shared.frames > 5; }));
    shared.hangs = true;
    const int before = shared.relaxed;
    ASSERT_TRUE(await([&] { return shared.relaxed > before || device.health()->read().relaxed > 0; }));
    ASSERT_TRUE(await([&] { return device.health()->read().gate.trouble == DeviceFault::stalled; }));
    const int frames = shared.frames;
    shared.hangs = false;
    ASSERT_TRUE(await([&] { return shared.frames > frames + 5; }));
    EXPECT_GT(shared.relaxed, 0);
}

TEST(SimulatedDriver, itsHandMeetsTheToothAsTheMotionSays) {
    std::mt19937_64 random(test::seed());
    for (const double scale : {1.0, 2.0, 3.0}) {
        workspace::WorkspaceMapping placing;
        placing.scale = scale;
        placing.leftHanded = scale == 2.0;
        placing.deviceMm = 50.0 * test::randomDirection(random);
        placing.toothMm = 5.0 * test::randomDirection(random);
        placing.toothInDevice = test::randomRotation(random);
        placing.tipFromStylusMm = 20.0 * test::randomDirection(random);
        const core::Pose from{Vec3(0, 0, 12), test::randomRotation(random)};
        const core::Pose to{Vec3(3, -2, 9), test::randomRotation(random)};
        drivers::SimulatedSettings settings;
        settings.arm.rigidHand = true;
        settings.motion = device::Motion({{0.0, from, 0.0}, {1.0, to, 1.0}});
        settings.placing = placing;
        settings.stepped = true;
        settings.servoHz = 2000.0;
        GuardSettings guard;
        guard.placing = placing;
        guard.shaping.passivityController = guard.shaping.thermalBudget = false;  // a force that no tooth answers for
        auto driver = std::make_unique<drivers::SimulatedDriver>(settings);
        drivers::SimulatedDriver* servo = driver.get();
        guard.nowNs = [servo] { return servo->nowNs(); };
        guard.advance = [servo](double periodS) { servo->step(periodS); };
        GuardedDevice device(std::move(driver), guard);
        const device::Motion motion({{0.0, from, 0.0}, {1.0, to, 1.0}});
        for (int ms = 1; ms < 900; ++ms) {
            const device::Reading reading = device.read(0.001);
            device.command(Vec3(0, 0, 1), Vec3::Zero());
            if (ms < 100) continue;
            ASSERT_EQ(reading.status, device::ReadStatus::ok);
            const device::TimedPose wanted = motion.at(0.001 * ms - 0.0005);  // the first frame is at no time
            EXPECT_LT((reading.burInTooth.positionMm - wanted.burInTooth.positionMm).norm(), 1e-9);
            EXPECT_LT(reading.burInTooth.orientation.angularDistance(wanted.burInTooth.orientation), 1e-7);
            EXPECT_NEAR(reading.pedal, wanted.pedal, 1e-6);
        }
        EXPECT_LT((servo->appliedForceN() - Vec3(0, 0, 1)).norm(), 1e-9);
        EXPECT_EQ(device.health()->read().frames, 2u * 899u);
    }
}

TEST(SimulatedDriver, runsOnTheWallClock) {
    auto driver = drivers::openSimulated({});
    EXPECT_EQ(driver->info().driver, "simulated");
    EXPECT_THROW((void)drivers::openSimulated({"no such arm", 0.0}), core::Error);
    EXPECT_THROW((void)drivers::openSimulated({"", 1e9}), core::Error);
    EXPECT_EQ(drivers::openSimulated({"touch-x", 2000.0})->info().capability.maxForceN, 7.9);
    GuardSettings patient;  // with a machine that is busy
    patient.gate.readingTimeoutS = patient.gate.commandTimeoutS = patient.readingTimeoutS = 0.9;
    GuardedDevice device(std::move(driver), patient);
    ASSERT_TRUE(await([&] {
        device::Reading reading = device.read(0.001);
        device.command(Vec3::Zero(), Vec3::Zero());
        return reading.status == device::ReadStatus::ok;
    }));
    EXPECT_GT(device.truePositionMm().z(), 20.0);
}

}  // namespace
}  // namespace handpiece::safety::guarded_device_test
