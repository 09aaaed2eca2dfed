// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/openhaptics_arm.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string_view>
#include <thread>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/devices/drivers/openhaptics.h"

namespace handpiece::drivers {
namespace {

using hd::Library;
using link::DeviceFault;

// ---- Records ---------------------------------------------------------------------------------------------------

struct Model {
    const char* part;  // of the vendor's name, lower case
    device::Capability capability;
    double frictionN, massKg;
};

// Force, stiffness, damping and workspace radius: the device table of CHAI3D 3.3. Continuous force, encoder step,
// workspace box of the Omni, friction, mass, all of the Touch X: recalled from data sheets, unchecked. Torque of the
// Premiums: CHAI3D's table. Continuous force that nobody told: a quarter of the peak, which is what the Omni's is.
Model model(const char* part, const char* name, double maxN, double continuousN, double stiffness, double damping,
            double stepMm, const core::Vec3& workspaceMm, double torqueNmm = 0.0) {
    device::Capability c;
    c.name = name;
    c.maxForceN = maxN;
    c.continuousForceN = continuousN;
    c.maxStiffnessNPerMm = stiffness;
    c.maxDampingNSPerMm = damping;
    c.encoderStepMm = stepMm;
    c.workspaceMm = workspaceMm;
    c.maxTorqueNmm = torqueNmm;
    const bool small = maxN <= 3.3;
    return {part, c, small ? 0.26 : 0.0, small ? 0.045 : 0.0};
}

/// The longest name first: "touch" is a part of "touch x".
const std::vector<Model>& models() {
    static const std::vector<Model> all{
        model("touch x", "touch-x", 7.9, 1.75, 1.0, 0.005, 0.023, {160, 120, 120}),
        model("touch", "touch", 3.3, 0.88, 0.4, 0.004, 0.055, {160, 120, 70}),
        model("omni", "omni", 3.3, 0.88, 0.7, 0.005, 0.055, {160, 120, 70}),
        model("desktop", "desktop", 7.9, 1.75, 1.0, 0.005, 0.023, {160, 120, 120}),
        model("premium 3.0", "premium-3.0", 22.0, 5.5, 1.0, 0.005, 0.023, {400, 400, 400}, 188.0),
        model("premium", "premium-1.5", 8.5, 2.1, 0.8, 0.005, 0.03, {190, 190, 190}, 188.0),
    };
    return all;
}

std::string lower(std::string_view text) {
    std::string out(text);
    for (char& c : out)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return out;
}

const Model& modelOf(std::string_view vendorsName) {
    const std::string name = lower(vendorsName);
    for (const Model& m : models())
        if (name.find(m.part) != std::string::npos) return m;
    return models()[1];  // the weakest arm there is: what is safe for it is safe for all
}

// ---- What it tells of itself ------------------------------------------------------------------------------------

/// Inside the library, with the device current: values it may or may not tell.
std::string text(const Library& hd, unsigned parameter) {
    const char* told = hd.getString(parameter);
    return hd.drain() == hd::kSuccess && told != nullptr ? told : "";
}
std::optional<int> integer(const Library& hd, unsigned parameter) {
    int value[8] = {};
    hd.getInteger(parameter, value);
    if (hd.drain() != hd::kSuccess) return {};
    return value[0];
}
/// Above zero and below `most`: a value outside is as good as none.
std::optional<double> number(const Library& hd, unsigned parameter, double most) {
    double value[8] = {};
    hd.getDouble(parameter, value);
    if (hd.drain() != hd::kSuccess || !std::isfinite(value[0]) || value[0] <= 0 || value[0] > most) return {};
    return value[0];
}

/// The manual gives mNm for reading and Nm for setting, and nobody here could try. As Nm a wrong guess is a thousand
/// times too weak; as mNm it would be a thousand times too strong.
double unitOfTorque() {
    const char* unit = std::getenv("HANDPIECE_HD_TORQUE_UNIT");
    return unit != nullptr && std::strcmp(unit, "mNm") == 0 ? 1.0 : 0.001;
}

}  // namespace

link::DriverInfo Arm::describe() {
    link::DriverInfo info;
    info.driver = "openhaptics";
    info.model = text(library, hd::kModel);
    if (info.model.empty()) info.model = "unknown model";
    info.serial = text(library, hd::kSerial);
    info.version = "HD " + text(library, hd::kVersion);
    if (const std::string driver = text(library, hd::kDriverVersion); !driver.empty())
        info.version += ", driver " + driver;
    if (const auto firmware = number(library, hd::kFirmware, 1e9))
        info.version += fmt::format(", firmware {:g}", *firmware);

    const Model& known = modelOf(info.model);
    device::Capability c = known.capability;
    std::string told;
    const auto tell = [&](const char* what) { told += (told.empty() ? "" : ", ") + std::string(what); };
    if (const auto v = number(library, hd::kNominalMaxForce, 100.0)) c.maxForceN = *v, tell("largest force");
    if (const auto v = number(library, hd::kNominalContinuousForce, c.maxForceN)) {
        c.continuousForceN = *v;
        tell("continuous force");
    }
    c.continuousForceN = std::min(c.continuousForceN, c.maxForceN);
    if (const auto v = number(library, hd::kNominalMaxStiffness, 100.0); v && *v < c.maxStiffnessNPerMm) {
        c.maxStiffnessNPerMm = *v;
        tell("stiffness");
    }
    double box[6] = {};
    library.getDouble(hd::kUsableWorkspace, box);
    if (library.drain() == hd::kSuccess) {
        const core::Vec3 size(box[3] - box[0], box[4] - box[1], box[5] - box[2]);
        if (size.allFinite() && size.minCoeff() > 1.0 && size.maxCoeff() < 5000.0)
            c.workspaceMm = size, tell("workspace");
    }
    c.sensedAxes = integer(library, hd::kInputAxes).value_or(6);
    c.drivenAxes = integer(library, hd::kOutputAxes).value_or(3);
    torque_ = c.drivenAxes >= 6 && c.maxTorqueNmm > 0;
    torquePerNmm_ = unitOfTorque();
    if (!torque_) c.maxTorqueNmm = 0.0;
    c.rateHz = integer(library, hd::kUpdateRate).value_or(1000);
    if (c.rateHz <= 0) c.rateHz = 1000;
    info.servoHz = c.rateHz;
    info.hasOrientation = c.sensedAxes >= 6;
    info.frictionN = known.frictionN;
    info.massKg = known.massKg;
    info.sources = fmt::format(
        "from the library: {}; force, stiffness and damping else: device table of CHAI3D 3.3; the rest recalled from "
        "data sheets, unchecked",
        told.empty() ? "nothing" : told);
    info.capability = c;
    style_ = integer(library, hd::kCalibrationStyle).value_or(0);
    return info;
}

device::Capability openHapticsCapability(std::string_view vendorsName) {
    return modelOf(vendorsName).capability;
}

// ---- Its servo --------------------------------------------------------------------------------------------------

void Arm::silence(std::chrono::milliseconds patience) noexcept {
    closing_.store(true);
    const std::int64_t end = rt::monotonicNs() + std::chrono::nanoseconds(patience).count();
    while (!silent_.load() && rt::monotonicNs() < end)
        std::this_thread::sleep_for(std::chrono::microseconds(200));
    if (door) door->shut();
}

void Arm::relax() noexcept {
    if (gone_.load()) return;
    library.makeCurrent(handle);
    library.disable(hd::kForceOutput);
    (void)library.drain();
    relaxed_.store(true);
}

bool Arm::calibrate(std::chrono::milliseconds patience, unsigned& error) noexcept {
    const std::uint32_t before = calibrated_.load();
    wanted_.store(true);
    const std::int64_t end = rt::monotonicNs() + std::chrono::nanoseconds(patience).count();
    while (calibrated_.load() == before) {
        if (rt::monotonicNs() > end) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    error = calibrationError_.load();
    return true;
}

unsigned Arm::tick() noexcept {
    if (gone_.load()) return hd::kDone;
    if (closing_.load()) {
        if (!silent_.load() || !dead_) sendNothing();
        silent_.store(true);
        return hd::kContinue;
    }
    reading_.timeNs = rt::monotonicNs();
    ++reading_.frame;
    if (dead_) {  // reading_ keeps trouble and code
        if (!lastZero_) sendNothing();
        lastZero_ = true;
        (void)door->exchange(reading_);
        return hd::kContinue;
    }
    reading_.trouble = DeviceFault::none;
    reading_.vendorCode = 0;
    library.makeCurrent(handle);
    library.beginFrame(handle);
    if (first_) {
        findOut();
        first_ = false;
    }
    readPose();
    readRest();
    calibration();
    note(pending_);
    pending_ = hd::kSuccess;
    note(library.drain());
    const link::DriverCommand command = door->exchange(reading_);
    if (relaxed_.exchange(false)) library.enable(hd::kForceOutput);
    send(reading_.trouble == DeviceFault::none ? command : link::DriverCommand{});
    library.endFrame(handle);
    // What the end of the frame tells belongs to the next one; what is fatal stops this device now.
    pending_ = library.drain();
    if (hd::wordsOf(pending_).weight == hd::Weight::fatal && pending_ != hd::kSuccess) note(pending_);
    return hd::kContinue;
}

void Arm::sendNothing() noexcept {
    library.makeCurrent(handle);
    library.beginFrame(handle);
    send({});
    library.endFrame(handle);
    (void)library.drain();
}

void Arm::note(unsigned code) noexcept {
    if (code == hd::kSuccess) return;
    const hd::ErrorWords& words = hd::wordsOf(code);
    reading_.vendorCode = static_cast<std::int32_t>(code);
    if (words.weight == hd::Weight::note) return;
    reading_.trouble = words.trouble;
    if (words.weight == hd::Weight::fatal) dead_ = true;
}

void Arm::findOut() noexcept {
    note(library.drain());
    double temperatures[8] = {};
    library.getDouble(hd::kMotorTemperature, temperatures);
    hasTemperature_ = library.drain() == hd::kSuccess;
    hd::Boolean on = 0;
    library.getBoolean(hd::kSafetySwitch, &on);
    hasSafetySwitch_ = library.drain() == hd::kSuccess;
    library.getBoolean(hd::kInkwellSwitch, &on);
    hasInkwellSwitch_ = library.drain() == hd::kSuccess;
}

void Arm::readPose() noexcept {
    double m[16] = {};  // column-major, millimetres: our frame already
    library.getDouble(hd::kTransform, m);
    for (const double v : m) {
        if (!std::isfinite(v)) {
            reading_.trouble = DeviceFault::notFinite;
            return;
        }
    }
    core::Mat3 turn;
    turn << m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10];
    if ((turn.transpose() * turn - core::Mat3::Identity()).cwiseAbs().maxCoeff() > 1e-3 || turn.determinant() <= 0) {
        reading_.trouble = DeviceFault::badData;
        return;
    }
    const core::Quat q = core::Quat(turn).normalized();
    reading_.positionMm = {m[12], m[13], m[14]};
    reading_.orientation = {q.w(), q.x(), q.y(), q.z()};
}

void Arm::readRest() noexcept {
    int buttons = 0;
    library.getInteger(hd::kButtons, &buttons);
    reading_.buttons = static_cast<std::uint32_t>(buttons) & 0xFu;
    if (hasTemperature_) {
        double hottest = 0.0, all[8] = {};
        library.getDouble(hd::kMotorTemperature, all);
        for (const double t : all)
            if (t > hottest) hottest = t;
        reading_.motorTemperature = static_cast<float>(hottest);
    }
    // Not every model that answers has the switch: only one that was seen in the good state counts.
    hd::Boolean on = 0;
    if (hasSafetySwitch_) {
        library.getBoolean(hd::kSafetySwitch, &on);
        seenHeld_ = seenHeld_ || on != 0;
        if (seenHeld_ && on == 0) mistrust(DeviceFault::inputLost);
    }
    if (hasInkwellSwitch_) {
        on = 0;
        library.getBoolean(hd::kInkwellSwitch, &on);
        seenOut_ = seenOut_ || on == 0;
        if (seenOut_ && on != 0) mistrust(DeviceFault::inputLost);
    }
}

void Arm::calibration() noexcept {
    const bool asked = wanted_.exchange(false);
    if (!asked && reading_.frame % 50 != 1) {
        if (answer_.load() != hd::kCalibrated) mistrust(DeviceFault::notCalibrated);
        return;
    }
    note(library.drain());
    unsigned answer = library.checkCalibration(), error = library.drain();
    const bool byItself = (style_ & hd::kAuto) != 0 && answer == hd::kNeedsUpdate;
    const bool byHand = asked && (answer == hd::kNeedsUpdate ||
                                  (answer == hd::kNeedsHand && (style_ & (hd::kInkwell | hd::kAuto)) == 0));
    if (error == hd::kSuccess && (byItself || byHand)) {
        // The pose jumps when its origin is found: this frame pushes nothing.
        mistrust(DeviceFault::notCalibrated);
        library.updateCalibration(static_cast<unsigned>((style_ & hd::kInkwell) != 0 ? hd::kInkwell
                                                        : (style_ & hd::kAuto) != 0  ? hd::kAuto
                                                                                     : hd::kEncoderReset));
        error = library.drain();
        answer = library.checkCalibration();
        if (error == hd::kSuccess) error = library.drain();
    }
    note(error);
    answer_.store(answer);
    if (answer != hd::kCalibrated) mistrust(DeviceFault::notCalibrated);
    if (asked) {
        calibrationError_.store(error);
        calibrated_.fetch_add(1);
    }
}

void Arm::mistrust(DeviceFault trouble) noexcept {
    if (reading_.trouble == DeviceFault::none) reading_.trouble = trouble;
}

void Arm::send(const link::DriverCommand& command) noexcept {
    library.setDouble(hd::kForce, command.forceN.data());
    if (!torque_) return;
    const double scaled[3] = {command.torqueNmm[0] * torquePerNmm_, command.torqueNmm[1] * torquePerNmm_,
                              command.torqueNmm[2] * torquePerNmm_};
    library.setDouble(hd::kTorque, scaled);
}

}  // namespace handpiece::drivers
