// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/input/device_opening.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>

#include "handpiece/devices/drivers/simulated_driver.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::input::device_opening_test {
namespace {

using core::Quat;
using core::Vec3;

ToothPlace molar(int fdi = 36, int buccal = 1) {
    ToothPlace tooth;
    tooth.box.extend({-5.0, -4.0, -12.0});
    tooth.box.extend({6.0, 5.0, 7.0});
    tooth.fdiNumber = fdi;
    tooth.buccalSign = buccal;
    return tooth;
}

link::DriverReading at(const Vec3& p) {
    link::DriverReading r;
    r.positionMm = {p.x(), p.y(), p.z()};
    return r;
}

TEST(DeviceDesk, listsEveryDriverOnceAndTheSimulatedArmAlways) {
    const std::vector<drivers::Found> found = lookForDevices();
    std::set<std::string> names;
    for (const drivers::Found& f : found) {
        EXPECT_TRUE(names.insert(f.driver).second) << f.driver;
        EXPECT_FALSE(f.makes.empty()) << f.driver;
        // What is not there says why and what to do.
        EXPECT_TRUE(f.available || (!f.why.empty() && !f.remedy.empty())) << f.driver;
    }
    for (const std::string& name : deviceNames())
        EXPECT_EQ(names.count(name), 1u) << name;
    EXPECT_TRUE(found.back().driver == "simulated" && found.back().available);
}

TEST(DeviceDesk, aToothLiesOcclusalUpWithTheHandleWhereTheHandComesFrom) {
    for (const bool left : {false, true})
        for (const int fdi : {11, 36, 46, 0})
            for (const int buccal : {-1, 0, 1}) {
                const ToothPlace tooth = molar(fdi, buccal);
                const Quat turn = toothTurnFor(tooth, left);
                EXPECT_LT((turn * Vec3::UnitZ() - Vec3::UnitY()).norm(), 1e-12);
                // Held with its tail to the right and the front, buttons up, the bur stands in the tooth with its
                // handle about where the pointer's has it.
                workspace::Profile profile;
                profile.placing.leftHanded = left;
                profile.placing.headAngleDeg = 90.0;
                const workspace::WorkspaceTransform mapping(placingFor(profile, tooth));
                const Vec3 from = Vec3(left ? -1.0 : 1.0, 0.0, 1.0).normalized();
                link::DriverReading reading = at(Vec3::Zero());
                core::Mat3 stylus;
                stylus << Vec3::UnitY().cross(from), Vec3::UnitY(), from;
                const Quat q(stylus);
                reading.orientation = {q.w(), q.x(), q.y(), q.z()};
                const core::Pose bur = mapping.burInTooth(reading);
                EXPECT_LT((bur.orientation * Vec3::UnitZ() - Vec3::UnitZ()).norm(), 1e-9);
                // startPose()'s turn about the long axis: to mesial and a little to the cheek, or to the lips.
                const bool front = fdi > 0 && fdi % 10 <= 3;
                const double want = (buccal < 0 ? -1.0 : 1.0) * (front ? 90.0 : 20.0);
                const Vec3 handle = bur.orientation * Vec3::UnitX();
                EXPECT_NEAR(std::atan2(handle.y(), handle.x()) * 180.0 / 3.14159265358979, want, 1e-6);
            }
}

TEST(DeviceDesk, theMiddleOfTheTopLiesAtTheProfilesPoint) {
    workspace::Profile profile;
    profile.placing.deviceMm = {10.0, -20.0, 30.0};
    const workspace::WorkspaceTransform mapping(placingFor(profile, molar()));
    EXPECT_LT((mapping.burInTooth(at({10.0, -20.0, 30.0})).positionMm - Vec3(0.5, 0.5, 7.0)).norm(), 1e-9);
    // Up is up, whatever the hand.
    EXPECT_NEAR(mapping.burInTooth(at({10.0, -19.0, 30.0})).positionMm.z(), 8.0, 1e-9);
    // Without a tooth the profile's place is left alone.
    EXPECT_EQ(placingFor(profile, {}).deviceMm, profile.placing.deviceMm);
    EXPECT_EQ(placingFor(profile, {}).toothMm, Vec3(Vec3::Zero()));
}

TEST(DeviceDesk, namesThatThereAreNotAreTold) {
    DeviceChoice choice;
    choice.name = "phantom";
    EXPECT_NE(test::errorOf([&] { (void)openDevice(choice); }).find("openhaptics"), std::string::npos);
    choice.name = "simulated";
    choice.faults = "unplug@";
    EXPECT_NE(test::errorOf([&] { (void)openDevice(choice); }).find("faults"), std::string::npos);
    choice.faults.clear();
    choice.scale = 4.0;
    EXPECT_NE(test::errorOf([&] { (void)openDevice(choice); }).find("scale"), std::string::npos);
}

TEST(DeviceDesk, overridesComeOverTheKeptProfile) {
    const test::TemporaryFolder folder;
    DeviceChoice choice;
    choice.profileFolder = folder.path();
    const link::DriverInfo info = openDriver(choice)->info();
    workspace::Profile kept = workspace::defaultProfile(info);
    kept.placing.scale = 2.0;
    kept.placing.leftHanded = true;
    kept.shaping.passivityController = false;
    workspace::writeProfile(folder.path(), kept);
    EXPECT_EQ(profileOf(choice, info).placing.scale, 2.0);
    EXPECT_TRUE(profileOf(choice, info).placing.leftHanded);
    EXPECT_FALSE(profileOf(choice, info).shaping.passivityController);
    choice.scale = 3.0;
    choice.leftHanded = false;
    choice.passivityController = true;
    EXPECT_EQ(profileOf(choice, info).placing.scale, 3.0);
    EXPECT_FALSE(profileOf(choice, info).placing.leftHanded);
    EXPECT_TRUE(profileOf(choice, info).shaping.passivityController);
    choice = {};
    choice.profileFolder = folder.path();
    choice.keptProfile = false;
    EXPECT_EQ(profileOf(choice, info).placing.scale, 1.0);
    link::DriverInfo other = info;
    other.model = "another";
    choice.profile = workspace::profileFile(folder.path(), info);
    EXPECT_NE(test::errorOf([&] { (void)profileOf(choice, other); }).find("another device"), std::string::npos);
}

/// The simulated arm in virtual time, held still above the tooth.
OpenDevice stepped(DeviceChoice& choice, drivers::SimulatedSettings settings = {}) {
    const core::Pose held{{0.0, 0.0, 30.0}, Quat::Identity()};
    settings.motion = device::Motion({{0.0, held, 0.0}, {1.0, held, 0.0}});
    settings.stepped = true;
    auto driver = std::make_unique<drivers::SimulatedDriver>(settings);
    drivers::SimulatedDriver* servo = driver.get();
    choice.nowNs = [servo] { return servo->nowNs(); };
    choice.advance = [servo](double periodS) { servo->step(periodS); };
    choice.keptProfile = false;
    return openDevice(std::move(driver), choice);
}

TEST(DeviceDesk, faultsAreInjectedAndTold) {
    DeviceChoice choice;
    choice.faults = "unplug@0.8:0.1";
    OpenDevice open = stepped(choice);
    ASSERT_EQ(open.faults.size(), 1u);
    std::optional<core::Error> seen;
    for (int i = 0; i < 1500; ++i) {
        (void)open.device->read(0.001);
        open.device->command(Vec3(0.0, 0.0, 0.5), Vec3::Zero());
        if (const auto trouble = troubleOf(open.health->read().gate, open.info); trouble && !seen) seen = trouble;
    }
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->id(), "unplugged");
    EXPECT_EQ(seen->where(), open.info.model);
    EXPECT_FALSE(seen->remedy().empty());
    EXPECT_FALSE(troubleOf(open.health->read().gate, open.info));
    open.device.reset();
    const auto outcomes = open.faultLog->outcomes();
    ASSERT_EQ(outcomes.size(), 1u);
    EXPECT_GT(outcomes[0].forceBeforeN, 0.4);
    EXPECT_GE(outcomes[0].toZeroS, 0.0);
    EXPECT_LE(outcomes[0].toZeroS, 0.010);
    EXPECT_TRUE(outcomes[0].told);
}

TEST(DeviceDesk, sharesAndScaleReachTheForceModel) {
    const test::TemporaryFolder folder;
    DeviceChoice choice;
    choice.profileFolder = folder.path();
    choice.scale = 2.0;
    const device::Capability record = device::Capability{};
    const OpenDevice open = stepped(choice);
    EXPECT_NEAR(open.capability.maxStiffnessNPerMm, 2.0 * record.maxStiffnessNPerMm, 1e-12);
    EXPECT_NEAR(open.capability.maxForceN, record.maxForceN, 1e-12);
    EXPECT_EQ(open.device->capability().maxStiffnessNPerMm, open.capability.maxStiffnessNPerMm);
    // Without torque axes the grip stays where the force model has it; with them it is the stylus.
    const force::Parameters plain = force::defaultParameters();
    EXPECT_EQ(fittedTo(open, plain).gripMm, plain.gripMm);
    DeviceChoice other;
    drivers::SimulatedSettings arm;
    arm.arm.capability.maxTorqueNmm = 188.0;
    EXPECT_LT(fittedTo(stepped(other, arm), plain).gripMm.norm(), 1e-12);
}

TEST(DeviceDesk, theSimulatedArmThatIsMeasuredHoldsStill) {
    const auto driver = openDriver({});
    EXPECT_EQ(driver->info().driver, "simulated");
    DeviceChoice named;
    named.which = "touch";
    EXPECT_EQ(openDriver(named)->info().model, "touch");
    named.which = "nothing-of-the-kind";
    EXPECT_FALSE(test::errorOf([&] { (void)openDriver(named); }).empty());
}

}  // namespace
}  // namespace handpiece::input::device_opening_test
