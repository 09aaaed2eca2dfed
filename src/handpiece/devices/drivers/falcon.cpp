// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/falcon.h"

#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <cstdlib>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/devices/drivers/falcon_kinematics.h"
#include "handpiece/devices/drivers/falcon_usb.h"
#include "handpiece/devices/drivers/force_dimension.h"
#include "handpiece/devices/drivers/force_dimension_library.h"
#include "handpiece/devices/drivers/servo_thread.h"

namespace handpiece::drivers {
namespace {

using falcon::Connection;
using falcon::Report;
using link::CalibrationState;
using link::DeviceFault;
using link::DriverCommand;
using link::DriverReading;

constexpr std::chrono::milliseconds kPatience{600};
constexpr std::int64_t kAnswerNs = 3'000'000;        // a frame's answer comes within one or two
constexpr std::int64_t kStalledNs = 20'000'000;      // no answer for so long
constexpr std::int64_t kRetryEveryNs = 100'000'000;  // once it is gone
// Open-source drivers send 10,000 of the motors' units for a newton metre about the crank, against its turn.
constexpr double kUnitsPerNmm = -10.0;
/// The largest force that the motors' units hold out for in every direction within 40 mm of the middle.
constexpr double kMaxForceN = 4.8;

/// What the servo thread works with. Outlives the driver when the thread is left behind.
struct Grip {
    std::unique_ptr<Connection> connection;
    std::unique_ptr<ServoPort> door;
    std::atomic<bool> homed{false};

    DriverReading reading;
    core::Vec3 place = falcon::middleMm(), cranks = core::Vec3::Zero();
    std::array<int, 3> motors{};
    bool placed = false, asked = false, gone = false;
    std::int64_t heardNs = 0, nextTryNs = 0;
    std::uint64_t spoilt = 0;

    void frame() noexcept;
    void hear(const Report& report) noexcept;
    void failed(int code, std::int64_t nowNs) noexcept;
    void turnInto(const DriverCommand& command) noexcept;
    void last() noexcept;
};

void Grip::hear(const Report& report) noexcept {
    heardNs = rt::monotonicNs();
    reading.timeNs = heardNs;
    reading.vendorCode = 0;
    reading.buttons = report.buttons;
    gone = false;
    if (report.homed == falcon::kAllHomed) homed.store(true);
    if (!homed.load()) {
        reading.trouble = DeviceFault::notCalibrated;
        placed = false;
        return;
    }
    for (int i = 0; i < 3; ++i)
        cranks[i] = falcon::crankOf(report.counts[static_cast<std::size_t>(i)]);
    // From where it was; once more from the middle where that was too far off.
    placed = falcon::forward(cranks, place);
    if (!placed) {
        place = falcon::middleMm();
        placed = falcon::forward(cranks, place);
    }
    reading.trouble = placed ? DeviceFault::none : DeviceFault::badData;
    if (!placed) return;
    const core::Vec3 from = place - falcon::middleMm();
    reading.positionMm = {from.x(), from.y(), from.z()};
}

void Grip::failed(int code, std::int64_t nowNs) noexcept {
    if (code == falcon::kTimedOut) {
        if (nowNs - heardNs < kStalledNs) return;
        // Something comes, but no frame can be made of it.
        const std::uint64_t now = connection->spoilt();
        reading.trouble = now != spoilt ? DeviceFault::badData : DeviceFault::stalled;
        reading.vendorCode = now != spoilt ? 0 : code;
        spoilt = now;
        return;
    }
    gone = code == falcon::kGone || code == falcon::kIo;
    if (gone) nextTryNs = nowNs + kRetryEveryNs;
    reading.trouble = gone ? DeviceFault::unplugged : DeviceFault::vendorError;
    reading.vendorCode = code;
}

void Grip::turnInto(const DriverCommand& command) noexcept {
    motors = {};
    core::Vec3 torqueNmm;
    const core::Vec3 force(command.forceN[0], command.forceN[1], command.forceN[2]);
    if (!placed || reading.trouble != DeviceFault::none || force.isZero(0) ||
        !falcon::torquesFor(place, cranks, force, torqueNmm))
        return;
    core::Vec3 units = kUnitsPerNmm * torqueNmm;
    // A force keeps its direction when a motor is at its end.
    const double most = units.cwiseAbs().maxCoeff();
    if (!(most < 1e9)) return;
    if (most > falcon::kMaxMotor) units *= falcon::kMaxMotor / most;
    for (int i = 0; i < 3; ++i)
        motors[static_cast<std::size_t>(i)] = static_cast<int>(std::lround(units[i]));
}

void Grip::frame() noexcept {
    const std::int64_t nowNs = rt::monotonicNs();
    const bool silent = gone && nowNs < nextTryNs;
    const bool calibrated = homed.load();
    const unsigned light = calibrated ? falcon::kGreen : falcon::kRed;
    if (heardNs == 0) heardNs = nowNs;
    if (!silent) {
        int code = 0;
        // One frame out, one back. The first, and one after an answer that did not come, pushes with nothing.
        if (!asked) code = connection->write(falcon::encode({0, 0, 0}, light, !calibrated));
        Report report;
        if (code == 0) code = connection->read(report, kAnswerNs);
        if (code == 0)
            hear(report);
        else
            failed(code, rt::monotonicNs());
        asked = false;
    }
    if (reading.frame == 0 && reading.timeNs == 0) {
        reading.timeNs = nowNs;
        reading.trouble = reading.trouble == DeviceFault::none ? DeviceFault::starting : reading.trouble;
    }
    ++reading.frame;
    const DriverCommand command = door->exchange(reading);
    if (silent) return;
    turnInto(command);
    // Where the answer is late the motors are told to rest all the same.
    if (const int code = connection->write(falcon::encode(motors, light, !calibrated)); code == 0)
        asked = true;
    else if (code != falcon::kTimedOut)
        failed(code, rt::monotonicNs());
}

void Grip::last() noexcept {
    (void)connection->write(falcon::encode({0, 0, 0}, 0, false));
    connection.reset();
}

class FalconDriver final : public link::Driver {
  public:
    explicit FalconDriver(const OpenOptions& options) : grip_(std::make_shared<Grip>()) {
        const std::shared_ptr<const falcon::Usb> usb = falcon::usb();
        grip_->connection = std::make_unique<Connection>(usb, options.which);
        Connection& connection = *grip_->connection;
        connection.setFrames();
        if (!connection.answers(0.5)) load(connection);

        info_.driver = "falcon";
        info_.model = "Falcon";
        info_.serial = connection.serial();
        info_.version = usb->file.name();
        info_.hasOrientation = false;
        info_.capability = dhd::capabilityOf(*dhd::modelOf(dhd::kTypeFalcon));
        info_.capability.name = info_.model;
        info_.capability.maxForceN = kMaxForceN;
        info_.sources =
            "stiffness and damping: device table of CHAI3D 3.3; geometry and motor units: open-source drivers; "
            "continuous force ours; all unchecked";
        if (options.servoHz > 0) info_.capability.rateHz = options.servoHz;
        info_.servoHz = info_.capability.rateHz;
    }
    ~FalconDriver() override { FalconDriver::stop(); }

    [[nodiscard]] const link::DriverInfo& info() const noexcept override { return info_; }

    void start(link::Servo& servo) override {
        link::requireStartable(servo_ != nullptr, stopped_, info_.model);
        grip_->door = std::make_unique<ServoPort>(servo);
        servo_ = std::make_unique<ServoThread>(
            info_.servoHz, [grip = grip_] { grip->frame(); }, [grip = grip_] { grip->last(); });
    }

    void stop() noexcept override {
        if (stopped_) return;
        stopped_ = true;
        if (!servo_) {
            (void)withPatience(kPatience, [grip = grip_] { grip->connection.reset(); });
            return;
        }
        // Left behind where libusb hangs. Nothing can be sent then; what the device's firmware does with the last force
        // when it hears no more is not known.
        if (!servo_->stop(kPatience)) grip_->door->shut();
    }

    [[nodiscard]] CalibrationState calibration() override {
        return grip_->homed.load() ? CalibrationState::good : CalibrationState::wantedByHand;
    }
    [[nodiscard]] std::string calibrationStep() override {
        return "Pull the grip all the way out, then push it straight all the way in.";
    }
    bool calibrate() override {
        link::requireCalibratable(servo_ && !stopped_, info_.model);
        return grip_->homed.load();
    }

  private:
    static void load(Connection& connection) {
        const char* path = std::getenv("HANDPIECE_FALCON_FIRMWARE");
        if (!path || !*path)
            throw core::Error(
                "the Falcon's firmware is not loaded, and Handpiece may not bring it along",
                "Falcon " + connection.serial(),
                "Install the Force Dimension SDK, which brings it, or set HANDPIECE_FALCON_FIRMWARE to the "
                "firmware file of its maker's driver")
                .as("firmware-missing", {connection.serial()});
        constexpr std::uint64_t kLargest = 1u << 20;
        connection.upload(core::readFile(path, kLargest));
    }

    std::shared_ptr<Grip> grip_;
    link::DriverInfo info_;
    bool stopped_ = false;
    std::unique_ptr<ServoThread> servo_;
};

}  // namespace

Found lookFalcon() {
    Found found;
    found.driver = "falcon";
    found.makes = "Novint Falcon (DHD, or libusb)";
    try {
        const int count = falcon::countFalcons(*falcon::usb());
        found.available = count > 0;
        for (int i = 0; i < count; ++i) {
            found.models.push_back(fmt::format("Falcon {}", i + 1));
            found.units.push_back({std::to_string(i + 1), found.models.back()});
        }
        if (!found.available) {
            found.why = "No Falcon is plugged in.";
            found.remedy = "Check its cable and power.";
        }
    } catch (const core::Error& e) {
        found.why = e.problem();
        found.remedy = e.remedy();
        // Without libusb the other library may still see one; which of its devices it is tells only opening it.
        if (const Found other = lookForceDimension(); other.available) {
            found.available = true;
            found.models = other.models;
            found.units = other.units;
        }
    }
    return found;
}

std::unique_ptr<link::Driver> openFalconDirectly(const OpenOptions& options) {
    return std::make_unique<FalconDriver>(options);
}

std::unique_ptr<link::Driver> openFalcon(const OpenOptions& options) {
    try {
        return openFalconThroughDhd(options);
    } catch (const core::Error& e) {
        // No library, or none that sees it: what the cable says is what the person is to be told.
        if (e.id() != "library-missing" && e.id() != "library-wrong" && e.id() != "device-missing") throw;
    }
    return openFalconDirectly(options);
}

std::string falconErrorInWords(std::int32_t code) {
    return code < 0 ? falcon::usbErrorInWords(code) : dhdErrorInWords(code);
}

}  // namespace handpiece::drivers
