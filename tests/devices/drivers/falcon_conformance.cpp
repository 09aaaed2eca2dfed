// SPDX-License-Identifier: Apache-2.0
#include <dlfcn.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "devices/drivers/conformance.h"
#include "devices/drivers/double_usb.h"
#include "devices/drivers/falcon_arm.h"
#include "handpiece/devices/drivers/falcon.h"

namespace handpiece::drivers {
namespace {

using doubles::UsbDouble;

class FalconAdaptor final : public Adaptor {
  public:
    FalconAdaptor() {
        void* file = dlopen(HANDPIECE_DOUBLE_USB, RTLD_LAZY | RTLD_GLOBAL);
        if (!file) throw std::runtime_error(dlerror());
        double_ = reinterpret_cast<UsbDouble* (*)()>(dlsym(file, "doubleUsb"))();
    }
    Traits traits() const override {
        Traits t;
        t.driver = "falcon";
        t.orientation = false;
        t.calibrates = true;
        t.buttons = 4;
        t.stepMm = 0.04;      // an encoder's step is 0.038 mm at the end of its crank
        t.forceStepN = 0.01;  // a motor's step is 0.1 N mm
        return t;
    }
    void reset() override {
        setenv("HANDPIECE_LIBUSB_LIBRARY", HANDPIECE_DOUBLE_USB, 1);
        setenv("HANDPIECE_DHD_LIBRARY", "there-is-none", 1);
        EXPECT_TRUE(double_->reset({{"F1"}, {"F2"}})) << "a device stayed open";
        for (int device = 0; device < 2; ++device)
            move(device, {});
    }
    std::unique_ptr<link::Driver> open(int device) override {
        OpenOptions options;
        options.which = device == 0 ? "F1" : "F2";
        return openFalcon(options);
    }
    void move(int device, const core::Pose& stylus) override {
        place_[device] = stylus.positionMm + core::Vec3(0, 0, 120);
        std::array<int, 3> counts{};
        for (int arm = 0; arm < 3; ++arm)
            counts[static_cast<std::size_t>(arm)] =
                static_cast<int>(std::lround(test::countAt(test::crankAt(arm, place_[device]))));
        double_->encoders(device, counts);
    }
    void press(int device, std::uint32_t buttons) override { double_->press(device, buttons); }
    Arrived arrived(int device) override {
        const doubles::FalconSent sent = double_->sent(device);
        Arrived a;
        a.count = sent.count;
        for (int axis = 0; axis < 3; ++axis) {
            // A force is the work of the motors on a little way along the axis, over that way.
            const double h = 1e-3;
            double work = 0;
            for (int arm = 0; arm < 3; ++arm) {
                const double turn = test::crankAt(arm, place_[device] + h * core::Vec3::Unit(axis)) -
                                    test::crankAt(arm, place_[device] - h * core::Vec3::Unit(axis));
                work += -0.1 * sent.motors[static_cast<std::size_t>(arm)] * turn;
            }
            a.forceN[axis] = work / (2 * h);
        }
        return a;
    }
    void unplug(int device) override { double_->unplug(device); }
    void stall(int device, double seconds) override { double_->stall(device, seconds); }
    std::vector<VendorError> errors() const override {
        using link::DeviceFault;
        return {{"input/output", -1, true, DeviceFault::unplugged},
                {"no device", -4, true, DeviceFault::unplugged},
                {"time out", -7, true, DeviceFault::stalled},
                {"pipe", -9, true, DeviceFault::vendorError},
                {"overflow", -8, true, DeviceFault::vendorError},
                {"letters that are none", 0, true, DeviceFault::badData}};
    }
    void raise(int device, const VendorError& error) override {
        if (error.code == 0)
            double_->garble(device, true);
        else
            double_->raise(device, error.code);
    }
    void uncalibrate(int device) override { double_->home(device, 3); }
    void finishCalibration(int device) override { double_->home(device, 7); }
    unsigned breaches() override { return double_->breaches(); }
    std::string lastBreach() override { return double_->lastBreach(); }

  private:
    UsbDouble* double_;
    core::Vec3 place_[2];
};

std::unique_ptr<Adaptor> makeFalcon() {
    return std::make_unique<FalconAdaptor>();
}

INSTANTIATE_TEST_SUITE_P(FalconUsb, Conformance, testing::Values(&makeFalcon), nameOfAdaptor);

}  // namespace
}  // namespace handpiece::drivers
