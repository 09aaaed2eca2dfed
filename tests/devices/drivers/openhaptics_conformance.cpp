// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>

#include "devices/drivers/conformance.h"
#include "devices/drivers/openhaptics_double.h"
#include "handpiece/devices/drivers/openhaptics.h"

namespace handpiece::drivers {

const HdDouble& hdDouble() {
    static const HdDouble one = [] {
        setenv("HANDPIECE_HD_LIBRARY", HANDPIECE_DOUBLE_HD, 1);
        const link::SharedLibrary shared("the double of the HD library", {HANDPIECE_DOUBLE_HD}, "", "build double_hd");
        HdDouble d;
        shared.require(d.reset, "double_reset");
        shared.require(d.move, "double_move");
        shared.require(d.sprung, "double_sprung");
        shared.require(d.press, "double_press");
        shared.require(d.force, "double_force");
        shared.require(d.unplug, "double_unplug");
        shared.require(d.stall, "double_stall");
        shared.require(d.wake, "double_wake");
        shared.require(d.error, "double_error");
        shared.require(d.calibration, "double_calibration");
        shared.require(d.switches, "double_switches");
        shared.require(d.temperature, "double_temperature");
        shared.require(d.initError, "double_init_error");
        shared.require(d.kill, "double_kill");
        shared.require(d.breaches, "double_breaches");
        shared.require(d.lastBreach, "double_last_breach");
        return d;
    }();
    return one;
}

namespace {

using link::DeviceFault;

class OpenHapticsAdaptor : public Adaptor {
  public:
    explicit OpenHapticsAdaptor(const char* model) : model_(model) {}

    [[nodiscard]] Traits traits() const override {
        Traits t;
        t.driver = "openhaptics";
        t.stepMm = 1e-9;
        t.angleRad = 1e-7;
        t.forceStepN = 1e-9;
        t.buttons = 4;
        t.calibrates = true;
        return t;
    }
    void reset() override { hd_.reset(2, model_); }
    [[nodiscard]] std::unique_ptr<link::Driver> open(int device) override {
        return openOpenHaptics({device == 0 ? "" : "Second Device", 0.0});
    }
    // HD's frame is ours, its millimetres and newtons too.
    void move(int device, const core::Pose& pose) override { hd_.place(device, pose); }
    void press(int device, std::uint32_t buttons) override { hd_.press(device, buttons); }
    [[nodiscard]] Arrived arrived(int device) override {
        double out[6] = {};
        Arrived a;
        a.count = hd_.force(device, out);
        a.forceN = {out[0], out[1], out[2]};
        a.torqueNmm = {out[3], out[4], out[5]};
        return a;
    }
    void unplug(int device) override { hd_.unplug(device); }
    void stall(int device, double seconds) override { hd_.stall(device, seconds); }
    [[nodiscard]] std::vector<VendorError> errors() const override {
        const DeviceFault vendor = DeviceFault::vendorError, none = DeviceFault::none;
        return {
            {"INVALID_ENUM", 0x0100, false, none},
            {"INVALID_VALUE", 0x0101, false, none},
            {"INVALID_OPERATION", 0x0102, true, vendor},
            {"INVALID_INPUT_TYPE", 0x0103, false, none},
            {"BAD_HANDLE", 0x0104, true, vendor},
            {"WARM_MOTORS", 0x0200, false, none},
            {"EXCEEDED_MAX_FORCE", 0x0201, false, none},
            {"EXCEEDED_FORCE_IMPULSE", 0x0202, false, none},
            {"EXCEEDED_VELOCITY", 0x0203, false, none},
            {"FORCE_ERROR", 0x0204, false, none},
            {"DEVICE_FAULT", 0x0300, true, vendor},
            {"ALREADY_INITIATED", 0x0301, true, vendor},
            {"COMM_ERROR", 0x0302, true, DeviceFault::unplugged},
            {"COMM_CONFIG_ERROR", 0x0303, true, vendor},
            {"TIMER_ERROR", 0x0304, true, vendor},
            {"ILLEGAL_BEGIN", 0x0400, true, vendor},
            {"ILLEGAL_END", 0x0401, true, vendor},
            {"FRAME_ERROR", 0x0402, true, vendor},
            {"INVALID_PRIORITY", 0x0500, true, vendor},
            {"SCHEDULER_FULL", 0x0501, true, vendor},
            {"INVALID_LICENSE", 0x0600, true, vendor},
            {"a code nobody knows", 0x0999, true, vendor},
        };
    }
    /// In every frame; the odd ones at its end.
    void raise(int device, const VendorError& error) override {
        hd_.error(device, static_cast<unsigned>(error.code), error.code & 1, -1);
    }
    void uncalibrate(int device) override { hd_.calibration(device, 4, 0x5002); }
    void finishCalibration(int device) override { hd_.calibration(device, 4, 0x5001); }
    [[nodiscard]] unsigned breaches() override { return hd_.breaches(); }
    [[nodiscard]] std::string lastBreach() override { return hd_.lastBreach(); }

  private:
    const HdDouble& hd_ = hdDouble();
    const char* model_;
};

class PremiumAdaptor final : public OpenHapticsAdaptor {
  public:
    PremiumAdaptor() : OpenHapticsAdaptor("PHANTOM Premium 1.5 6DOF") {}
    [[nodiscard]] Traits traits() const override {
        Traits t = OpenHapticsAdaptor::traits();
        t.torque = true;
        t.torqueStepNmm = 1e-6;
        return t;
    }
};

std::unique_ptr<Adaptor> makeTouch() {
    return std::make_unique<OpenHapticsAdaptor>("Touch");
}
std::unique_ptr<Adaptor> makePremium() {
    return std::make_unique<PremiumAdaptor>();
}

}  // namespace

INSTANTIATE_TEST_SUITE_P(OpenHapticsTouch, Conformance, testing::Values(&makeTouch), nameOfAdaptor);
INSTANTIATE_TEST_SUITE_P(OpenHapticsPremium, Conformance, testing::Values(&makePremium), nameOfAdaptor);

}  // namespace handpiece::drivers
