// SPDX-License-Identifier: Apache-2.0
#include <dlfcn.h>

#include <cstdlib>

#include "devices/drivers/conformance.h"
#include "devices/drivers/double_dhd.h"
#include "handpiece/devices/drivers/force_dimension.h"

namespace handpiece::drivers {
namespace {

using doubles::DhdArm;
using doubles::DhdDouble;

const DhdArm kSigma{104, "sigma.7", 1701, true, true, false}, kOmega{34, "omega.6", 1702, true, false, false},
    kFalcon{60, "Falcon", 65535, false, false, false};

/// The hand's frame is turned by axes' names, not by the driver's matrices: right is their y, up their z, to the user
/// their x.
class ForceDimensionAdaptor : public Adaptor {
  public:
    explicit ForceDimensionAdaptor(const char* path, std::vector<DhdArm> arms) : path_(path), arms_(std::move(arms)) {
        void* file = dlopen(path, RTLD_LAZY | RTLD_GLOBAL);
        if (!file) throw std::runtime_error(dlerror());
        double_ = reinterpret_cast<DhdDouble* (*)()>(dlsym(file, "doubleDhd"))();
    }
    Traits traits() const override {
        Traits t;
        t.driver = "forcedimension";
        t.orientation = arms_[0].wrist;
        t.torque = arms_[0].activeWrist;
        t.calibrates = true;
        return t;
    }
    void reset() override {
        setenv("HANDPIECE_DHD_LIBRARY", path_, 1);
        EXPECT_TRUE(double_->reset(arms_)) << "a device stayed open";
    }
    std::unique_ptr<link::Driver> open(int device) override { return openForceDimension(options(device)); }
    void move(int device, const core::Pose& stylus) override {
        const core::Vec3& p = stylus.positionMm;
        const double metres[3] = {p.z() / 1000, p.x() / 1000, p.y() / 1000};
        // The stylus' tail is the handle's x, its side the handle's y, what looks up the handle's z.
        const core::Vec3 axes[3] = {stylus.orientation * core::Vec3::UnitZ(), stylus.orientation * core::Vec3::UnitX(),
                                    stylus.orientation * core::Vec3::UnitY()};
        double frame[3][3];
        for (int axis = 0; axis < 3; ++axis) {
            frame[0][axis] = axes[axis].z();
            frame[1][axis] = axes[axis].x();
            frame[2][axis] = axes[axis].y();
        }
        double_->move(device, metres, frame);
    }
    void press(int device, std::uint32_t buttons) override { double_->press(device, buttons); }
    Arrived arrived(int device) override {
        const doubles::DhdSent sent = double_->sent(device);
        Arrived a;
        if (sent.motorsOn) {
            a.forceN = {sent.forceN[1], sent.forceN[2], sent.forceN[0]};
            a.torqueNmm = 1000.0 * core::Vec3(sent.torqueNm[1], sent.torqueNm[2], sent.torqueNm[0]);
        }
        a.count = sent.count;
        return a;
    }
    void unplug(int device) override { double_->unplug(device); }
    void stall(int device, double seconds) override { double_->stall(device, seconds); }
    std::vector<VendorError> errors() const override {
        using link::DeviceFault;
        return {{"unnamed", 1, true, DeviceFault::vendorError},
                {"communication", 2, true, DeviceFault::unplugged},
                {"controller busy", 3, true, DeviceFault::vendorError},
                {"no device", 5, true, DeviceFault::unplugged},
                {"time out", 7, true, DeviceFault::unplugged},
                {"geometry", 8, true, DeviceFault::vendorError},
                {"not ready", 12, true, DeviceFault::vendorError},
                {"encoders disagree", 18, true, DeviceFault::vendorError},
                {"not enabled", 19, true, DeviceFault::vendorError},
                {"in use", 20, true, DeviceFault::vendorError}};
    }
    void raise(int device, const VendorError& error) override { double_->raise(device, error.code); }
    void uncalibrate(int device) override { double_->initialise(device, false); }
    void finishCalibration(int device) override { double_->initialise(device, true); }
    unsigned breaches() override { return double_->breaches(); }
    std::string lastBreach() override { return double_->lastBreach(); }

  protected:
    [[nodiscard]] OpenOptions options(int device) const {
        OpenOptions o;
        o.which = std::to_string(device + 1);
        o.servoHz = 1000;  // what the tests say holds at any rate; this one leaves the machine to others
        return o;
    }

  private:
    const char* path_;
    std::vector<DhdArm> arms_;
    DhdDouble* double_;
};

/// A Falcon as the same library tells it.
class FalconDhdAdaptor final : public ForceDimensionAdaptor {
  public:
    FalconDhdAdaptor() : ForceDimensionAdaptor(HANDPIECE_DOUBLE_DHD, {kFalcon, kFalcon}) {}
    Traits traits() const override {
        Traits t = ForceDimensionAdaptor::traits();
        t.driver = "falcon";
        t.buttons = 4;
        return t;
    }
    std::unique_ptr<link::Driver> open(int device) override { return openFalconThroughDhd(options(device)); }
};

std::unique_ptr<Adaptor> makeSigmaAndOmega() {
    return std::make_unique<ForceDimensionAdaptor>(HANDPIECE_DOUBLE_DHD, std::vector{kSigma, kOmega});
}
std::unique_ptr<Adaptor> makeOmegas() {
    return std::make_unique<ForceDimensionAdaptor>(HANDPIECE_DOUBLE_DHD_PLAIN, std::vector{kOmega, kOmega});
}
std::unique_ptr<Adaptor> makeFalcons() {
    return std::make_unique<FalconDhdAdaptor>();
}

INSTANTIATE_TEST_SUITE_P(ForceDimension, Conformance, testing::Values(&makeSigmaAndOmega), nameOfAdaptor);
INSTANTIATE_TEST_SUITE_P(ForceDimensionPlain, Conformance, testing::Values(&makeOmegas), nameOfAdaptor);
INSTANTIATE_TEST_SUITE_P(FalconDhd, Conformance, testing::Values(&makeFalcons), nameOfAdaptor);

}  // namespace
}  // namespace handpiece::drivers
