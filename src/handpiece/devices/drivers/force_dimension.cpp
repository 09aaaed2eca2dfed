// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/force_dimension.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <thread>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/devices/drivers/force_dimension_library.h"
#include "handpiece/devices/drivers/servo_thread.h"

namespace handpiece::drivers {
namespace {

using dhd::Library;
using link::CalibrationState;
using link::DeviceFault;
using link::DriverCommand;
using link::DriverReading;

constexpr std::chrono::milliseconds kPatience{500}, kLastAttempt{200};
constexpr std::int64_t kStatusEveryNs = 50'000'000;  // the status is a call of its own
constexpr std::int64_t kGoneAfterNs = 100'000'000;   // of failed calls without a break
constexpr std::int64_t kRetryEveryNs = 100'000'000;  // once it is gone
constexpr std::int64_t kForceAgainAfterNs = 500'000'000;

/// What the servo thread works with. Outlives the driver when the thread is left behind.
struct Arm {
    std::shared_ptr<Library> library;
    int index = -1;  // in the library's list
    char id = -1;
    bool openedByDrd = false;
    bool wrist = false, torque = false;
    std::unique_ptr<ServoPort> door;

    // Between the driver's owner and the thread.
    std::atomic<bool> calibrating{false}, idle{false};  // the thread keeps off the library while it calibrates
    std::atomic<int> initialised{-1};                   // -1: not known
    enum Motors : int { on, switchingOff, off };
    std::atomic<int> motors{on};  // off: the watchdog had them switched off
    std::atomic<bool> closed{false};

    // The servo thread's.
    DriverReading reading;
    DeviceFault statusFault = DeviceFault::none;
    int statusCode = 0;
    std::int64_t nextStatusNs = 0, failingSinceNs = 0, nextTryNs = 0, forceOffSinceNs = 0;
    bool gone = false;

    void frame() noexcept;
    void last() noexcept;
    void readPose(std::int64_t nowNs) noexcept;
    void readStatus(std::int64_t nowNs) noexcept;
    void failed(std::int64_t nowNs) noexcept;
    void send(const DriverCommand& command) noexcept;
    void close() noexcept;
};

int errorNumber(const Library& library) noexcept {
    const int code = library.dhdErrorGetLast();
    return code > 0 ? code : dhd::kError;
}

void Arm::failed(std::int64_t nowNs) noexcept {
    const int code = errorNumber(*library);
    if (failingSinceNs == 0) failingSinceNs = nowNs;
    const bool silent = code == dhd::kCommunication || code == dhd::kTimeout;
    gone = code == dhd::kNoDevice || code == dhd::kNotAvailable || code == dhd::kInvalidIndex ||
           (silent && nowNs - failingSinceNs > kGoneAfterNs);
    if (gone) nextTryNs = nowNs + kRetryEveryNs;
    reading.trouble = gone ? DeviceFault::unplugged : DeviceFault::vendorError;
    reading.vendorCode = code;
}

void Arm::readPose(std::int64_t nowNs) noexcept {
    std::array<double, 3> metres{};
    double rotation[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const int said = wrist
                         ? library->dhdGetPositionAndOrientationFrame(&metres[0], &metres[1], &metres[2], rotation, id)
                         : library->dhdGetPosition(&metres[0], &metres[1], &metres[2], id);
    if (said < 0) return failed(nowNs);
    failingSinceNs = 0;
    gone = false;
    reading.trouble = DeviceFault::none;
    reading.vendorCode = 0;
    reading.positionMm = positionFromDhd(metres);
    if (wrist && !orientationFromDhd(rotation, reading.orientation)) reading.trouble = DeviceFault::badData;
    reading.buttons = 0;
    if (library->dhdGetButtonMask) {
        reading.buttons = library->dhdGetButtonMask(id);
    } else if (library->dhdGetButton) {
        for (int i = 0; i < 4; ++i)
            if (library->dhdGetButton(i, id) > 0) reading.buttons |= 1u << i;
    }
}

void Arm::readStatus(std::int64_t nowNs) noexcept {
    nextStatusNs = nowNs + kStatusEveryNs;
    statusFault = DeviceFault::none;
    statusCode = 0;
    if (library->drdIsInitialized) initialised.store(library->drdIsInitialized(id) ? 1 : 0);
    int status[dhd::kStatusCount] = {};
    if (library->dhdGetStatus && library->dhdGetStatus(status, id) >= 0) {
        if (!library->drdIsInitialized) initialised.store(status[dhd::kStatusReset] == 1 ? 0 : 1);
        const int cause = status[dhd::kStatusForceOffCause];
        if (status[dhd::kStatusForce] == 0 && cause > 0) {
            statusCode = dhd::kForceOff + cause;
            statusFault = cause == dhd::kCauseDeadMan     ? DeviceFault::inputLost
                          : cause == dhd::kCauseUnplugged ? DeviceFault::unplugged
                                                          : DeviceFault::vendorError;
            if (forceOffSinceNs == 0) forceOffSinceNs = nowNs;
            // The controller's own guards let go by themselves; its button is the person's to press.
            if ((cause == dhd::kCauseVelocity || cause == dhd::kCauseWatchdog) &&
                nowNs - forceOffSinceNs > kForceAgainAfterNs) {
                (void)library->dhdEnableForce(1, id);
                forceOffSinceNs = nowNs;
            }
        } else {
            forceOffSinceNs = 0;
        }
    }
    if (initialised.load() == 0 && statusFault == DeviceFault::none) statusFault = DeviceFault::notCalibrated;
}

void Arm::send(const DriverCommand& command) noexcept {
    const std::array<double, 3> force = vectorToDhd(command.forceN);
    int said = 0;
    if (torque) {
        const std::array<double, 3> about = vectorToDhd(command.torqueNmm);
        constexpr double kNmPerNmm = 1e-3;
        said = library->dhdSetForceAndTorqueAndGripperForce(force[0], force[1], force[2], about[0] * kNmPerNmm,
                                                            about[1] * kNmPerNmm, about[2] * kNmPerNmm, 0.0, id);
    } else {
        said = library->dhdSetForce(force[0], force[1], force[2], id);
    }
    if (said < 0 && reading.trouble == DeviceFault::none) {
        // The next reading tells it: this one has passed the gate.
        statusFault = DeviceFault::vendorError;
        statusCode = errorNumber(*library);
        nextStatusNs = std::max(nextStatusNs, rt::monotonicNs() + kStatusEveryNs / 5);
    }
}

void Arm::frame() noexcept {
    const std::int64_t nowNs = rt::monotonicNs();
    const bool calibratingNow = calibrating.load(std::memory_order_acquire);
    idle.store(calibratingNow, std::memory_order_release);
    const bool silent = calibratingNow || (gone && nowNs < nextTryNs);
    if (!silent) {
        readPose(nowNs);
        if (failingSinceNs == 0 && nowNs >= nextStatusNs) readStatus(nowNs);
    }
    DriverReading told = reading;
    told.timeNs = rt::monotonicNs();
    told.frame = ++reading.frame;
    if (calibratingNow) {
        told.trouble = DeviceFault::notCalibrated;
    } else if (told.trouble == DeviceFault::none && statusFault != DeviceFault::none) {
        told.trouble = statusFault;
        told.vendorCode = statusCode;
    }
    const DriverCommand command = door->exchange(told);
    if (silent) return;
    if (motors.load(std::memory_order_acquire) == off) {
        (void)library->dhdEnableForce(1, id);
        motors.store(on, std::memory_order_release);
    }
    send(command);
}

void Arm::last() noexcept {
    if (!calibrating.load()) {
        (void)library->dhdSetForce(0, 0, 0, id);
        (void)library->dhdEnableForce(0, id);
        if (library->dhdStop) (void)library->dhdStop(id);
    }
    close();
}

void Arm::close() noexcept {
    closed.store(true);
    (void)(openedByDrd ? library->drdClose(id) : library->dhdClose(id));
    const std::lock_guard lock(library->mutex);  // after the call: it may hang
    library->open.erase(index);
}

core::Error refusal(const Library& library, int code, const std::string& where) {
    const dhd::Words words = dhd::wordsOf(code);
    const std::string sentence(words.sentence.substr(0, words.sentence.size() - 1));
    const std::string said = library.lastError();
    const char* id = code == dhd::kBusy || code == dhd::kInUse          ? "device-busy"
                     : code == dhd::kNoDevice || code == dhd::kNoDriver ? "device-missing"
                                                                        : "device-error";
    return core::Error(fmt::format("{} (error {}: {})", sentence, code, said), where,
                       std::string(words.remedy.substr(0, words.remedy.size() - 1)))
        .as(id, {where, sentence, std::to_string(code)});
}

/// USB devices of this vendor that are there but may not be opened: the library calls that "no device".
bool forbiddenOnUsb(std::string_view vendor, std::string_view product) {
    const auto lineOf = [](const std::filesystem::path& path) {
        std::string line;
        if (std::FILE* file = std::fopen(path.c_str(), "r")) {
            char text[32] = {};
            if (std::fgets(text, sizeof text, file)) line = text;
            std::fclose(file);
        }
        while (!line.empty() && line.back() <= ' ')
            line.pop_back();
        return line;
    };
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator("/sys/bus/usb/devices", none)) {
        if (lineOf(entry.path() / "idVendor") != vendor) continue;
        if (!product.empty() && lineOf(entry.path() / "idProduct") != product) continue;
        int bus = 0, device = 0;
        if (std::sscanf(lineOf(entry.path() / "busnum").c_str(), "%d", &bus) != 1) continue;
        if (std::sscanf(lineOf(entry.path() / "devnum").c_str(), "%d", &device) != 1) continue;
        const std::string node = fmt::format("/dev/bus/usb/{:03}/{:03}", bus, device);
        std::FILE* file = std::fopen(node.c_str(), "r+");
        if (!file) return true;
        std::fclose(file);
    }
    return false;
}

constexpr const char* kUdevRemedy =
    "Install the udev rules of Handpiece (docs/devices/forcedimension.md), then unplug the device and plug it in again";

core::Error noDevice(const Library& library, bool falcon) {
    if (falcon ? forbiddenOnUsb("0403", "cb48") : forbiddenOnUsb("1451", ""))
        return core::Error("the device is connected, but this account may not use it", falcon ? "Falcon" : "USB 1451",
                           kUdevRemedy)
            .as("device-permission", {falcon ? "Falcon" : "Force Dimension"});
    return core::Error(
               falcon ? "the Force Dimension library sees no Falcon" : "the Force Dimension library sees no device",
               library.file.name(), "Check its cable and power, then connect it again")
        .as("device-missing", {falcon ? "Falcon" : "Force Dimension"});
}

std::string serialOf(const Library& library, char id, int type) {
    unsigned short number = 0;
    // A Falcon always says 65535.
    if (type == dhd::kTypeFalcon || !library.dhdGetSerialNumber || library.dhdGetSerialNumber(&number, id) < 0)
        return {};
    return std::to_string(number);
}

bool isWanted(const Library::Device& device, int index, const std::string& which, bool falcon) {
    if (falcon && device.type != dhd::kTypeFalcon) return false;
    if (which.empty()) return true;
    const dhd::Model* model = dhd::modelOf(device.type);
    return which == device.serial || which == device.name || (model && which == model->name) ||
           which == std::to_string(index + 1);
}

/// The first free device that is wanted, opened; the library's devices are tried in its own order.
std::pair<int, Library::Device> openWanted(Library& library, bool byDrd, const std::string& which, bool falcon) {
    const std::lock_guard lock(library.mutex);
    const int count = library.dhdGetDeviceCount();
    if (count < 0) throw refusal(library, errorNumber(library), "Force Dimension");
    if (count == 0) throw noDevice(library, falcon);
    std::optional<core::Error> refused;
    std::string seen;
    for (int index = 0; index < std::min(count, 16); ++index) {
        const auto label = [&] { return fmt::format("device {}", index + 1); };
        if (const auto own = library.open.find(index); own != library.open.end()) {
            if (isWanted(own->second, index, which, falcon))
                refused = core::Error("this program already uses the device", own->second.name,
                                      "Disconnect it first, or name another")
                              .as("device-busy", {own->second.name});
            continue;
        }
        Library::Device device;
        const int id =
            byDrd ? library.drdOpenID(static_cast<char>(index)) : library.dhdOpenID(static_cast<char>(index));
        if (id < 0) {
            if (!refused) refused = refusal(library, errorNumber(library), label());
            continue;
        }
        device.id = static_cast<char>(id);
        device.type = library.dhdGetSystemType(device.id);
        const char* name = library.dhdGetSystemName(device.id);
        device.name = name ? name : "";
        device.serial = serialOf(library, device.id, device.type);
        if (isWanted(device, index, which, falcon)) {
            library.open.emplace(index, device);
            return {index, device};
        }
        seen += (seen.empty() ? "" : ", ") + label() + ": " + device.name +
                (device.serial.empty() ? "" : " " + device.serial);
        (void)(byDrd ? library.drdClose(device.id) : library.dhdClose(device.id));
    }
    if (refused) throw *refused;
    if (falcon) throw noDevice(library, true);
    throw core::Error(fmt::format("no Force Dimension device is called \"{}\"", which), "device", "There are: " + seen)
        .as("device-missing", {which});
}

class ForceDimensionDriver final : public link::Driver {
  public:
    ForceDimensionDriver(std::shared_ptr<Library> library, const OpenOptions& options, bool falcon)
        : arm_(std::make_shared<Arm>()) {
        const bool byDrd = library->autoCalibrates();
        const auto [index, device] = openWanted(*library, byDrd, options.which, falcon);
        const dhd::Model* model = dhd::modelOf(device.type);
        Arm& arm = *arm_;
        arm.library = library;
        arm.index = index;
        arm.id = device.id;
        arm.openedByDrd = byDrd;
        type_ = device.type;
        arm.wrist = library->dhdGetPositionAndOrientationFrame &&
                    (library->dhdHasWrist ? library->dhdHasWrist(device.id) : model && model->wrist);
        arm.torque = arm.wrist && model && model->maxTorqueNmm > 0 && library->dhdSetForceAndTorqueAndGripperForce &&
                     (!library->dhdHasActiveWrist || library->dhdHasActiveWrist(device.id));

        info_.driver = falcon ? "falcon" : "forcedimension";
        info_.model = !device.name.empty() ? device.name : model ? model->name : fmt::format("type {}", device.type);
        info_.serial = device.serial;
        info_.hasOrientation = arm.wrist;
        if (model) {
            info_.capability = dhd::capabilityOf(*model);
            info_.sources = "device table of CHAI3D 3.3; continuous force and encoder step recalled, unchecked";
        } else {
            info_.sources =
                fmt::format("device type {} is not known: the weakest arm's record, unchecked", device.type);
        }
        info_.capability.name = info_.model;
        if (!arm.torque) {
            info_.capability.maxTorqueNmm = 0;
            info_.capability.drivenAxes = 3;
        }
        if (!arm.wrist) info_.capability.sensedAxes = 3;
        if (options.servoHz > 0) info_.capability.rateHz = options.servoHz;
        info_.servoHz = info_.capability.rateHz;
        info_.version = versionOf(*library, device.id);
        if (library->dhdIsLeftHanded && library->dhdIsLeftHanded(device.id)) info_.version += "; left-handed";
    }
    ~ForceDimensionDriver() override { ForceDimensionDriver::stop(); }

    [[nodiscard]] const link::DriverInfo& info() const noexcept override { return info_; }

    void start(link::Servo& servo) override {
        link::requireStartable(servo_ != nullptr, stopped_, info_.model);
        Arm& arm = *arm_;
        if (arm.library->dhdEnableForce(1, arm.id) < 0)
            throw refusal(*arm.library, errorNumber(*arm.library), info_.model);
        arm.readStatus(rt::monotonicNs());
        arm.door = std::make_unique<ServoPort>(servo);
        servo_ = std::make_unique<ServoThread>(
            info_.servoHz, [arm = arm_] { arm->frame(); }, [arm = arm_] { arm->last(); });
    }

    void stop() noexcept override {
        if (stopped_) return;
        stopped_ = true;
        if (!servo_) {
            (void)withPatience(kPatience, [arm = arm_] { arm->close(); });
            return;
        }
        if (servo_->stop(kPatience)) return;
        // The library hangs in a call: the gate is out of its reach from here on, and the force is switched off by a
        // call of its own in case that one gets through. Should both hang, the controller's watchdog is what is left.
        arm_->door->shut();
        (void)withPatience(kLastAttempt, [arm = arm_] { (void)arm->library->dhdEnableForce(0, arm->id); });
    }

    void relax() noexcept override {
        int expected = Arm::on;
        if (!servo_ || stopped_ || !arm_->motors.compare_exchange_strong(expected, Arm::switchingOff)) return;
        // The call may wait for the one that hangs: it gets a thread of its own.
        (void)withPatience(std::chrono::milliseconds(0), [arm = arm_] {
            if (!arm->closed.load()) (void)arm->library->dhdEnableForce(0, arm->id);
            arm->motors.store(Arm::off);
        });
    }

    [[nodiscard]] CalibrationState calibration() override {
        switch (arm_->initialised.load()) {
            case 1:
                return CalibrationState::good;
            case 0:
                return byHand() ? CalibrationState::wantedByHand : CalibrationState::wanted;
            default:
                return CalibrationState::notNeeded;  // the library cannot tell
        }
    }

    [[nodiscard]] std::string calibrationStep() override {
        if (type_ == dhd::kTypeFalcon) return "Pull the grip all the way out, then push it straight all the way in.";
        if (byHand())
            return "Put the calibration pole of the arm into its pit and hold it there until the status light is "
                   "steady.";
        return "Take your hands off the arm: it finds its place by itself, in some ten seconds.";
    }

    bool calibrate() override {
        Arm& arm = *arm_;
        link::requireCalibratable(servo_ && !stopped_, info_.model);
        if (byHand() || arm.initialised.load() != 0) return arm.initialised.load() != 0;
        // The arm moves by itself now, driven by its maker's routine; no force of ours goes out meanwhile.
        arm.calibrating.store(true);
        const std::int64_t untilNs = rt::monotonicNs() + 1'000'000'000;
        while (!arm.idle.load() && rt::monotonicNs() < untilNs)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        if (!arm.idle.load()) {
            arm.calibrating.store(false);
            throw core::Error("the device does not answer", info_.model, "Check its cable and power")
                .as("device-error", {info_.model, "the device does not answer", "7"});
        }
        const bool good = arm.library->drdAutoInit(arm.id) >= 0;
        const int code = good ? 0 : errorNumber(*arm.library);
        if (good) {
            arm.initialised.store(1);
            (void)arm.library->dhdEnableForce(1, arm.id);
        }
        arm.calibrating.store(false);
        if (!good) throw refusal(*arm.library, code, info_.model);
        return true;
    }

  private:
    [[nodiscard]] bool byHand() const { return type_ == dhd::kTypeFalcon || !arm_->library->autoCalibrates(); }
    static std::string versionOf(const Library& library, char id) {
        std::string text = library.file.name();
        if (const std::string sdk = library.version(); !sdk.empty()) text += " " + sdk;
        double controller = 0;
        if (library.dhdGetVersion && library.dhdGetVersion(&controller, id) >= 0)
            text += fmt::format(", controller {:.2f}", controller);
        return text;
    }

    std::shared_ptr<Arm> arm_;
    link::DriverInfo info_;
    int type_ = 0;
    bool stopped_ = false;
    std::unique_ptr<ServoThread> servo_;
};

}  // namespace

std::array<double, 3> positionFromDhd(const std::array<double, 3>& metres) noexcept {
    constexpr double kMmPerM = 1000.0;
    return {metres[1] * kMmPerM, metres[2] * kMmPerM, metres[0] * kMmPerM};
}

std::array<double, 3> vectorToDhd(const std::array<double, 3>& deviceFrame) noexcept {
    return {deviceFrame[2], deviceFrame[0], deviceFrame[1]};
}

bool orientationFromDhd(const double (&frame)[3][3], std::array<double, 4>& orientation) noexcept {
    // The same turn of axes on both sides: base and handle are named alike, so what is level stays level.
    constexpr int kFrom[3] = {1, 2, 0};
    core::Mat3 rotation;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            rotation(row, column) = frame[kFrom[row]][kFrom[column]];
    if (!rotation.allFinite() || !(rotation * rotation.transpose()).isApprox(core::Mat3::Identity(), 1e-3) ||
        rotation.determinant() < 0)
        return false;
    const core::Quat q = core::Quat(rotation).normalized();
    orientation = {q.w(), q.x(), q.y(), q.z()};
    return true;
}

std::string dhdErrorInWords(std::int32_t code) {
    const dhd::Words words = dhd::wordsOf(code);
    return fmt::format("{} (DHD error {}): {}", words.sentence.substr(0, words.sentence.size() - 1), code,
                       words.remedy);
}

Found lookForceDimension() {
    Found found;
    found.driver = "forcedimension";
    found.makes = "Force Dimension omega, delta, sigma, lambda (DHD)";
    try {
        const std::shared_ptr<Library> library = dhd::library();
        const std::unique_lock lock(library->mutex, std::try_to_lock);
        if (!lock.owns_lock())
            throw core::Error("a device is just being opened", "Force Dimension", "Wait a moment")
                .as("device-busy", {});
        const int count = library->dhdGetDeviceCount();
        if (count < 0) throw refusal(*library, errorNumber(*library), "Force Dimension");
        if (count == 0) throw noDevice(*library, false);
        // What they are can only be told by opening them, which is not for a look.
        for (int i = 0; i < std::min(count, 16); ++i) {
            found.models.push_back(fmt::format("device {}", i + 1));
            found.units.push_back({std::to_string(i + 1), fmt::format("Force Dimension, device {}", i + 1)});
        }
        const int free = library->dhdGetAvailableCount ? library->dhdGetAvailableCount() : count;
        found.available = free != 0;
        if (!found.available) {
            found.why = "All Force Dimension devices are in use.";
            found.remedy = "Close the program that uses them.";
        }
    } catch (const core::Error& e) {
        found.why = e.problem();
        found.remedy = e.remedy();
    }
    return found;
}

std::unique_ptr<link::Driver> openForceDimension(const OpenOptions& options) {
    return std::make_unique<ForceDimensionDriver>(dhd::library(), options, false);
}

std::unique_ptr<link::Driver> openFalconThroughDhd(const OpenOptions& options) {
    return std::make_unique<ForceDimensionDriver>(dhd::library(), options, true);
}

}  // namespace handpiece::drivers
