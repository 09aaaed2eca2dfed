// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>

#include "devices/drivers/conformance.h"
#include "devices/drivers/haply_service.h"
#include "handpiece/devices/drivers/haply.h"

namespace handpiece::drivers {
namespace {

using core::Vec3;

/// Turns our device frame into the service's with its own arithmetic: a quarter turn about x.
class HaplyAdaptor final : public Adaptor {
  public:
    ~HaplyAdaptor() override { ::unsetenv("HANDPIECE_HAPLY_URL"); }
    [[nodiscard]] Traits traits() const override {
        Traits t;
        t.driver = "haply";
        t.buttons = 3;
        t.calibrates = true;
        t.workMm = Vec3(80, 80, 80);
        return t;
    }
    void reset() override {
        service_ = std::make_unique<test::HaplyService>(2);
        ::setenv("HANDPIECE_HAPLY_URL", service_->url().c_str(), 1);
    }
    [[nodiscard]] std::unique_ptr<link::Driver> open(int device) override {
        return openHaply({service_->arm(device).id, 0.0});
    }
    void move(int device, const core::Pose& stylus) override {
        const core::Quat turn(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitX()));
        const Vec3 p = turn * stylus.positionMm / 1e3;
        // The grip's own axes are turned like the service's against ours.
        const core::Quat q = turn * stylus.orientation * turn.conjugate();
        service_->change(device, [&](test::SimulatedArm& arm) {
            arm.positionM = {p.x(), p.y(), p.z()};
            arm.grip = {q.w(), q.x(), q.y(), q.z()};
        });
    }
    void press(int device, std::uint32_t buttons) override {
        service_->change(device, [&](test::SimulatedArm& arm) { arm.buttons = buttons; });
    }
    [[nodiscard]] Arrived arrived(int device) override {
        const test::SimulatedArm arm = service_->arm(device);
        const core::Quat back(Eigen::AngleAxisd(-M_PI / 2, Vec3::UnitX()));
        Arrived a;
        const Vec3 f(arm.forceN[0], arm.forceN[1], arm.forceN[2]);
        a.forceN = f.isZero(0.0) ? Vec3(Vec3::Zero()) : Vec3(back * f);
        a.count = arm.count;
        return a;
    }
    void unplug(int device) override {
        service_->change(device, [](test::SimulatedArm& arm) { arm.gone = true; });
    }
    void stall(int, double seconds) override { service_->stall(seconds); }
    [[nodiscard]] std::vector<VendorError> errors() const override {
        return {{"no power", kHaplyNoPower, true, link::DeviceFault::vendorError},
                {"not ready", kHaplyNotReady, true, link::DeviceFault::vendorError},
                {"garbage", 0, true, link::DeviceFault::badData},
                {"grip asleep", 0, true, link::DeviceFault::inputLost},
                {"killed", 0, true, link::DeviceFault::unplugged}};
    }
    void raise(int device, const VendorError& error) override {
        if (error.name == "garbage") return service_->say(R"({"inverse3":[{"device_id":)");
        if (error.name == "killed") return service_->kill();
        service_->change(device, [&](test::SimulatedArm& arm) {
            arm.powered = error.name != "no power";
            arm.ready = error.name != "not ready";
            arm.gripGone = error.name == "grip asleep";
        });
    }
    void uncalibrate(int device) override {
        service_->change(device, [](test::SimulatedArm& arm) { arm.calibrated = false; });
    }
    void finishCalibration(int device) override {
        service_->change(device, [](test::SimulatedArm& arm) { arm.calibrated = true; });
    }
    [[nodiscard]] unsigned breaches() override { return service_->breaches(); }
    [[nodiscard]] std::string lastBreach() override { return service_->lastBreach(); }

  private:
    std::unique_ptr<test::HaplyService> service_;
};

std::unique_ptr<Adaptor> makeHaply() {
    return std::make_unique<HaplyAdaptor>();
}

INSTANTIATE_TEST_SUITE_P(Haply, Conformance, testing::Values(&makeHaply), nameOfAdaptor);

}  // namespace
}  // namespace handpiece::drivers
