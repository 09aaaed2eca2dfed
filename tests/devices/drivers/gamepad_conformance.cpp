// SPDX-License-Identifier: Apache-2.0
#include "devices/drivers/conformance.h"
#include "devices/drivers/gamepad_virtual.h"
#include "handpiece/devices/drivers/gamepad.h"
#include "handpiece/devices/drivers/sdl_library.h"

namespace handpiece::drivers {
namespace {

using Sdl = SdlLibrary;

class GamepadAdaptor final : public Adaptor {
  public:
    [[nodiscard]] Traits traits() const override {
        Traits t;
        t.driver = "gamepad";
        t.absolute = t.force = t.exclusive = false;
        t.buttons = 3;
        t.workMm = core::Vec3(1, 1, 1);  // the stick pushed home
        return t;
    }
    void reset() override {
        std::string why;
        if (!test::hasVirtualJoysticks(why)) GTEST_SKIP() << why;
        pads_[0].reset();
        pads_[1].reset();
        pads_[0] = std::make_unique<test::VirtualJoystick>("Double Pad One", true);
        pads_[1] = std::make_unique<test::VirtualJoystick>("Double Pad Two", true);
    }
    [[nodiscard]] std::unique_ptr<link::Driver> open(int device) override {
        return openGamepad({device == 0 ? "Double Pad One" : "Double Pad Two", 0.0});
    }
    void move(int device, const core::Pose& push) override {
        test::VirtualJoystick& pad = *pads_.at(static_cast<std::size_t>(device));
        const Eigen::AngleAxisd turn(push.orientation);
        const core::Vec3 r = turn.angle() * turn.axis();
        pad.axis(Sdl::kLeftX, push.positionMm.x());
        pad.axis(Sdl::kLeftY, push.positionMm.z());
        pad.axis(Sdl::kLeftTrigger, std::max(0.0, -push.positionMm.y()) * 2.0 - 1.0);
        pad.button(Sdl::kLeftShoulder, push.positionMm.y() > 0.0);
        pad.axis(Sdl::kRightY, r.x());
        pad.axis(Sdl::kRightX, -r.z());
        if (push.positionMm.isZero()) {
            EXPECT_TRUE(pad.settle()) << "nobody reads the pad any more";
        }
    }
    void press(int device, std::uint32_t buttons) override {
        test::VirtualJoystick& pad = *pads_.at(static_cast<std::size_t>(device));
        pad.button(Sdl::kA, (buttons & 1) != 0);
        pad.button(Sdl::kB, (buttons & 2) != 0);
        pad.button(Sdl::kRightShoulder, (buttons & 4) != 0);
    }
    [[nodiscard]] Arrived arrived(int) override { return {}; }
    void unplug(int device) override { pads_.at(static_cast<std::size_t>(device))->unplug(); }
    void stall(int device, double seconds) override {
#ifdef HANDPIECE_SANITIZED
        seconds = std::min(seconds, 0.5);  // a thread that is left behind is a leak to the thread sanitizer
#endif
        pads_.at(static_cast<std::size_t>(device))->stall(seconds);
    }

  private:
    std::array<std::unique_ptr<test::VirtualJoystick>, 2> pads_;
};

std::unique_ptr<Adaptor> makeGamepad() {
    return std::make_unique<GamepadAdaptor>();
}

INSTANTIATE_TEST_SUITE_P(Gamepad, Conformance, testing::Values(&makeGamepad), nameOfAdaptor);

}  // namespace
}  // namespace handpiece::drivers
