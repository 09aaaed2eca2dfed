// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/force_dimension_library.h"

#include <fmt/format.h>

#include <array>
#include <cstdlib>

#include "handpiece/base/core/error.h"

namespace handpiece::drivers::dhd {
namespace {

constexpr const char* kRemedy =
    "Install the Force Dimension SDK (forcedimension.com/software/sdk), or set HANDPIECE_DHD_LIBRARY to its libdrd.so";

constexpr std::array<Words, 22> kWords{{
    {"No error.", ""},
    {"The device's library reports an error it does not name.", "Switch the device off and on."},
    {"The device does not answer.", "Check its cable and power."},
    {"The device's controller is busy.", "Close other programs that use it."},
    {"The device's driver is not installed.", "Install the Force Dimension SDK with its driver."},
    {"No device is connected.", "Check its cable and power, then connect it again."},
    {"The device cannot do that.", "Update the Force Dimension SDK."},
    {"The device took too long to answer.", "Check its cable; plug it into another USB port."},
    {"The arm is where it cannot be computed.", "Move it to the middle of its workspace; calibrate it."},
    {"The library's expert functions are off.", "Report this: they are not used."},
    {"The device's library does not know that function.", "Update the Force Dimension SDK."},
    {"The device's library is out of memory.", "Close other programs."},
    {"The device is not ready.", "Wait until its status light is steady; calibrate it."},
    {"The device's library misses a file of its own.", "Install the Force Dimension SDK again."},
    {"The device's configuration cannot be read.", "Switch the device off and on; install the SDK again."},
    {"There is no device of that number.", "Check its cable and power, then connect it again."},
    {"The device's library no longer knows that function.", "Report this with the SDK's version."},
    {"A value was missing in a call.", "Report this with the SDK's version."},
    {"The arm's second encoders disagree.", "Switch the device off; have it serviced."},
    {"That function of the device is switched off.", "Switch the device off and on."},
    {"Another program uses the device.", "Close that program."},
    {"A value in a call was wrong.", "Report this with the SDK's version."},
}};
constexpr std::array<Words, 7> kForceOffWords{{
    {"The device's force is off.", "Press its force button."},
    {"The force was switched off at the device's button.", "Press its force button."},
    {"The device moved too fast and switched its force off.", "Hold it still for a moment."},
    {"The device heard nothing from the computer and switched its force off.", "Close other programs."},
    {"The force was switched off by a program.", "Connect the device again."},
    {"The device was unplugged.", "Plug it in and connect it again."},
    {"The device's dead-man switch is open.", "Take the stylus in the hand."},
}};

// Force, stiffness, damping, radius and torque: the device tables of CHAI3D 3.3. Continuous force and encoder step:
// recalled from data sheets, unchecked; the Falcon's continuous force is ours (half of the peak). delta.6 is driven as
// a delta.3 with a passive wrist.
constexpr std::array kModels{
    Model{33, "omega.3", false, false, 12, 12, 5, 0.03, 75, 0, 0.01},
    Model{34, "omega.6", true, false, 12, 12, 5, 0.03, 75, 0, 0.01},
    Model{36, "omega.6", true, false, 12, 12, 5, 0.03, 75, 0, 0.01},
    Model{35, "omega.7", true, false, 12, 12, 5, 0.03, 75, 0, 0.01},
    Model{37, "omega.7", true, false, 12, 12, 5, 0.03, 75, 0, 0.01},
    Model{63, "delta.3", false, false, 20, 20, 5, 0.03, 150, 0, 0.03},
    Model{64, "delta.6", true, false, 20, 20, 5, 0.03, 150, 0, 0.03},
    Model{104, "sigma.7", true, true, 12, 12, 4, 0.03, 75, 200, 0.0015},
    Model{105, "sigma.7", true, true, 12, 12, 4, 0.03, 75, 200, 0.0015},
    Model{206, "sigma.3", false, false, 12, 12, 4, 0.03, 75, 0, 0.0015},
    Model{108, "lambda.7", true, true, 12, 12, 8, 0.03, 112.5, 200, 0.0015},
    Model{109, "lambda.7", true, true, 12, 12, 8, 0.03, 112.5, 200, 0.0015},
    Model{203, "lambda.3", false, false, 12, 12, 8, 0.03, 112.5, 0, 0.0015},
    Model{kTypeFalcon, "Falcon", false, false, 8, 4, 3, 0.02, 40, 0, 0.06},
};

}  // namespace

Library::Library()
    : file("the Force Dimension library", {"libdrd.so", "libdrd.so.3", "libdhd.so", "libdhd.so.3"},
           "HANDPIECE_DHD_LIBRARY", kRemedy) {
    file.require(dhdGetDeviceCount, "dhdGetDeviceCount");
    file.require(dhdOpenID, "dhdOpenID");
    file.require(dhdClose, "dhdClose");
    file.require(dhdEnableForce, "dhdEnableForce");
    file.require(dhdGetSystemType, "dhdGetSystemType");
    file.require(dhdGetSystemName, "dhdGetSystemName");
    file.require(dhdGetPosition, "dhdGetPosition");
    file.require(dhdSetForce, "dhdSetForce");
    file.require(dhdErrorGetLast, "dhdErrorGetLast");
    file.require(dhdErrorGetLastStr, "dhdErrorGetLastStr");
    file.find(dhdGetAvailableCount, "dhdGetAvailableCount");
    file.find(dhdStop, "dhdStop");
    file.find(dhdGetSerialNumber, "dhdGetSerialNumber");
    file.find(dhdGetVersion, "dhdGetVersion");
    file.find(dhdGetSDKVersion, "dhdGetSDKVersion");
    file.find(dhdGetStatus, "dhdGetStatus");
    file.find(dhdGetButtonMask, "dhdGetButtonMask");
    file.find(dhdGetButton, "dhdGetButton");
    file.find(dhdHasWrist, "dhdHasWrist");
    file.find(dhdHasActiveWrist, "dhdHasActiveWrist");
    file.find(dhdIsLeftHanded, "dhdIsLeftHanded");
    file.find(dhdGetPositionAndOrientationFrame, "dhdGetPositionAndOrientationFrame");
    file.find(dhdSetForceAndTorqueAndGripperForce, "dhdSetForceAndTorqueAndGripperForce");
    file.find(drdOpenID, "drdOpenID");
    file.find(drdClose, "drdClose");
    file.find(drdIsInitialized, "drdIsInitialized");
    file.find(drdAutoInit, "drdAutoInit");
}

std::string Library::version() const {
    if (!dhdGetSDKVersion) return {};
    int major = 0, minor = 0, release = 0, revision = 0;
    dhdGetSDKVersion(&major, &minor, &release, &revision);
    return fmt::format("{}.{}.{}", major, minor, release);
}

std::string Library::lastError() const {
    const char* text = dhdErrorGetLastStr();
    return text ? text : "";
}

std::shared_ptr<Library> library() {
    static std::mutex mutex;
    static std::shared_ptr<Library> loaded;
    static std::string loadedFrom;
    const char* path = std::getenv("HANDPIECE_DHD_LIBRARY");
    const std::string from = path ? path : "";
    const std::lock_guard lock(mutex);
    if (!loaded || loadedFrom != from) {
        loaded = std::make_shared<Library>();
        loadedFrom = from;
    }
    return loaded;
}

Words wordsOf(int code) noexcept {
    const int cause = code - kForceOff;
    if (cause >= 0 && cause < static_cast<int>(kForceOffWords.size())) return kForceOffWords[cause];
    return kWords[code >= 0 && code < static_cast<int>(kWords.size()) ? code : kError];
}

const Model* modelOf(int type) noexcept {
    for (const Model& model : kModels)
        if (model.type == type) return &model;
    return nullptr;
}

device::Capability capabilityOf(const Model& model) {
    device::Capability c;
    c.name = model.name;
    c.maxForceN = model.maxForceN;
    c.continuousForceN = model.continuousForceN;
    c.maxStiffnessNPerMm = model.maxStiffnessNPerMm;
    c.maxDampingNSPerMm = model.maxDampingNSPerMm;
    c.maxTorqueNmm = model.maxTorqueNmm;
    c.encoderStepMm = model.encoderStepMm;
    c.workspaceMm = core::Vec3::Constant(2 * model.radiusMm);
    c.sensedAxes = model.wrist ? 6 : 3;
    c.drivenAxes = model.activeWrist ? 6 : 3;
    c.rateHz = model.type == kTypeFalcon ? 1000 : 4000;
    return c;
}

}  // namespace handpiece::drivers::dhd
