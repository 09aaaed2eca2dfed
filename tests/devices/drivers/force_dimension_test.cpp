// SPDX-License-Identifier: Apache-2.0
// What is Force Dimension's own: frames and units, records by type, calibration, the controller's own switches, what
// its library refuses, and a library that never comes back.
#include "handpiece/devices/drivers/force_dimension.h"

#include <dlfcn.h>

#include <cstdlib>
#include <set>

#include "devices/drivers/conformance.h"
#include "devices/drivers/double_dhd.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/devices/drivers/force_dimension_library.h"
#include "handpiece/devices/drivers/servo_thread.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::drivers::force_dimension_test {
namespace {

using core::Vec3;
using doubles::DhdArm;
using doubles::DhdDouble;
using link::CalibrationState;
using link::DeviceFault;
using test::errorOf;

std::string idOf(const std::function<void()>& work) {
    try {
        work();
    } catch (const core::Error& e) {
        return e.id();
    }
    return {};
}

DhdDouble& doubleAt(const char* path) {
    void* file = dlopen(path, RTLD_LAZY | RTLD_GLOBAL);
    if (!file) throw std::runtime_error(dlerror());
    return *reinterpret_cast<DhdDouble* (*)()>(dlsym(file, "doubleDhd"))();
}

const DhdArm kOmega6{34, "omega.6", 1702, true, false, false}, kSigma7{104, "sigma.7", 1701, true, true, false},
    kOmega3{33, "omega.3", 1703, false, false, false};

class ForceDimension : public testing::Test {
  protected:
    void SetUp() override { use({kSigma7, kOmega6}); }
    void use(const std::vector<DhdArm>& arms, const char* path = HANDPIECE_DOUBLE_DHD) {
        setenv("HANDPIECE_DHD_LIBRARY", path, 1);
        arm = &doubleAt(path);
        ASSERT_TRUE(arm->reset(arms));
    }
    static OpenOptions called(const std::string& which) {
        OpenOptions options;
        options.which = which;
        options.servoHz = 1000;
        return options;
    }
    std::unique_ptr<link::Driver> started(Probe& probe, const std::string& which = {}) {
        auto driver = openForceDimension(called(which));
        driver->start(probe);
        EXPECT_TRUE(await([&] { return probe.count() > 2; }));
        return driver;
    }
    DhdDouble* arm = nullptr;
};

TEST(ForceDimensionFrames, metresTowardsTheUserAreMillimetresOfZ) {
    EXPECT_EQ(positionFromDhd({0.001, 0.002, 0.003}), (std::array<double, 3>{2, 3, 1}));
    EXPECT_EQ(vectorToDhd({2, 3, 1}), (std::array<double, 3>{1, 2, 3}));
}

TEST(ForceDimensionFrames, aTurnKeepsItsAxisAndAngle) {
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 200; ++i) {
        // About an axis of theirs by an angle: about the same axis by ours, whatever the numbers are called.
        const Vec3 axis = test::randomDirection(generator);
        const double angle = test::uniform(generator, -3.0, 3.0);
        const core::Mat3 theirs = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
        double frame[3][3];
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column)
                frame[row][column] = theirs(row, column);
        std::array<double, 4> q{};
        ASSERT_TRUE(orientationFromDhd(frame, q));
        const core::Quat expected(Eigen::AngleAxisd(angle, Vec3(axis.y(), axis.z(), axis.x())));
        EXPECT_LT(core::Quat(q[0], q[1], q[2], q[3]).angularDistance(expected), 1e-7);
    }
    std::array<double, 4> untouched{9, 9, 9, 9};
    const double mirrored[3][3] = {{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, scaled[3][3] = {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}},
                 none[3][3] = {{NAN, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    EXPECT_FALSE(orientationFromDhd(mirrored, untouched));
    EXPECT_FALSE(orientationFromDhd(scaled, untouched));
    EXPECT_FALSE(orientationFromDhd(none, untouched));
    EXPECT_EQ(untouched[0], 9);
}

TEST_F(ForceDimension, theRecordFollowsTheTypeOfTheArm) {
    struct Expected {
        DhdArm made;
        double forceN, stiffness, damping, workspaceMm, torqueNmm;
        int sensed, driven;
    };
    for (const Expected& e :
         {Expected{kOmega3, 12, 5, 0.03, 150, 0, 3, 3}, Expected{kOmega6, 12, 5, 0.03, 150, 0, 6, 3},
          Expected{{37, "omega.7", 1, true, false, true}, 12, 5, 0.03, 150, 0, 6, 3},
          Expected{{63, "delta.3", 2, false, false, false}, 20, 5, 0.03, 300, 0, 3, 3},
          Expected{{64, "delta.6", 2, true, false, false}, 20, 5, 0.03, 300, 0, 6, 3},
          Expected{kSigma7, 12, 4, 0.03, 150, 200, 6, 6},
          Expected{{108, "lambda.7", 3, true, true, false}, 12, 8, 0.03, 225, 200, 6, 6},
          Expected{{60, "Falcon", 65535, false, false, false}, 8, 3, 0.02, 80, 0, 3, 3},
          // A type that came after this was written is driven as the weakest arm there is.
          Expected{{222, "omicron.9", 4, true, true, false}, 3.3, 0.5, 0.005, 160, 0, 6, 3}}) {
        use({e.made});
        const auto driver = openForceDimension({});
        const link::DriverInfo& info = driver->info();
        SCOPED_TRACE(e.made.name);
        EXPECT_EQ(info.model, e.made.name);
        EXPECT_EQ(info.capability.name, e.made.name);
        EXPECT_EQ(info.serial, e.made.type == 60 ? "" : std::to_string(e.made.serial));
        EXPECT_EQ(info.hasOrientation, e.made.wrist);
        EXPECT_EQ(info.capability.maxForceN, e.forceN);
        EXPECT_EQ(info.capability.maxStiffnessNPerMm, e.stiffness);
        EXPECT_EQ(info.capability.maxDampingNSPerMm, e.damping);
        EXPECT_EQ(info.capability.workspaceMm.x(), e.workspaceMm);
        EXPECT_EQ(info.capability.maxTorqueNmm, e.torqueNmm);
        EXPECT_EQ(info.capability.sensedAxes, e.sensed);
        EXPECT_EQ(info.capability.drivenAxes, e.driven);
        EXPECT_EQ(info.version.find("left-handed") != std::string::npos, e.made.leftHanded);
        EXPECT_NE(info.version.find("libdrd.so 3.17.6, controller 3.50"), std::string::npos) << info.version;
        EXPECT_NE(info.sources.find("unchecked"), std::string::npos);
    }
}

TEST_F(ForceDimension, aDeviceIsNamedBySerialModelOrNumber) {
    EXPECT_EQ(openForceDimension({})->info().model, "sigma.7");
    EXPECT_EQ(openForceDimension(called("1702"))->info().model, "omega.6");
    EXPECT_EQ(openForceDimension(called("omega.6"))->info().serial, "1702");
    EXPECT_EQ(openForceDimension(called("2"))->info().serial, "1702");
    const std::string none = errorOf([&] { (void)openForceDimension(called("4711")); });
    EXPECT_NE(none.find("device 1: sigma.7 1701, device 2: omega.6 1702"), std::string::npos) << none;
    // The first that is free; a look opens none of them.
    const auto first = openForceDimension({}), second = openForceDimension({});
    EXPECT_EQ(second->info().model, "omega.6");
    const Found found = lookForceDimension();
    EXPECT_FALSE(found.available);
    EXPECT_EQ(found.models.size(), 2u);
    EXPECT_FALSE(found.why.empty());
    EXPECT_FALSE(found.triedOnHardware);
    EXPECT_EQ(idOf([] { (void)openForceDimension({}); }), "device-busy");
    EXPECT_EQ(arm->breaches(), 0u) << arm->lastBreach();
}

TEST_F(ForceDimension, whatTheLibraryRefusesIsToldWithARemedy) {
    setenv("HANDPIECE_DHD_LIBRARY", "no/such/libdrd.so", 1);
    std::string said = errorOf([] { (void)openForceDimension({}); });
    EXPECT_NE(said.find("no/such/libdrd.so"), std::string::npos) << said;
    EXPECT_NE(said.find("Install the Force Dimension SDK"), std::string::npos) << said;
    EXPECT_EQ(idOf([] { (void)openForceDimension({}); }), "library-missing");
    EXPECT_FALSE(lookForceDimension().available);
    EXPECT_NE(lookForceDimension().remedy.find("HANDPIECE_DHD_LIBRARY"), std::string::npos);
    setenv("HANDPIECE_DHD_LIBRARY", HANDPIECE_DOUBLE_DHD_OLD, 1);
    said = errorOf([] { (void)openForceDimension({}); });
    EXPECT_NE(said.find("has no function dhdGetDeviceCount"), std::string::npos) << said;
    EXPECT_EQ(idOf([] { (void)openForceDimension({}); }), "library-wrong");

    use({kOmega3});
    arm->takenElsewhere(0);
    said = errorOf([] { (void)openForceDimension({}); });
    EXPECT_NE(said.find("Another program uses the device"), std::string::npos) << said;
    EXPECT_NE(said.find("Close that program"), std::string::npos) << said;
    EXPECT_EQ(idOf([] { (void)openForceDimension({}); }), "device-busy");
    use({kOmega3});
    for (const auto& [code, id] : {std::pair{3, "device-busy"}, {4, "device-missing"}, {2, "device-error"}}) {
        arm->failNext("open", code);
        EXPECT_EQ(idOf([] { (void)openForceDimension({}); }), id) << code;
    }
    arm->failNext("dhdEnableForce", 12);
    auto driver = openForceDimension({});
    Probe probe;
    said = errorOf([&] { driver->start(probe); });
    EXPECT_NE(said.find("not ready"), std::string::npos) << said;
    EXPECT_EQ(probe.count(), 0u);
    driver->stop();
    use({});
    EXPECT_EQ(idOf([] { (void)openForceDimension({}); }), "device-missing");
    EXPECT_FALSE(lookForceDimension().available);
}

TEST_F(ForceDimension, everyCodeHasASentenceAndARemedyOfItsOwn) {
    std::set<std::string> sentences;
    for (int code = 1; code <= 21; ++code)
        sentences.insert(dhdErrorInWords(code).substr(0, dhdErrorInWords(code).find(" (DHD")));
    for (int code = 101; code <= 106; ++code)
        sentences.insert(dhdErrorInWords(code).substr(0, dhdErrorInWords(code).find(" (DHD")));
    EXPECT_EQ(sentences.size(), 27u);
    for (const int code : {-3, 0x7fffffff})
        EXPECT_NE(dhdErrorInWords(code).find(std::to_string(code)), std::string::npos);
}

TEST_F(ForceDimension, theArmCalibratesItselfWithoutAForceOfOurs) {
    arm->initialise(0, false);
    Probe probe;
    auto driver = started(probe);
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::notCalibrated; }));
    EXPECT_EQ(driver->calibration(), CalibrationState::wanted);
    EXPECT_NE(driver->calibrationStep().find("hands off"), std::string::npos);
    arm->failNext("drdAutoInit", 8);
    EXPECT_NE(errorOf([&] { (void)driver->calibrate(); }).find("cannot be computed"), std::string::npos);
    EXPECT_EQ(driver->calibration(), CalibrationState::wanted);
    EXPECT_TRUE(driver->calibrate());
    EXPECT_EQ(driver->calibration(), CalibrationState::good);
    probe.push({0, 0, 1});
    EXPECT_TRUE(await([&] { return arm->sent(0).motorsOn && arm->sent(0).forceN[0] > 0.9; })) << "force is on again";
    driver->stop();
    EXPECT_EQ(arm->breaches(), 0u) << arm->lastBreach();
}

TEST_F(ForceDimension, withoutTheAutomaticOneThePersonCalibrates) {
    use({kOmega3}, HANDPIECE_DOUBLE_DHD_PLAIN);
    arm->initialise(0, false);
    Probe probe;
    auto driver = started(probe);
    EXPECT_EQ(driver->calibration(), CalibrationState::wantedByHand);
    EXPECT_NE(driver->calibrationStep().find("calibration pole"), std::string::npos);
    EXPECT_FALSE(driver->calibrate());
    EXPECT_EQ(probe.last().trouble, DeviceFault::notCalibrated);
    arm->initialise(0, true);
    EXPECT_TRUE(await([&] { return driver->calibrate() && probe.last().trouble == DeviceFault::none; }));
}

TEST_F(ForceDimension, whyTheControllerLetGoIsTold) {
    Probe probe;
    auto driver = started(probe);
    arm->forceOff(0, 6);
    EXPECT_TRUE(
        await([&] { return probe.last().trouble == DeviceFault::inputLost && probe.last().vendorCode == 106; }));
    arm->forceOff(0, 1);
    EXPECT_TRUE(
        await([&] { return probe.last().trouble == DeviceFault::vendorError && probe.last().vendorCode == 101; }));
    EXPECT_FALSE(arm->sent(0).motorsOn) << "the button is the person's";
    // It moved too fast: it comes back by itself, and the gate fades the force in.
    arm->forceOff(0, 2);
    EXPECT_TRUE(await([&] { return probe.last().vendorCode == 102; }));
    EXPECT_TRUE(await([&] { return arm->sent(0).motorsOn && probe.last().trouble == DeviceFault::none; }));
    arm->failNext("dhdSetForce", 7);
    arm->failNext("dhdSetForceAndTorqueAndGripperForce", 7);
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::vendorError && probe.last().vendorCode == 7; }))
        << "a force that could not be sent";
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::none; }));
}

TEST_F(ForceDimension, theHandInsideGivesWayToTheForce) {
    use({kOmega3});
    arm->swing(0, 0.1, 200.0, 0.0, 1.0);
    Probe probe;
    auto driver = started(probe);
    // 1 N on a spring of 200 N/m: 5 mm, whichever way it is pushed.
    for (int axis = 0; axis < 3; ++axis) {
        probe.push(Vec3::Unit(axis));
        EXPECT_TRUE(await([&] {
            const auto& p = probe.last().positionMm;
            return (Vec3(p[0], p[1], p[2]) - 5.0 * Vec3::Unit(axis)).norm() < 0.05;
        })) << "axis "
            << axis;
    }
    driver->stop();
    use({kOmega3});
    // Round its circle of 10 mm, twice a second, in the plane across the view.
    arm->swing(0, 0.1, 2000.0, 0.01, 2.0);
    Probe another;
    auto again = started(another);
    double most[3] = {};
    EXPECT_TRUE(await([&] {
        for (std::size_t i = 0; i < 3; ++i)
            most[i] = std::max(most[i], std::abs(another.last().positionMm[i]));
        return most[0] > 9 && most[1] > 9;
    }));
    EXPECT_LT(most[2], 1e-6);
}

TEST_F(ForceDimension, aLibraryThatHangsIsLeftBehind) {
    Probe probe;
    auto driver = started(probe);
    probe.push({0, 1, 0});
    EXPECT_TRUE(await([&] { return arm->sent(0).forceN[2] > 0.9; }));
    arm->stall(0, 30.0);
    // Until its thread stands in a call, not in the pause between two.
    EXPECT_TRUE(await([&] { return rt::monotonicNs() - probe.last().timeNs > 50'000'000; }));
    // The watchdog asks for the motors to be switched off and does not wait for it.
    std::int64_t then = rt::monotonicNs();
    driver->relax();
    driver->relax();
    EXPECT_LT(rt::monotonicNs() - then, 500'000'000);
    then = rt::monotonicNs();
    driver->stop();
    EXPECT_LT(rt::monotonicNs() - then, 2'000'000'000);
    const std::uint64_t count = probe.count();
    driver.reset();
    EXPECT_EQ(idOf([&] { (void)openForceDimension(called("1")); }), "device-busy") << "its thread still has it";
    // It comes back: no exchange any more, no force, closed by the thread that was left behind.
    EXPECT_TRUE(arm->reset({kSigma7, kOmega6}));
    EXPECT_EQ(probe.count(), count);
    EXPECT_TRUE(await([&] { return errorOf([&] { (void)openForceDimension(called("1")); }).empty(); }));
}

TEST_F(ForceDimension, motorsThatWereRelaxedComeOnAgain) {
    Probe probe;
    auto driver = started(probe);
    driver->relax();
    EXPECT_TRUE(await([&] { return probe.count() > 3 && arm->sent(0).motorsOn; }));
    probe.push({0, 1, 0});
    EXPECT_TRUE(await([&] { return arm->sent(0).motorsOn && arm->sent(0).forceN[2] > 0.9; }));
    driver->stop();
    EXPECT_FALSE(arm->sent(0).motorsOn);
}

TEST(ServoThread, keepsToItsRangeAndShutsItsDoor) {
    EXPECT_NE(errorOf([] {
                  ServoThread(
                      0.5, [] {}, [] {});
              }),
              "");
    EXPECT_NE(errorOf([] {
                  ServoThread(
                      NAN, [] {}, [] {});
              }),
              "");
    Probe probe;
    ServoPort door(probe);
    link::DriverReading reading;
    (void)door.exchange(reading);
    door.shut();
    door.shut();
    (void)door.exchange(reading);
    EXPECT_EQ(probe.count(), 1u);
    EXPECT_TRUE(withPatience(std::chrono::seconds(20), [] {}));
    auto go = std::make_shared<std::promise<void>>();
    EXPECT_FALSE(withPatience(std::chrono::milliseconds(1), [go] { go->get_future().wait(); }));
    go->set_value();
}

}  // namespace
}  // namespace handpiece::drivers::force_dimension_test
