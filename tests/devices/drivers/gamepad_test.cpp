// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "devices/drivers/conformance.h"
#include "devices/drivers/gamepad_virtual.h"
#include "handpiece/devices/drivers/gamepad.h"
#include "handpiece/devices/drivers/pedal.h"
#include "handpiece/devices/drivers/sdl_library.h"
#include "support/error_of.h"

namespace handpiece::drivers::gamepad_test {
namespace {

using link::DeviceFault;
using test::errorOf;
using testing::HasSubstr;
using Sdl = SdlLibrary;

class Gamepad : public testing::Test {
  protected:
    void SetUp() override {
        std::string why;
        if (!test::hasVirtualJoysticks(why)) GTEST_SKIP() << why;
        if (!pedals().empty()) GTEST_SKIP() << "a joystick of this machine would be meant";
    }
    [[nodiscard]] static std::unique_ptr<link::Driver> streaming(link::Servo& servo) {
        auto driver = openGamepad({});
        driver->start(servo);
        return driver;
    }
};

/// Answers with the same command each time.
struct Shaking final : link::Servo {
    std::atomic<float> vibration{0.0f};
    std::atomic<double> forceN{0.0};
    link::DriverCommand exchange(const link::DriverReading&) noexcept override {
        link::DriverCommand command;
        command.vibration = vibration;
        command.forceN = {0, forceN, 0};
        return command;
    }
};

TEST_F(Gamepad, whatIsMissingIsToldWithItsRemedy) {
    EXPECT_THAT(errorOf([] { (void)openGamepad({}); }), HasSubstr("no gamepad is connected"));
    EXPECT_FALSE(lookGamepad().available);
    const test::VirtualJoystick stick("Double Stick", false, 3, 4);
    EXPECT_FALSE(lookGamepad().available) << "a joystick is no gamepad";
    test::VirtualJoystick pad("Double Pad", true), other("Other Pad", true);
    const Found found = lookGamepad();
    EXPECT_TRUE(found.available);
    EXPECT_THAT(found.models, testing::ElementsAre("Double Pad", "Other Pad"));
    EXPECT_THAT(errorOf([] { (void)openGamepad({"Third Pad", 0.0}); }), HasSubstr("Third Pad"));
    EXPECT_THAT(errorOf([] { (void)openGamepad({"#3", 0.0}); }), HasSubstr("#3"));
    EXPECT_THAT(errorOf([] { (void)openGamepad({"", 1e9}); }), HasSubstr("rate"));
    EXPECT_EQ(openGamepad({"#2", 0.0})->info().model, "Other Pad");
    EXPECT_EQ(openGamepad({"Other", 0.0})->info().model, "Other Pad");
    EXPECT_EQ(openGamepad({})->info().model, "Double Pad");
}

TEST_F(Gamepad, theRightTriggerIsThePedal) {
    test::VirtualJoystick pad("Double Pad", true);
    Probe probe;
    auto driver = streaming(probe);
    EXPECT_TRUE(await([&] { return probe.last().pedal == 0.0f; })) << "at rest";
    pad.axis(Sdl::kRightTrigger, 1.0);
    EXPECT_TRUE(await([&] { return probe.last().pedal == 1.0f; }));
    pad.axis(Sdl::kRightTrigger, 0.0);
    EXPECT_TRUE(await([&] { return std::abs(probe.last().pedal - 0.5f) < 0.05f; }));
    pad.axis(Sdl::kRightTrigger, -1.0);
    EXPECT_TRUE(await([&] { return probe.last().pedal == 0.0f; }));
    pad.button(Sdl::kA, true);
    EXPECT_TRUE(await([&] { return probe.last().pedal == 1.0f && probe.last().buttons == 1; }));
}

TEST_F(Gamepad, aTiltOfTheRightStickTiltsTheHandle) {
    test::VirtualJoystick pad("Double Pad", true);
    Probe probe;
    auto driver = streaming(probe);
    pad.axis(Sdl::kRightX, 1.0);
    EXPECT_TRUE(await([&] { return probe.last().orientation[0] < 0.99; }));
    const auto q = probe.last().orientation;
    const core::Quat turn(q[0], q[1], q[2], q[3]);
    EXPECT_GT((turn * core::Vec3::UnitY()).x(), 0.05) << "what was up leans to the right";
    pad.axis(Sdl::kRightX, 0.0);
    pad.button(Sdl::kY, true);
    EXPECT_TRUE(await([&] { return probe.last().orientation[0] == 1.0; })) << "home";
}

TEST_F(Gamepad, itShakesWithVibrationAndForceAndNeverAfterStop) {
    test::VirtualJoystick pad("Double Pad", true);
    Shaking servo;
    auto driver = streaming(servo);
    EXPECT_TRUE(pad.settle());
    EXPECT_EQ(pad.rumbles(), 0u) << "nothing asked for";
    servo.vibration = 0.5f;
    EXPECT_TRUE(await([&] { return std::abs(pad.rumble()[0] - 32768) < 4; }));
    servo.vibration = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(await([&] { return pad.rumble()[0] == 0; }));
    servo.vibration = 1e9f;
    EXPECT_TRUE(await([&] { return pad.rumble()[0] == 65535; }));
    servo.vibration = 0.0f;
    servo.forceN = 3.3;
    EXPECT_TRUE(await([&] { return pad.rumble()[0] == 65535; }));
    driver->stop();
    EXPECT_EQ(pad.rumble()[0], 0);
}

TEST_F(Gamepad, onePluggedInAgainGoesOn) {
    test::VirtualJoystick pad("Double Pad", true);
    Probe probe;
    auto driver = streaming(probe);
    pad.axis(Sdl::kRightTrigger, 1.0);
    EXPECT_TRUE(await([&] { return probe.last().pedal == 1.0f; }));
    pad.unplug();
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::unplugged; }));
    EXPECT_EQ(probe.last().pedal, 0.0f);
    test::VirtualJoystick other("Other Pad", true);
    EXPECT_TRUE(other.settle());
    EXPECT_EQ(probe.last().trouble, DeviceFault::unplugged) << "another pad is not this one";
    pad.plug();
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::none; }));
    EXPECT_EQ(probe.faultsOfOrder(), 0u);
}

TEST(SdlMissing, isToldWithItsRemedy) {
    // The library itself stays once it was loaded, so its loader is asked.
    EXPECT_THAT(errorOf([] { link::SharedLibrary("SDL 2", {"libSDL2-of-nowhere.so"}, "", "install SDL 2"); }),
                HasSubstr("install SDL 2"));
}

}  // namespace
}  // namespace handpiece::drivers::gamepad_test
