// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/haply.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <string_view>

#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/base/rt/realtime_thread.h"
#include "handpiece/devices/drivers/haply_state.h"
#include "handpiece/devices/drivers/websocket.h"

namespace handpiece::drivers {
namespace {

using link::DeviceFault;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kLookNs = 90 * kMs;      // a service on this machine answers in less than one
constexpr std::int64_t kOpenNs = 2'000 * kMs;   // one that is just starting
constexpr std::int64_t kLateNs = 3 * kMs;       // no answer for so long: it stands
constexpr std::int64_t kGoneNs = 1'000 * kMs;   // and for so long: it is given up and connected to anew
constexpr std::int64_t kAgainNs = 250 * kMs;    // between two tries
constexpr std::int64_t kGoodbyeNs = 200 * kMs;  // for the last zero force
constexpr int kMaxUnanswered = 8;
constexpr const char* kUrl = "ws://localhost:10001";
constexpr const char* kRemedy =
    "start Haply Hub or the service (systemctl start haply-inverse-service), or name its address in "
    "HANDPIECE_HAPLY_URL";

std::string address() {
    const char* const url = std::getenv("HANDPIECE_HAPLY_URL");
    return url != nullptr && *url != '\0' ? url : kUrl;
}

/// A service on another machine is spoken to where somebody said that this is meant.
WebSocket::Reach reach() {
    const char* const said = std::getenv("HANDPIECE_HAPLY_REMOTE");
    return said != nullptr && std::string_view(said) == "1" ? WebSocket::Reach::anywhere
                                                            : WebSocket::Reach::thisMachine;
}

/// Connects and reads the first message: everything there is.
std::unique_ptr<WebSocket> connect(const std::string& url, std::int64_t timeoutNs, HaplyState& state) {
    const std::int64_t deadline = rt::monotonicNs() + timeoutNs;
    auto socket = std::make_unique<WebSocket>(url, timeoutNs, kRemedy, reach());
    std::string_view text;
    const WebSocket::Got got = socket->receive(std::max<std::int64_t>(kMs, deadline - rt::monotonicNs()), text);
    if (got == WebSocket::Got::nothing)
        throw core::Error("the service at this address does not say which devices it has", url, kRemedy)
            .as("haply-silent", {url});
    if (got != WebSocket::Got::message || !readHaplyState(text, state))
        throw core::Error("the service at this address is not Haply's, or sends what cannot be read", url,
                          "update Haply Hub; check the address in HANDPIECE_HAPLY_URL")
            .as("haply-garbage", {url});
    return socket;
}

std::string modelOf(const HaplyArm& arm) {
    const std::string_view type = textOf(arm.type);
    if (type == "inverse3" || type.empty()) return "Haply Inverse3";
    if (type == "inverse3x") return "Haply Inverse3x";
    if (type == "minverse") return "Haply Minverse";
    return "Haply " + std::string(type);
}

/// Out of the service's axes (+x right, +y away from the user, +z up) into ours (+x right, +y up, +z to the user). The
/// grip's own axes turn in the same way: it points along its +y [docs.haply.co], which is our stylus' -z.
std::array<double, 3> ours(const std::array<double, 3>& v) noexcept {
    return {v[0], v[2], -v[1]};
}
std::array<double, 3> theirs(const std::array<double, 3>& v) noexcept {
    return {v[0], -v[2], v[1]};
}

class HaplyDriver final : public link::Driver {
  public:
    HaplyDriver(const OpenOptions& options, const std::string& url);
    ~HaplyDriver() override { stop(); }

    [[nodiscard]] const link::DriverInfo& info() const noexcept override { return info_; }
    void start(link::Servo& servo) override;
    void stop() noexcept override;
    [[nodiscard]] link::CalibrationState calibration() override {
        return calibrated_.load() ? link::CalibrationState::good : link::CalibrationState::wantedByHand;
    }
    [[nodiscard]] std::string calibrationStep() override {
        return "Set the handle into the inkwell of the arm and wait until its light says that it is ready.";
    }
    bool calibrate() override {
        link::requireCalibratable(servo_ != nullptr && !stopped_, info_.model);
        return calibrated_.load();  // the service does it by itself, in the inkwell
    }

  private:
    void choose(const OpenOptions& options, const std::string& url);
    void describe();
    void run(std::int64_t periodNs) noexcept;
    void connectAgain() noexcept;
    void understand(std::string_view text) noexcept;
    void tell(DeviceFault trouble, int code = 0) noexcept;
    void send() noexcept;
    void lose(DeviceFault trouble) noexcept;
    void sayGoodbye() noexcept;

    link::DriverInfo info_;
    std::string id_, gripId_, url_;
    bool newer_ = false;
    std::unique_ptr<WebSocket> socket_;
    HaplyState state_;
    std::unique_ptr<rt::RealtimeThread> thread_;
    std::atomic<bool> stopping_{false}, calibrated_{true};
    bool stopped_ = false;
    link::Servo* servo_ = nullptr;
    double servoHz_ = 1000.0;

    // The servo thread's own.
    link::DriverReading reading_;
    link::DriverCommand command_;
    int unanswered_ = 0;
    bool zeroSent_ = false;
    std::int64_t askedNs_ = 0, triedNs_ = 0;
    std::array<char, 512> message_{};
};

HaplyDriver::HaplyDriver(const OpenOptions& options, const std::string& url) {
    servoHz_ = options.servoHz > 0.0 ? options.servoHz : 1000.0;
    if (!(servoHz_ >= 50.0 && servoHz_ <= 8000.0))
        throw core::Error(fmt::format("a servo rate of {} Hz", servoHz_), "haply", "ask for 50 to 8000 Hz")
            .as("servo-rate", {fmt::format("{}", servoHz_)});
    choose(options, url);
    describe();
}

void HaplyDriver::choose(const OpenOptions& options, const std::string& url) {
    socket_ = connect(url, kOpenNs, state_);
    url_ = socket_->numericUrl();
    if (state_.armCount == 0)
        throw core::Error("Haply's service runs, but no Inverse3 is connected to it", url,
                          "check its USB cable and its power supply; Haply Hub shows it when it is there")
            .as("device-missing", {"Inverse3"});
    const std::string id = options.which.empty() ? std::string(textOf(state_.arms[0].id)) : options.which;
    const auto there = [&] {
        std::string all;
        for (std::size_t i = 0; i < state_.armCount; ++i)
            all += (i > 0 ? ", " : "") + std::string(textOf(state_.arms[i].id));
        return all;
    };
    if (state_.arm(id) == nullptr)
        throw core::Error(fmt::format("there is no Inverse3 called '{}'", id), url,
                          fmt::format("there are {}", there()))
            .as("device-missing", {id});
    // A program that has just let go of it may not have been noticed yet.
    const std::int64_t patience = rt::monotonicNs() + 600 * kMs;
    while (state_.arm(id) != nullptr && state_.arm(id)->inUse == Said::yes) {
        if (rt::monotonicNs() > patience)
            throw core::Error(fmt::format("another program uses the Inverse3 '{}'", id), url,
                              "close the other program, or the demo that Haply Hub shows; then try again")
                .as("device-busy", {id});
        socket_.reset();
        const timespec pause{0, 50 * kMs};
        ::nanosleep(&pause, nullptr);
        socket_ = connect(url_, kOpenNs, state_);
    }
    const HaplyArm* const arm = state_.arm(id);
    if (arm == nullptr)
        throw core::Error(fmt::format("the Inverse3 '{}' went away", id), url, "check its USB cable")
            .as("device-missing", {id});
    const std::string_view basis = textOf(arm->basis);
    if ((!basis.empty() && basis != "XYZ") || arm->scaled)
        throw core::Error("Haply's service is set to turn or scale the arm's movements", url,
                          "set basis, mount and workspace transform of the device back in Haply Hub")
            .as("haply-basis", {std::string(basis)});
    id_ = id;
    newer_ = state_.hasSession;
    calibrated_ = arm->calibrated != Said::no;
    // Which grip is held at which arm is not told: the wireless ones first, in the order of the arms.
    std::array<const HaplyGrip*, HaplyState::kMost> grips{};
    std::size_t count = 0;
    for (const bool wireless : {true, false})
        for (std::size_t i = 0; i < state_.gripCount; ++i)
            if (state_.grips[i].wireless == wireless) grips[count++] = &state_.grips[i];
    const auto index = static_cast<std::size_t>(arm - state_.arms.data());
    if (count > 0) gripId_ = textOf(grips[std::min(index, count - 1)]->id);
}

void HaplyDriver::describe() {
    const HaplyArm& arm = *state_.arm(id_);
    const bool small = textOf(arm.type) == "minverse";
    info_.driver = "haply";
    info_.model = modelOf(arm);
    info_.serial = id_;
    const std::string_view firmware = textOf(arm.firmware);
    info_.version = fmt::format("service {}{}{}", newer_ ? "3.5 or later" : "before 3.5",
                                firmware.empty() ? "" : ", firmware ", firmware);
    info_.hasOrientation = !gripId_.empty();
    info_.servoHz = servoHz_;
    device::Capability& c = info_.capability;
    c.name = info_.model;
    c.maxForceN = 2.0;           // what IsaacLab's client asks of it at most; the arm can do more [R]
    c.continuousForceN = 1.0;    // [R]
    c.maxStiffnessNPerMm = 0.5;  // [R]
    c.maxDampingNSPerMm = 0.002;
    c.maxForceSlopeNPerS = 2000;
    c.maxTorqueNmm = 0.0;
    c.encoderStepMm = 0.02;  // [R]
    c.workspaceMm = core::Vec3::Constant(small ? 80.0 : 200.0);
    c.sensedAxes = gripId_.empty() ? 3 : 6;
    c.drivenAxes = 3;
    c.rateHz = servoHz_;
    info_.sources =
        "force as IsaacLab's client limits it, workspace as Haply's tutorials do; continuous force, stiffness, "
        "damping, "
        "slope and resolution unchecked";
}

void HaplyDriver::start(link::Servo& servo) {
    link::requireStartable(servo_ != nullptr, stopped_, info_.model);
    const auto periodNs = static_cast<std::int64_t>(1e9 / servoHz_);
    servo_ = &servo;
    thread_ = std::make_unique<rt::RealtimeThread>([this, periodNs] { run(periodNs); });
}

void HaplyDriver::stop() noexcept {
    stopped_ = true;
    stopping_ = true;
    thread_.reset();  // every wait of the thread has a deadline
    socket_.reset();
}

/// One frame: what was last answered is sent, the service answers with a state, the gate answers that. Between frames
/// the thread sleeps to the next beat; it allocates only when it connects anew.
void HaplyDriver::run(std::int64_t periodNs) noexcept {
    rt::PeriodicClock clock(periodNs);
    clock.start();
    if (socket_) send();
    while (!stopping_.load(std::memory_order_acquire)) {
        if (!socket_) {
            if (rt::monotonicNs() - triedNs_ > kAgainNs) connectAgain();
            if (!socket_) tell(DeviceFault::unplugged);
            clock.wait();
            continue;
        }
        std::string_view text;
        switch (socket_->receive(zeroSent_ || unanswered_ > 1 ? kMs : kLateNs, text)) {
            case WebSocket::Got::message:
                unanswered_ = std::max(0, unanswered_ - 1);
                askedNs_ = rt::monotonicNs();
                zeroSent_ = false;
                understand(text);
                // Answers to what was sent while it stood come first; the next question follows the last of them.
                if (unanswered_ == 0 && socket_) {
                    clock.wait();
                    send();
                }
                break;
            case WebSocket::Got::nothing:
                if (rt::monotonicNs() - askedNs_ > kGoneNs) {
                    lose(DeviceFault::unplugged);
                    break;
                }
                tell(DeviceFault::stalled);
                // The gate fades out: that is said once, for when the service goes on. No heap of messages.
                if (!zeroSent_ && unanswered_ < kMaxUnanswered) send();
                break;
            case WebSocket::Got::closed:
                lose(DeviceFault::unplugged);
                break;
            case WebSocket::Got::broken:
                lose(DeviceFault::badData);
                break;
        }
    }
    sayGoodbye();
}

void HaplyDriver::connectAgain() noexcept {
    triedNs_ = rt::monotonicNs();
    try {
        auto socket = connect(url_, kLookNs, state_);
        const HaplyArm* const arm = state_.arm(id_);
        if (arm == nullptr || arm->inUse == Said::yes) return;
        socket_ = std::move(socket);
        newer_ = state_.hasSession;
        unanswered_ = 0;
        zeroSent_ = false;
        command_ = {};
        send();
    } catch (const std::exception&) {
        // Still gone, or no memory for it: the trouble is told every frame, and the next try comes.
    }
}

void HaplyDriver::lose(DeviceFault trouble) noexcept {
    socket_.reset();
    unanswered_ = 0;
    zeroSent_ = false;
    triedNs_ = rt::monotonicNs();
    tell(trouble);
}

void HaplyDriver::tell(DeviceFault trouble, int code) noexcept {
    reading_.timeNs = rt::monotonicNs();
    ++reading_.frame;
    reading_.trouble = trouble;
    reading_.vendorCode = code;
    command_ = servo_->exchange(reading_);
}

void HaplyDriver::understand(std::string_view text) noexcept {
    if (!readHaplyState(text, state_)) return tell(DeviceFault::badData);
    const HaplyArm* const arm = state_.arm(id_);
    if (arm == nullptr) return tell(DeviceFault::unplugged);
    if (!arm->hasPosition) return tell(DeviceFault::badData);
    const std::array<double, 3> at = ours(arm->positionM);
    for (std::size_t i = 0; i < 3; ++i)
        reading_.positionMm[i] = 1e3 * at[i];
    const HaplyGrip* const grip = gripId_.empty() ? nullptr : state_.grip(gripId_);
    if (grip != nullptr) {
        reading_.buttons = grip->buttons;
        if (grip->hasOrientation) {
            const auto& [w, x, y, z] = grip->orientation;
            const double size = std::sqrt(w * w + x * x + y * y + z * z);
            if (!(size > 0.5 && size < 2.0)) return tell(DeviceFault::badData);
            const std::array<double, 3> v = ours({x / size, y / size, z / size});
            reading_.orientation = {w / size, v[0], v[1], v[2]};
        }
    }
    if (arm->calibrated != Said::nothing) calibrated_.store(arm->calibrated == Said::yes, std::memory_order_relaxed);
    if (arm->powered == Said::no) return tell(DeviceFault::vendorError, kHaplyNoPower);
    if (arm->ready == Said::no) return tell(DeviceFault::vendorError, kHaplyNotReady);
    if (arm->calibrated == Said::no) return tell(DeviceFault::notCalibrated);
    if (!gripId_.empty() && (grip == nullptr || !grip->hasOrientation)) return tell(DeviceFault::inputLost);
    tell(DeviceFault::none);
}

/// What the gate answered last; nothing else is ever sent.
void HaplyDriver::send() noexcept {
    const std::size_t size = writeHaplyForce(id_, theirs(command_.forceN), newer_, message_.data(), message_.size());
    if (size == 0 || !socket_->send({message_.data(), size}, kLateNs)) return lose(DeviceFault::unplugged);
    if (unanswered_++ == 0) askedNs_ = rt::monotonicNs();
    zeroSent_ = command_.forceN == std::array<double, 3>{} && unanswered_ > 1;
}

void HaplyDriver::sayGoodbye() noexcept {
    if (!socket_) return;
    command_ = {};
    const std::size_t size = writeHaplyForce(id_, command_.forceN, newer_, message_.data(), message_.size());
    const std::int64_t deadline = rt::monotonicNs() + kGoodbyeNs;
    if (!socket_->send({message_.data(), size}, kGoodbyeNs)) return;
    std::string_view text;
    for (++unanswered_; unanswered_ > 0; --unanswered_)
        if (socket_->receive(std::max<std::int64_t>(0, deadline - rt::monotonicNs()), text) != WebSocket::Got::message)
            break;
    socket_->close();
}

}  // namespace

std::string haplyErrorInWords(std::int32_t code) {
    switch (code) {
        case kHaplyNotReady:
            return "The arm says that it is not ready; wait, or switch it off and on.";
        case kHaplyNoPower:
            return "The arm has no power for its motors; plug in its power supply.";
        default:
            return {};
    }
}

Found lookHaply() {
    Found found;
    found.driver = "haply";
    found.makes = "Haply Inverse3, Inverse3x, Minverse and VerseGrip (Haply's service)";
    try {
        HaplyState state;
        (void)connect(address(), kLookNs, state);
        for (std::size_t i = 0; i < state.armCount; ++i) {
            found.models.push_back(fmt::format("{} {}", modelOf(state.arms[i]), textOf(state.arms[i].id)));
            found.units.push_back({std::string(textOf(state.arms[i].id)), found.models.back()});
        }
        found.available = !found.models.empty();
        if (!found.available) {
            found.why = "Haply's service runs, but no Inverse3 is connected to it.";
            found.remedy = "Check its USB cable and its power supply.";
        }
    } catch (const core::Error& e) {
        found.why = fmt::format("{}: {}.", e.where(), e.problem());
        found.remedy = e.remedy();
    }
    return found;
}

std::unique_ptr<link::Driver> openHaply(const OpenOptions& options) {
    return std::make_unique<HaplyDriver>(options, address());
}

}  // namespace handpiece::drivers
