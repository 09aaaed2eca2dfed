// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>

#include "devices/drivers/conformance.h"
#include "devices/drivers/spacemouse_daemon.h"
#include "handpiece/devices/drivers/spacemouse.h"
#include "support/random.h"

namespace handpiece::drivers {
namespace {

class SpaceMouseAdaptor final : public Adaptor {
  public:
    ~SpaceMouseAdaptor() override { ::unsetenv("HANDPIECE_SPNAV_SOCKET"); }
    [[nodiscard]] Traits traits() const override {
        Traits t;
        t.driver = "spacemouse";
        t.absolute = t.force = t.exclusive = false;
        t.buttons = 4;
        t.devices = 1;
        t.workMm = core::Vec3(1, 1, 1);  // the cap pushed home
        return t;
    }
    void reset() override {
        pressed_ = 0;
        daemon_.reset();
        daemon_ = std::make_unique<test::SpaceMouseDaemon>((folder_.path() / "spnav.sock").string());
        ::setenv("HANDPIECE_SPNAV_SOCKET", (folder_.path() / "spnav.sock").c_str(), 1);
    }
    [[nodiscard]] std::unique_ptr<link::Driver> open(int) override { return openSpaceMouse({}); }
    void move(int, const core::Pose& push) override {
        const Eigen::AngleAxisd turn(push.orientation);
        const core::Vec3 r = turn.angle() * turn.axis();
        const auto counts = [](double share) { return static_cast<int>(std::lround(350.0 * share)); };
        daemon_->motion({counts(push.positionMm.x()), counts(push.positionMm.y()), counts(-push.positionMm.z()),
                         counts(r.x()), counts(r.y()), counts(-r.z())});
        if (push.positionMm.isZero()) {
            EXPECT_TRUE(daemon_->settle()) << "the driver does not ask any more";
        }
    }
    void press(int, std::uint32_t buttons) override {
        for (int bit = 0; bit < 32; ++bit)
            if (((buttons ^ pressed_) >> bit) & 1u) daemon_->button(bit, ((buttons >> bit) & 1u) != 0);
        pressed_ = buttons;
    }
    [[nodiscard]] Arrived arrived(int) override { return {}; }
    void unplug(int) override { daemon_->plug(false); }
    void stall(int, double seconds) override { daemon_->stall(seconds); }
    [[nodiscard]] std::vector<VendorError> errors() const override {
        return {{"killed", 0, true, link::DeviceFault::unplugged}};
    }
    void raise(int, const VendorError&) override { daemon_.reset(); }
    [[nodiscard]] unsigned breaches() override { return daemon_ ? daemon_->breaches() : 0; }
    [[nodiscard]] std::string lastBreach() override { return daemon_ ? daemon_->lastBreach() : ""; }

  private:
    test::TemporaryFolder folder_;
    std::unique_ptr<test::SpaceMouseDaemon> daemon_;
    std::uint32_t pressed_ = 0;
};

std::unique_ptr<Adaptor> makeSpaceMouse() {
    return std::make_unique<SpaceMouseAdaptor>();
}

INSTANTIATE_TEST_SUITE_P(SpaceMouse, Conformance, testing::Values(&makeSpaceMouse), nameOfAdaptor);

}  // namespace
}  // namespace handpiece::drivers
