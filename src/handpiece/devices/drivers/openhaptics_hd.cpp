// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/openhaptics_hd.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <system_error>
#include <vector>

#include "handpiece/base/core/error.h"
#ifdef _WIN32
#include <windows.h>
#else
#include <dlfcn.h>
#endif

namespace handpiece::drivers::hd {
namespace {

using link::DeviceFault;

constexpr ErrorWords kErrors[] = {
    {kInvalidEnum, Weight::note, DeviceFault::none, "the library does not know a value that was asked of it",
     "install a newer version of OpenHaptics"},
    {kInvalidValue, Weight::note, DeviceFault::none, "the library refuses a value that was set",
     "choose another servo rate; 1000 Hz works with every device"},
    {kInvalidOperation, Weight::frame, DeviceFault::vendorError, "the library refuses an operation at this moment",
     "disconnect the device and connect it again"},
    {kInvalidInputType, Weight::note, DeviceFault::none, "the library has this value in another type",
     "install a newer version of OpenHaptics"},
    {kBadHandle, Weight::fatal, DeviceFault::vendorError, "the library does not know this device any more",
     "connect the device again"},
    {kWarmMotors, Weight::note, DeviceFault::none, "the device's motors are warm",
     "let the device rest for some minutes with little force"},
    {kExceededMaxForce, Weight::note, DeviceFault::none, "the force was more than the device can give; it was cut off",
     "lower the share of the device's force in its profile"},
    {kExceededForceImpulse, Weight::note, DeviceFault::none, "the force changed faster than the device allows",
     "lower the stiffness in the device's profile"},
    {kExceededVelocity, Weight::note, DeviceFault::none, "the stylus moved faster than the device allows",
     "move the stylus more slowly"},
    {kForceError, Weight::note, DeviceFault::none, "the device could not produce the force it was asked for",
     "check the device's power supply"},
    {kDeviceFault, Weight::fatal, DeviceFault::vendorError, "the device reports a fault of its own",
     "switch the device off, wait ten seconds, switch it on and connect it again"},
    {kAlreadyInitiated, Weight::fatal, DeviceFault::vendorError, "the device is already in use",
     "close other programs that use the device"},
    {kCommError, Weight::fatal, DeviceFault::unplugged, "the device does not answer",
     "check its cable and its power, then connect it again"},
    {kCommConfigError, Weight::fatal, DeviceFault::vendorError, "the connection to the device is not set up",
     "run the vendor's set-up program; after a change of driver delete its old configuration in ~/.3dsystems"},
    {kTimerError, Weight::fatal, DeviceFault::vendorError, "the library's servo timer failed",
     "close other programs, then connect the device again"},
    {kIllegalBegin, Weight::frame, DeviceFault::vendorError, "a frame was begun inside another one",
     "disconnect the device and connect it again; if it stays, report it"},
    {kIllegalEnd, Weight::frame, DeviceFault::vendorError, "a frame was ended that had not begun",
     "disconnect the device and connect it again; if it stays, report it"},
    {kFrameError, Weight::frame, DeviceFault::vendorError, "a value was used outside of its frame",
     "disconnect the device and connect it again; if it stays, report it"},
    {kInvalidPriority, Weight::fatal, DeviceFault::vendorError, "the library refuses the servo's priority",
     "install a newer version of OpenHaptics"},
    {kSchedulerFull, Weight::fatal, DeviceFault::vendorError, "the library's scheduler has no room for another task",
     "close other devices, then connect this one again"},
    {kInvalidLicence, Weight::fatal, DeviceFault::vendorError, "OpenHaptics has no valid licence on this machine",
     "install a licence with the vendor's tool; the developer edition may not be used commercially"},
};
constexpr ErrorWords kUnknown{0xFFFF, Weight::fatal, DeviceFault::vendorError, "the library reports an unknown error",
                              "switch the device off and on, then connect it again"};

#ifdef _WIN32
// Not compiled by anybody yet.
void* alreadyThere() noexcept {
    const HMODULE module = GetModuleHandleA("hd.dll");
    return module ? reinterpret_cast<void*>(GetProcAddress(module, "hdInitDevice")) : nullptr;
}
std::string pathOf(void* function) {
    HMODULE module = nullptr;
    char path[MAX_PATH] = {};
    if (GetModuleHandleExA(GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT,
                           static_cast<const char*>(function), &module))
        GetModuleFileNameA(module, path, sizeof path);
    return path;
}
const std::vector<std::string> kNames{"HD.dll"};
#else
void* alreadyThere() noexcept {
    return dlsym(RTLD_DEFAULT, "hdInitDevice");
}
std::string pathOf(void* function) {
    Dl_info info{};
    return dladdr(function, &info) && info.dli_fname ? info.dli_fname : "";
}
const std::vector<std::string> kNames{"libHD.so", "libHD.so.3.5", "libHD.so.3.4", "libHD.so.3.0"};
#endif

constexpr const char* kEnvironment = "HANDPIECE_HD_LIBRARY";
constexpr const char* kRemedy =
    "install OpenHaptics and the device's driver from 3D Systems, or set HANDPIECE_HD_LIBRARY to the path of its HD "
    "library; see docs/devices/openhaptics.md";

core::Error twoLibraries(const std::string& one, const std::string& other) {
    return core::Error("two HD libraries in one program cannot share a device", one + " and " + other,
                       "set HANDPIECE_HD_LIBRARY to the one that is meant, or unset it, and start Handpiece again")
        .as("two-libraries", {one, other});
}

bool sameFile(const std::string& a, const std::string& b) {
    std::error_code failed;
    return a == b || std::filesystem::equivalent(a, b, failed);
}

std::unique_ptr<Library> load() {
    void* const before = alreadyThere();
    const link::SharedLibrary shared("the HD library of OpenHaptics", kNames, kEnvironment, kRemedy);
    auto lib = std::make_unique<Library>();
    shared.require(lib->initDevice, "hdInitDevice");
    shared.require(lib->disableDevice, "hdDisableDevice");
    shared.require(lib->makeCurrent, "hdMakeCurrentDevice");
    shared.require(lib->beginFrame, "hdBeginFrame");
    shared.require(lib->endFrame, "hdEndFrame");
    shared.require(lib->getError, "hdGetError");
    shared.require(lib->enable, "hdEnable");
    shared.require(lib->disable, "hdDisable");
    shared.require(lib->getBoolean, "hdGetBooleanv");
    shared.require(lib->getInteger, "hdGetIntegerv");
    shared.require(lib->getDouble, "hdGetDoublev");
    shared.require(lib->getString, "hdGetString");
    shared.require(lib->setDouble, "hdSetDoublev");
    shared.require(lib->checkCalibration, "hdCheckCalibration");
    shared.require(lib->updateCalibration, "hdUpdateCalibration");
    shared.require(lib->startScheduler, "hdStartScheduler");
    shared.require(lib->stopScheduler, "hdStopScheduler");
    shared.require(lib->setSchedulerRate, "hdSetSchedulerRate");
    shared.require(lib->scheduleAsynchronous, "hdScheduleAsynchronous");
    shared.require(lib->unschedule, "hdUnschedule");
    void* const mine = reinterpret_cast<void*>(lib->initDevice);
    lib->path = pathOf(mine);
    // Loaded for all to see, the functions of one could call those of the other.
    if (before != nullptr && before != mine) throw twoLibraries(pathOf(before), lib->path);
    return lib;
}

}  // namespace

const ErrorWords& wordsOf(unsigned code) noexcept {
    for (const ErrorWords& words : kErrors)
        if (words.code == code) return words;
    return kUnknown;
}

unsigned Library::drain() const noexcept {
    unsigned heaviest = kSuccess;
    // The stack is bounded; a library that never says success must not hold the servo.
    for (int i = 0; i < 64; ++i) {
        const unsigned code = getError().code;
        if (code == kSuccess) break;
        if (heaviest == kSuccess || wordsOf(code).weight > wordsOf(heaviest).weight) heaviest = code;
    }
    return heaviest;
}

const Library& library() {
    static std::mutex mutex;
    static std::unique_ptr<Library>& loaded = *new std::unique_ptr<Library>;  // outlives every thread
    const std::lock_guard guard(mutex);
    if (loaded == nullptr) {
        loaded = load();
    } else if (const char* asked = std::getenv(kEnvironment); asked && *asked && !sameFile(asked, loaded->path)) {
        std::error_code ec;
        if (!std::filesystem::exists(asked, ec))
            (void)link::SharedLibrary("the HD library of OpenHaptics", kNames, kEnvironment, kRemedy);
        throw twoLibraries(loaded->path, asked);
    }
    return *loaded;
}

}  // namespace handpiece::drivers::hd
