// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "devices/drivers/conformance.h"
#include "devices/drivers/gamepad_virtual.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/devices/drivers/pedal.h"
#include "support/error_of.h"

namespace handpiece::drivers::pedal_test {
namespace {

using test::errorOf;
using testing::HasSubstr;

class Pedal : public testing::Test {
  protected:
    void SetUp() override {
        std::string why;
        if (!test::hasVirtualJoysticks(why)) GTEST_SKIP() << why;
        if (!pedals().empty()) GTEST_SKIP() << "a joystick of this machine would be meant";
    }
    [[nodiscard]] static bool reaches(const FootPedal& pedal, double value) {
        return await([&] { return std::abs(pedal.value()->read(rt::monotonicNs()) - value) < 0.01; });
    }
};

TEST(PedalArithmetic, deadTravelAndDirection) {
    EXPECT_EQ(pedalOf(-32768, false, 0.05), 0.0);
    EXPECT_EQ(pedalOf(32767, false, 0.05), 1.0);
    EXPECT_EQ(pedalOf(-32768, true, 0.05), 1.0);
    EXPECT_EQ(pedalOf(32767, true, 0.05), 0.0);
    EXPECT_EQ(pedalOf(-31000, false, 0.05), 0.0) << "within the dead travel";
    EXPECT_EQ(pedalOf(31000, false, 0.05), 1.0) << "and at the other end";
    EXPECT_NEAR(pedalOf(0, false, 0.2), 0.5, 1e-4);
    for (int raw = -32768; raw < 32767; raw += 97)
        EXPECT_LE(pedalOf(raw, false, 0.1), pedalOf(raw + 1, false, 0.1));
}

TEST(PedalValue, isNoneWhenOldOrNoNumber) {
    link::PedalValue value;
    EXPECT_EQ(value.read(5), 0.0f) << "never written";
    value.write(0.7f, 1000);
    EXPECT_EQ(value.read(1000), 0.7f);
    EXPECT_EQ(value.read(1000 + link::PedalValue::kKeepsNs), 0.0f) << "its reader stands";
    value.write(std::numeric_limits<float>::quiet_NaN(), 2000);
    EXPECT_EQ(value.read(2000), 0.0f);
    value.write(7.0f, 3000);
    EXPECT_EQ(value.read(3000), 1.0f);
}

TEST_F(Pedal, whatIsMissingIsToldWithItsRemedy) {
    EXPECT_THAT(errorOf([] { FootPedal pedal({}); }), HasSubstr("no pedal is connected"));
    test::VirtualJoystick pad("Double Pad", true), joystick("Double Foot Pedal", false, 2, 1);
    EXPECT_THAT(errorOf([] { FootPedal pedal({"Organ"}); }), HasSubstr("Organ"));
    EXPECT_THAT(errorOf([] { FootPedal pedal({"Foot", 2}); }), HasSubstr("2 axes and 1 button"));
    EXPECT_THAT(errorOf([] { FootPedal pedal({"Foot", 0, 1}); }), HasSubstr("no button 1"));
    EXPECT_THAT(errorOf([] { FootPedal pedal({"Foot", 0, -1, false, 0.5}); }), HasSubstr("dead travel"));
    EXPECT_EQ(FootPedal({}).name(), "Double Foot Pedal") << "a gamepad is not taken for a pedal";
    bool found = false;
    for (const PedalFound& one : pedals())
        found = found || (one.name == "Double Foot Pedal" && one.axes == 2 && one.buttons == 1);
    EXPECT_TRUE(found);
}

TEST_F(Pedal, followsItsAxisOnceItHasBeenUp) {
    test::VirtualJoystick joystick("Double Foot Pedal", false, 2, 1);
    joystick.axis(1, 0.3);
    FootPedal pedal({"Foot", 1});
    EXPECT_TRUE(joystick.settle());
    EXPECT_EQ(pedal.value()->read(rt::monotonicNs()), 0.0f) << "pressed when it was opened: not meant";
    joystick.axis(1, -1.0);
    EXPECT_TRUE(joystick.settle());
    joystick.axis(1, 1.0);
    EXPECT_TRUE(reaches(pedal, 1.0));
    joystick.axis(1, 0.0);
    EXPECT_TRUE(reaches(pedal, 0.5));
}

TEST_F(Pedal, aLostOneIsUpAndCountsAgainOnceItHasBeen) {
    test::VirtualJoystick joystick("Double Foot Pedal", false, 1, 1);
    joystick.axis(0, 1.0);
    FootPedal pedal({"Foot", 0, -1, true});
    EXPECT_TRUE(joystick.settle());
    joystick.axis(0, -1.0);
    EXPECT_TRUE(reaches(pedal, 1.0)) << "it rests at the far end";
    joystick.unplug();
    EXPECT_TRUE(reaches(pedal, 0.0));
    EXPECT_TRUE(await([&] { return !pedal.attached(); }));
    joystick.plug();
    joystick.axis(0, -1.0);
    EXPECT_TRUE(await([&] { return pedal.attached(); }));
    EXPECT_TRUE(joystick.settle());
    EXPECT_EQ(pedal.value()->read(rt::monotonicNs()), 0.0f) << "still held down";
    joystick.axis(0, 1.0);
    EXPECT_TRUE(joystick.settle());
    joystick.axis(0, -1.0);
    EXPECT_TRUE(reaches(pedal, 1.0));
}

TEST_F(Pedal, aSwitchIsUpOrDown) {
    test::VirtualJoystick joystick("Double Foot Switch", false, 0, 3);
    std::shared_ptr<const link::PedalValue> value;
    {
        const FootPedal pedal({"Switch", 0, 2});
        EXPECT_TRUE(joystick.settle());
        joystick.button(2, true);
        EXPECT_TRUE(reaches(pedal, 1.0));
        value = pedal.value();
    }
    EXPECT_TRUE(await([&] { return value->read(rt::monotonicNs()) == 0.0f; })) << "nobody reads it any more";
}

}  // namespace
}  // namespace handpiece::drivers::pedal_test
