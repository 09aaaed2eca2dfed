// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/openhaptics.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <optional>
#include <set>
#include <system_error>
#include <thread>

#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/devices/drivers/openhaptics_hd.h"

namespace handpiece::drivers {
namespace {

using hd::Library;
using link::CalibrationState;
using link::Trouble;

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

/// Runs `work` in a thread of its own and waits for so long. False: it goes on by itself, holding what it captured.
template <class Work>
bool within(double seconds, Work work) {
    struct Done {
        std::mutex mutex;
        std::condition_variable told;
        bool yes = false;
    };
    const auto done = std::make_shared<Done>();
    std::thread([done, work = std::move(work)]() mutable {
        work();
        const std::lock_guard guard(done->mutex);
        done->yes = true;
        done->told.notify_all();
    }).detach();
    std::unique_lock guard(done->mutex);
    return done->told.wait_for(guard, std::chrono::duration<double>(seconds), [&] { return done->yes; });
}

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

// ---- An arm, as the servo sees it ------------------------------------------------------------------------------

/// What callback and driver share. Never freed: the library may call back later than it should.
class Arm {
  public:
    Arm(const Library& library, hd::Handle handle) : hd_(library), handle_(handle) {}

    static unsigned HANDPIECE_HD_CALL callback(void* self) { return static_cast<Arm*>(self)->tick(); }

    void serve(link::Servo& servo) noexcept { servo_ = &servo; }
    /// From now on the force is zero and `servo` is not called again; true when a frame with zero was sent.
    bool silence(double seconds) noexcept {
        closing_.store(true);
        const std::int64_t end = rt::monotonicNs() + static_cast<std::int64_t>(seconds * 1e9);
        while (!silent_.load() && rt::monotonicNs() < end)
            std::this_thread::sleep_for(std::chrono::microseconds(200));
        // Whoever is inside exchange() now leaves it soon: it neither waits nor throws.
        int open = kOpen;
        while (!gate_.compare_exchange_weak(open, kClosed)) {
            if (open == kClosed) break;
            open = kOpen;
            std::this_thread::yield();
        }
        return silent_.load();
    }
    void letGo() noexcept { gone_.store(true); }

    /// While the servo hangs in the library: motors off. Where the current device is one for all threads, a frame that
    /// comes back to life meanwhile is refused its force (FRAME_ERROR), and no other arm is in a frame.
    void relax() noexcept {
        if (gone_.load()) return;
        hd_.makeCurrent(handle_);
        hd_.disable(hd::kForceOutput);
        (void)hd_.drain();
        relaxed_.store(true);
    }
    std::atomic<bool> relaxing{false};  ///< one at a time

    [[nodiscard]] unsigned calibrationAnswer() const noexcept { return answer_.load(); }
    /// Asks the servo to calibrate; false when it does not come round in time. The code of an error, if there was one.
    bool calibrate(double seconds, unsigned& error) noexcept {
        const std::uint32_t before = calibrated_.load();
        wanted_.store(true);
        const std::int64_t end = rt::monotonicNs() + static_cast<std::int64_t>(seconds * 1e9);
        while (calibrated_.load() == before) {
            if (rt::monotonicNs() > end) return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        error = calibrationError_.load();
        return true;
    }

    const Library& hd_;
    const hd::Handle handle_;
    int style = 0;
    bool torque = false;
    double torquePerNmm = 0.001;  // see unitOfTorque()
    hd::Job job = 0;
    bool scheduled = false;

  private:
    static constexpr int kOpen = 0, kInside = 1, kClosed = 2;

    unsigned tick() noexcept HANDPIECE_REALTIME {
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
            (void)exchange();
            return hd::kContinue;
        }
        reading_.trouble = Trouble::none;
        reading_.vendorCode = 0;
        hd_.makeCurrent(handle_);
        hd_.beginFrame(handle_);
        if (first_) {
            findOut();
            first_ = false;
        }
        readPose();
        readRest();
        calibration();
        note(pending_);
        pending_ = hd::kSuccess;
        note(hd_.drain());
        const link::DriverCommand command = exchange();
        if (relaxed_.exchange(false)) hd_.enable(hd::kForceOutput);
        send(reading_.trouble == Trouble::none ? command : link::DriverCommand{});
        hd_.endFrame(handle_);
        // What the end of the frame tells belongs to the next one; what is fatal stops this device now.
        pending_ = hd_.drain();
        if (hd::wordsOf(pending_).weight == hd::Weight::fatal && pending_ != hd::kSuccess) note(pending_);
        return hd::kContinue;
    }

    /// A frame of zero force; what it tells no longer matters.
    void sendNothing() noexcept {
        hd_.makeCurrent(handle_);
        hd_.beginFrame(handle_);
        send({});
        hd_.endFrame(handle_);
        (void)hd_.drain();
    }

    link::DriverCommand exchange() noexcept {
        int open = kOpen;
        if (!gate_.compare_exchange_strong(open, kInside)) return {};
        const link::DriverCommand command = servo_->exchange(reading_);
        gate_.store(kOpen);
        return command;
    }

    void note(unsigned code) noexcept {
        if (code == hd::kSuccess) return;
        const hd::ErrorWords& words = hd::wordsOf(code);
        reading_.vendorCode = static_cast<std::int32_t>(code);
        if (words.weight == hd::Weight::note) return;
        reading_.trouble = words.trouble;
        if (words.weight == hd::Weight::fatal) dead_ = true;
    }

    /// What this model does not have is refused once, here, and not asked for again.
    void findOut() noexcept {
        note(hd_.drain());
        double temperatures[8] = {};
        hd_.getDouble(hd::kMotorTemperature, temperatures);
        hasTemperature_ = hd_.drain() == hd::kSuccess;
        hd::Boolean on = 0;
        hd_.getBoolean(hd::kSafetySwitch, &on);
        hasSafetySwitch_ = hd_.drain() == hd::kSuccess;
        hd_.getBoolean(hd::kInkwellSwitch, &on);
        hasInkwellSwitch_ = hd_.drain() == hd::kSuccess;
    }

    void readPose() noexcept {
        double m[16] = {};  // column-major, millimetres: our frame already
        hd_.getDouble(hd::kTransform, m);
        for (const double v : m) {
            if (!std::isfinite(v)) {
                reading_.trouble = Trouble::notFinite;
                return;
            }
        }
        core::Mat3 turn;
        turn << m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10];
        if ((turn.transpose() * turn - core::Mat3::Identity()).cwiseAbs().maxCoeff() > 1e-3 ||
            turn.determinant() <= 0) {
            reading_.trouble = Trouble::badData;
            return;
        }
        const core::Quat q = core::Quat(turn).normalized();
        reading_.positionMm = {m[12], m[13], m[14]};
        reading_.orientation = {q.w(), q.x(), q.y(), q.z()};
    }

    void readRest() noexcept {
        int buttons = 0;
        hd_.getInteger(hd::kButtons, &buttons);
        reading_.buttons = static_cast<std::uint32_t>(buttons) & 0xFu;
        if (hasTemperature_) {
            double hottest = 0.0, all[8] = {};
            hd_.getDouble(hd::kMotorTemperature, all);
            for (const double t : all)
                if (t > hottest) hottest = t;
            reading_.motorTemperature = static_cast<float>(hottest);
        }
        // Not every model that answers has the switch: only one that was seen in the good state counts.
        hd::Boolean on = 0;
        if (hasSafetySwitch_) {
            hd_.getBoolean(hd::kSafetySwitch, &on);
            seenHeld_ = seenHeld_ || on != 0;
            if (seenHeld_ && on == 0) mistrust(Trouble::inputLost);
        }
        if (hasInkwellSwitch_) {
            on = 0;
            hd_.getBoolean(hd::kInkwellSwitch, &on);
            seenOut_ = seenOut_ || on == 0;
            if (seenOut_ && on != 0) mistrust(Trouble::inputLost);
        }
    }

    void calibration() noexcept {
        const bool asked = wanted_.exchange(false);
        if (!asked && reading_.frame % 50 != 1) {
            if (answer_.load() != hd::kCalibrated) mistrust(Trouble::notCalibrated);
            return;
        }
        note(hd_.drain());
        unsigned answer = hd_.checkCalibration(), error = hd_.drain();
        const bool byItself = (style & hd::kAuto) != 0 && answer == hd::kNeedsUpdate;
        const bool byHand = asked && (answer == hd::kNeedsUpdate ||
                                      (answer == hd::kNeedsHand && (style & (hd::kInkwell | hd::kAuto)) == 0));
        if (error == hd::kSuccess && (byItself || byHand)) {
            // The pose jumps when its origin is found: this frame pushes nothing.
            mistrust(Trouble::notCalibrated);
            hd_.updateCalibration(static_cast<unsigned>((style & hd::kInkwell) != 0 ? hd::kInkwell
                                                        : (style & hd::kAuto) != 0  ? hd::kAuto
                                                                                    : hd::kEncoderReset));
            error = hd_.drain();
            answer = hd_.checkCalibration();
            if (error == hd::kSuccess) error = hd_.drain();
        }
        note(error);
        answer_.store(answer);
        if (answer != hd::kCalibrated) mistrust(Trouble::notCalibrated);
        if (asked) {
            calibrationError_.store(error);
            calibrated_.fetch_add(1);
        }
    }

    void mistrust(Trouble trouble) noexcept {
        if (reading_.trouble == Trouble::none) reading_.trouble = trouble;
    }

    void send(const link::DriverCommand& command) noexcept {
        hd_.setDouble(hd::kForce, command.forceN.data());
        if (!torque) return;
        const double scaled[3] = {command.torqueNmm[0] * torquePerNmm, command.torqueNmm[1] * torquePerNmm,
                                  command.torqueNmm[2] * torquePerNmm};
        hd_.setDouble(hd::kTorque, scaled);
    }

    link::Servo* servo_ = nullptr;
    link::DriverReading reading_;
    unsigned pending_ = hd::kSuccess;
    bool first_ = true, dead_ = false, lastZero_ = false, seenHeld_ = false, seenOut_ = false;
    bool hasTemperature_ = false, hasSafetySwitch_ = false, hasInkwellSwitch_ = false;
    std::atomic<bool> closing_{false}, silent_{false}, gone_{false}, wanted_{false}, relaxed_{false};
    std::atomic<int> gate_{kOpen};
    std::atomic<unsigned> answer_{hd::kCalibrated}, calibrationError_{hd::kSuccess};
    std::atomic<std::uint32_t> calibrated_{0};
};

// ---- Opening ---------------------------------------------------------------------------------------------------

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

link::DriverInfo describe(const Library& hd, Arm& arm) {
    link::DriverInfo info;
    info.driver = "openhaptics";
    info.model = text(hd, hd::kModel);
    if (info.model.empty()) info.model = "unknown model";
    info.serial = text(hd, hd::kSerial);
    info.version = "HD " + text(hd, hd::kVersion);
    if (const std::string driver = text(hd, hd::kDriverVersion); !driver.empty()) info.version += ", driver " + driver;
    if (const auto firmware = number(hd, hd::kFirmware, 1e9)) info.version += fmt::format(", firmware {:g}", *firmware);

    const Model& known = modelOf(info.model);
    device::Capability c = known.capability;
    std::string told;
    const auto tell = [&](const char* what) { told += (told.empty() ? "" : ", ") + std::string(what); };
    if (const auto v = number(hd, hd::kNominalMaxForce, 100.0)) c.maxForceN = *v, tell("largest force");
    if (const auto v = number(hd, hd::kNominalContinuousForce, c.maxForceN)) {
        c.continuousForceN = *v;
        tell("continuous force");
    }
    c.continuousForceN = std::min(c.continuousForceN, c.maxForceN);
    if (const auto v = number(hd, hd::kNominalMaxStiffness, 100.0); v && *v < c.maxStiffnessNPerMm) {
        c.maxStiffnessNPerMm = *v;
        tell("stiffness");
    }
    double box[6] = {};
    hd.getDouble(hd::kUsableWorkspace, box);
    if (hd.drain() == hd::kSuccess) {
        const core::Vec3 size(box[3] - box[0], box[4] - box[1], box[5] - box[2]);
        if (size.allFinite() && size.minCoeff() > 1.0 && size.maxCoeff() < 5000.0)
            c.workspaceMm = size, tell("workspace");
    }
    c.sensedAxes = integer(hd, hd::kInputAxes).value_or(6);
    c.drivenAxes = integer(hd, hd::kOutputAxes).value_or(3);
    arm.torque = c.drivenAxes >= 6 && c.maxTorqueNmm > 0;
    arm.torquePerNmm = unitOfTorque();
    if (!arm.torque) c.maxTorqueNmm = 0.0;
    c.rateHz = integer(hd, hd::kUpdateRate).value_or(1000);
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
    arm.style = integer(hd, hd::kCalibrationStyle).value_or(0);
    return info;
}

class OpenHaptics final : public link::Driver {
  public:
    OpenHaptics(const Library& library, Arm* arm, link::DriverInfo info, std::string key, double rateHz)
        : hd_(library), arm_(arm), info_(std::move(info)), key_(std::move(key)), rateHz_(rateHz) {}
    ~OpenHaptics() override { stop(); }

    [[nodiscard]] const link::DriverInfo& info() const noexcept override { return info_; }

    void start(link::Servo& servo) override {
        if (stopped_) throw core::Error("this device was closed", info_.model, "open it again").as("device-stopped");
        if (started_)
            throw core::Error("this device has started already", info_.model, "stop it first").as("device-started");
        arm_->serve(servo);
        const auto failed = std::make_shared<std::optional<core::Error>>();
        const bool answered = within(5.0, [this, failed] {
            try {
                begin();
            } catch (const core::Error& e) {
                *failed = e;
            }
        });
        if (!answered) throw deaf();
        if (*failed) throw core::Error(**failed);
        started_ = true;
    }

    void stop() noexcept override {
        if (stopped_) return;
        stopped_ = true;
        if (started_) (void)arm_->silence(0.25);
        (void)within(0.6, [&hd = hd_, arm = arm_, key = key_] {
            Desk& shared = desk();
            const std::lock_guard guard(shared.mutex);
            const Pause pause(hd);
            arm->letGo();
            if (arm->scheduled) {
                hd.unschedule(arm->job);
                --shared.scheduled;
            }
            hd.makeCurrent(arm->handle_);
            hd.disable(hd::kForceOutput);
            hd.disableDevice(arm->handle_);
            (void)hd.drain();
            shared.open.erase(key);
        });
    }

    void relax() noexcept override {
        if (!started_ || stopped_ || arm_->relaxing.exchange(true)) return;
        try {
            std::thread([arm = arm_] {
                // Whoever opens or closes a device has stopped the servo anyway.
                if (const std::unique_lock guard(desk().mutex, std::try_to_lock); guard.owns_lock()) arm->relax();
                arm->relaxing.store(false);
            }).detach();
        } catch (const std::system_error&) {
            arm_->relaxing.store(false);  // no thread to be had: asked again at the watchdog's next look
        }
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
        if ((arm_->style & hd::kInkwell) != 0) return "Put the stylus into the device's inkwell and keep it there.";
        if ((arm_->style & hd::kAuto) != 0)
            return "Move the stylus slowly through its whole range until the message is gone.";
        return "Hold the arm with all its links at right angles and the stylus level, as its manual shows.";
    }

    bool calibrate() override {
        if (!started_ || stopped_)
            throw core::Error("the device cannot be calibrated before it is started", info_.model, "start it first");
        unsigned error = hd::kSuccess;
        if (!arm_->calibrate(2.0, error)) throw deaf();
        if (error != hd::kSuccess && hd::wordsOf(error).weight != hd::Weight::note)
            throw vendorError(error, info_.model);
        return arm_->calibrationAnswer() == hd::kCalibrated;
    }

  private:
    void begin() {
        Desk& shared = desk();
        const std::lock_guard guard(shared.mutex);
        const auto check = [&] {
            const unsigned code = hd_.drain();
            if (code != hd::kSuccess && hd::wordsOf(code).weight != hd::Weight::note)
                throw vendorError(code, info_.model);
            return code;
        };
        std::optional<Pause> pause(hd_);
        hd_.makeCurrent(arm_->handle_);
        if (rateHz_ > 0) {
            if (shared.scheduled > 0 && shared.rateHz != rateHz_)
                throw core::Error(fmt::format("all devices of OpenHaptics share one servo, which runs at {} Hz",
                                              shared.rateHz > 0 ? shared.rateHz : info_.servoHz),
                                  info_.model, "ask for the same rate for all of them");
            if (shared.scheduled == 0) {
                hd_.setSchedulerRate(static_cast<unsigned long>(rateHz_ + 0.5));
                if (check() != hd::kSuccess)
                    throw core::Error(fmt::format("the device has no servo rate of {} Hz", rateHz_), info_.model,
                                      "500 and 1000 Hz are there on every device; leave the rate out for its own");
                info_.servoHz = info_.capability.rateHz = rateHz_;
            }
        }
        hd_.enable(hd::kForceOutput);
        (void)check();
        for (const unsigned limit : {hd::kForceClamping, hd::kForceRamping, hd::kSoftwareForceLimit}) {
            hd_.enable(limit);
            (void)hd_.drain();  // on by default; a model without it refuses the name
        }
        arm_->job = hd_.scheduleAsynchronous(&Arm::callback, arm_, hd::kPriority);
        (void)check();
        arm_->scheduled = true;
        if (shared.scheduled++ == 0) shared.rateHz = rateHz_;
        pause.reset();  // starts the scheduler
        (void)check();
    }

    const Library& hd_;
    Arm* const arm_;
    link::DriverInfo info_;
    std::string key_;
    double rateHz_;
    bool started_ = false, stopped_ = false;
};

struct Opened {
    Arm* arm = nullptr;
    link::DriverInfo info;
    std::string key;
};

core::Error busy(const std::string& name) {
    return core::Error("this device is already open", name, "disconnect it first").as("device-busy", {name});
}

/// Initialises a device and asks it what it is. In the desk's lock.
Opened initialise(const Library& hd, const std::string& which) {
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
            Opened opened{new Arm(hd, handle), {}, key};  // see Arm: never freed
            opened.info = describe(hd, *opened.arm);
            if (opened.info.serial.empty() && !isDefault) opened.info.serial = which;
            shared.open.insert(key);
            return opened;
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

/// As initialise(), but comes back when the library does not.
Opened initialiseWithin(double seconds, const Library& hd, const std::string& which) {
    struct Result {
        Opened opened;
        std::optional<core::Error> failed;
    };
    const auto result = std::make_shared<Result>();
    const bool answered = within(seconds, [&hd, which, result] {
        const std::lock_guard guard(desk().mutex);
        try {
            result->opened = initialise(hd, which);
        } catch (const core::Error& e) {
            result->failed = e;
        }
    });
    if (!answered) throw deaf();
    if (result->failed) throw core::Error(*result->failed);
    return std::move(result->opened);
}

}  // namespace

device::Capability openHapticsCapability(std::string_view vendorsName) {
    return modelOf(vendorsName).capability;
}

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
                std::this_thread::sleep_for(std::chrono::milliseconds(5));
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
        Opened opened = initialiseWithin(1.0, hd, "");
        found.models.push_back(opened.info.model);
        found.available = true;
        OpenHaptics(hd, opened.arm, opened.info, opened.key, 0.0).stop();
    } catch (const core::Error& e) {
        found.why = e.problem();
        found.remedy = e.remedy();
    }
    return found;
}

std::unique_ptr<link::Driver> openOpenHaptics(const OpenOptions& options) {
    if (!std::isfinite(options.servoHz) || options.servoHz < 0)
        throw core::Error(fmt::format("a servo rate of {} Hz", options.servoHz), "servo rate", "give one above zero");
    const Library& hd = hd::library();
    Opened opened = initialiseWithin(10.0, hd, options.which);
    return std::make_unique<OpenHaptics>(hd, opened.arm, std::move(opened.info), std::move(opened.key),
                                         options.servoHz);
}

}  // namespace handpiece::drivers
