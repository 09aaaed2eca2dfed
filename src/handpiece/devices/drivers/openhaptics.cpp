// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/openhaptics.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/devices/drivers/openhaptics_arm.h"

namespace handpiece::drivers {
namespace {

using hd::Library;
using link::CalibrationState;
using std::chrono::milliseconds;

// ---- One library, one scheduler --------------------------------------------------------------------------------

/// What all devices of the program share. Never destroyed: the vendor's threads may outlive main().
struct Desk {
    std::mutex mutex;  // held by a vendor's function that never returns: then nobody waits for it for ever
    std::set<std::string> open;
    int scheduled = 0;
    double rateHz = 0.0;  // 0: the library's own
};
Desk& desk() {
    static Desk& one = *new Desk;
    return one;
}

/// Outside of the servo nothing is asked of the library while the servo runs: nobody says whether the current device is
/// one for all threads, and a force must not reach the wrong arm. So the scheduler stands meanwhile, and the gates of
/// other arms see a gap. In the desk's lock.
class Pause {
  public:
    explicit Pause(const Library& library) : hd_(library) {
        if (desk().scheduled > 0) hd_.stopScheduler();
    }
    ~Pause() {
        if (desk().scheduled > 0) hd_.startScheduler();
    }
    Pause(const Pause&) = delete;
    Pause& operator=(const Pause&) = delete;

  private:
    const Library& hd_;
};

core::Error deaf() {
    return core::Error("the HD library of OpenHaptics does not answer", "OpenHaptics",
                       "switch the device off and on and start Handpiece again")
        .as("device-deaf");
}

core::Error vendorError(unsigned code, const std::string& where) {
    const hd::ErrorWords& words = hd::wordsOf(code);
    std::string id = "device-error";
    if (code == hd::kInvalidLicence) id = "no-licence";
    if (code == hd::kAlreadyInitiated) id = "device-busy";
    std::string remedy = words.remedy;
    if (code == hd::kCommError) {
        id = "device-missing";
        remedy +=
            "; close other programs that use it; see that this user may read and write its port "
            "(docs/devices/openhaptics.md, Permissions)";
    }
    return core::Error(fmt::format("{} (HD error 0x{:04X})", words.sentence, code), where, remedy)
        .as(id, {where, words.sentence, fmt::format("0x{:04X}", code)});
}

/// Calls the library in the desk's lock and waits no longer than `patience`. What it hangs in goes on without us:
/// `work` holds on to arms, which stay, and to shared pointers, never to a driver.
void ask(milliseconds patience, std::function<void()> work) {
    const auto failed = std::make_shared<std::optional<core::Error>>();
    const bool answered = withPatience(patience, [failed, work = std::move(work)] {
        const std::lock_guard guard(desk().mutex);
        try {
            work();
        } catch (const core::Error& e) {
            *failed = e;
        }
    });
    if (!answered) throw deaf();
    if (*failed) throw core::Error(**failed);
}

/// Enables the arm's force and gives it to the servo. In the desk's lock.
void begin(Arm& arm, const link::DriverInfo& info, double rateHz) {
    const Library& hd = arm.library;
    Desk& shared = desk();
    const auto check = [&] {
        const unsigned code = hd.drain();
        if (code != hd::kSuccess && hd::wordsOf(code).weight != hd::Weight::note) throw vendorError(code, info.model);
        return code;
    };
    std::optional<Pause> pause(hd);
    hd.makeCurrent(arm.handle);
    if (rateHz > 0) {
        if (shared.scheduled > 0 && shared.rateHz != rateHz)
            throw core::Error(fmt::format("all devices of OpenHaptics share one servo, which runs at {} Hz",
                                          shared.rateHz > 0 ? shared.rateHz : info.servoHz),
                              info.model, "ask for the same rate for all of them");
        if (shared.scheduled == 0) {
            hd.setSchedulerRate(static_cast<unsigned long>(rateHz + 0.5));
            if (check() != hd::kSuccess)
                throw core::Error(fmt::format("the device has no servo rate of {} Hz", rateHz), info.model,
                                  "500 and 1000 Hz are there on every device; leave the rate out for its own");
        }
    }
    hd.enable(hd::kForceOutput);
    (void)check();
    for (const unsigned limit : {hd::kForceClamping, hd::kForceRamping, hd::kSoftwareForceLimit}) {
        hd.enable(limit);
        (void)hd.drain();  // on by default; a model without it refuses the name
    }
    arm.job = hd.scheduleAsynchronous(&Arm::callback, &arm, hd::kPriority);
    (void)check();
    arm.scheduled = true;
    if (shared.scheduled++ == 0) shared.rateHz = rateHz;
    pause.reset();  // starts the scheduler
    (void)check();
}

class OpenHaptics final : public link::Driver {
  public:
    OpenHaptics(Arm* arm, link::DriverInfo info, double rateHz) : arm_(arm), info_(std::move(info)), rateHz_(rateHz) {}
    ~OpenHaptics() override { stop(); }

    [[nodiscard]] const link::DriverInfo& info() const noexcept override { return info_; }

    void start(link::Servo& servo) override {
        link::requireStartable(started_, stopped_, info_.model);
        arm_->door = std::make_unique<ServoPort>(servo);
        try {
            ask(milliseconds(5000), [arm = arm_, info = info_, rateHz = rateHz_] { begin(*arm, info, rateHz); });
        } catch (const core::Error&) {
            stop();  // should the library come back later, it finds the door shut
            throw;
        }
        if (rateHz_ > 0) info_.servoHz = info_.capability.rateHz = rateHz_;
        started_ = true;
    }

    void stop() noexcept override {
        if (stopped_) return;
        stopped_ = true;
        arm_->silence(milliseconds(started_ ? 250 : 0));
        (void)withPatience(milliseconds(600), [arm = arm_] {
            const Library& hd = arm->library;
            Desk& shared = desk();
            const std::lock_guard guard(shared.mutex);
            const Pause pause(hd);
            arm->letGo();
            if (arm->scheduled) {
                hd.unschedule(arm->job);
                --shared.scheduled;
            }
            hd.makeCurrent(arm->handle);
            hd.disable(hd::kForceOutput);
            hd.disableDevice(arm->handle);
            (void)hd.drain();
            shared.open.erase(arm->key);
        });
    }

    void relax() noexcept override {
        if (!started_ || stopped_ || arm_->relaxing.exchange(true)) return;
        // Also where no thread is to be had: asked again at the watchdog's next look.
        std::shared_ptr<Arm> once;
        try {
            once.reset(arm_, [](Arm* arm) { arm->relaxing.store(false); });
        } catch (const std::bad_alloc&) {
            return;  // reset() has called that: asked again at the next look
        }
        (void)withPatience(milliseconds(0), [once] {
            // Whoever opens or closes a device has stopped the servo anyway.
            if (const std::unique_lock guard(desk().mutex, std::try_to_lock); guard.owns_lock()) once->relax();
        });
    }

    [[nodiscard]] CalibrationState calibration() override {
        switch (arm_->calibrationAnswer()) {
            case hd::kCalibrated:
                return CalibrationState::good;
            case hd::kNeedsUpdate:
                return CalibrationState::wanted;
            default:
                return CalibrationState::wantedByHand;
        }
    }

    [[nodiscard]] std::string calibrationStep() override {
        if ((arm_->calibrationStyle() & hd::kInkwell) != 0)
            return "Put the stylus into the device's inkwell and keep it there.";
        if ((arm_->calibrationStyle() & hd::kAuto) != 0)
            return "Move the stylus slowly through its whole range until the message is gone.";
        return "Hold the arm with all its links at right angles and the stylus level, as its manual shows.";
    }

    bool calibrate() override {
        link::requireCalibratable(started_ && !stopped_, info_.model);
        unsigned error = hd::kSuccess;
        if (!arm_->calibrate(milliseconds(2000), error)) throw deaf();
        if (error != hd::kSuccess && hd::wordsOf(error).weight != hd::Weight::note)
            throw vendorError(error, info_.model);
        return arm_->calibrationAnswer() == hd::kCalibrated;
    }

  private:
    Arm* const arm_;
    link::DriverInfo info_;
    double rateHz_;
    bool started_ = false, stopped_ = false;
};

core::Error busy(const std::string& name) {
    return core::Error("this device is already open", name, "disconnect it first").as("device-busy", {name});
}

/// Initialises a device and asks it what it is. In the desk's lock.
std::unique_ptr<OpenHaptics> initialise(const Library& hd, const OpenOptions& options) {
    const std::string& which = options.which;
    Desk& shared = desk();
    // An empty name is the default device, which has names of its own in versions of the library.
    std::vector<std::string> names{which};
    if (which.empty()) names = {"", "Default Device", "Default PHANToM"};
    const bool isDefault = which.empty() || which == "Default Device" || which == "Default PHANToM";
    const std::string key = isDefault ? "" : which;
    if (shared.open.count(key) != 0) throw busy(which.empty() ? "the default device" : which);
    const Pause pause(hd);
    unsigned first = hd::kSuccess;
    (void)hd.drain();
    for (const std::string& name : names) {
        const hd::Handle handle = hd.initDevice(name.empty() ? nullptr : name.c_str());
        const unsigned code = hd.drain();
        if (handle != hd::kNoDevice && (code == hd::kSuccess || hd::wordsOf(code).weight == hd::Weight::note)) {
            hd.makeCurrent(handle);
            Arm* const arm = new Arm(hd, handle, key);  // see Arm: never freed
            link::DriverInfo info = arm->describe();
            if (info.serial.empty() && !isDefault) info.serial = which;
            shared.open.insert(key);
            return std::make_unique<OpenHaptics>(arm, std::move(info), options.servoHz);
        }
        if (first == hd::kSuccess) first = code;
        // Another name helps against a name that is not known, not against a missing licence or a device in use.
        if (code == hd::kInvalidLicence || code == hd::kAlreadyInitiated) break;
    }
    const std::string where = which.empty() ? "the default device" : which;
    if (first == hd::kSuccess || first == hd::kInvalidValue || first == hd::kBadHandle)
        throw core::Error("OpenHaptics knows no such device", where,
                          "set the device up with the vendor's program, or name one that is set up there")
            .as("no-such-device", {where, ""});
    throw vendorError(first, where);
}

/// As initialise(), but comes back when the library does not. A device that comes after that is closed again.
std::unique_ptr<OpenHaptics> initialiseWithin(milliseconds patience, const Library& hd, const OpenOptions& options) {
    const auto opened = std::make_shared<std::unique_ptr<OpenHaptics>>();
    ask(patience, [&hd, options, opened] { *opened = initialise(hd, options); });
    return std::move(*opened);
}

}  // namespace

std::string openHapticsErrorInWords(std::int32_t code) {
    const hd::ErrorWords& words = hd::wordsOf(static_cast<unsigned>(code));
    return fmt::format("{} (HD error 0x{:04X}): {}", words.sentence, static_cast<unsigned>(code), words.remedy);
}

Found lookOpenHaptics() {
    Found found;
    found.driver = "openhaptics";
    found.makes = "3D Systems Touch, Touch X, PHANToM Omni, Desktop, Premium (OpenHaptics HD)";
    try {
        const Library& hd = hd::library();
        {
            Desk& shared = desk();
            std::unique_lock guard(shared.mutex, std::try_to_lock);
            for (int i = 0; i < 100 && !guard.owns_lock(); ++i) {
                std::this_thread::sleep_for(milliseconds(5));
                (void)guard.try_lock();
            }
            if (!guard.owns_lock()) throw deaf();
            if (!shared.open.empty()) {
                found.available = true;
                for (const std::string& name : shared.open)
                    found.models.push_back(name.empty() ? "in use here" : name + " (in use here)");
                return found;
            }
        }
        found.models.push_back(initialiseWithin(milliseconds(1000), hd, {})->info().model);
        found.available = true;
    } catch (const core::Error& e) {
        found.why = e.problem();
        found.remedy = e.remedy();
    }
    return found;
}

std::unique_ptr<link::Driver> openOpenHaptics(const OpenOptions& options) {
    if (!std::isfinite(options.servoHz) || options.servoHz < 0)
        throw core::Error(fmt::format("a servo rate of {} Hz", options.servoHz), "servo rate", "give one above zero");
    return initialiseWithin(milliseconds(10'000), hd::library(), options);
}

}  // namespace handpiece::drivers
