// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/gamepad.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/devices/drivers/rate_hand.h"
#include "handpiece/devices/drivers/sdl_library.h"
#include "handpiece/devices/drivers/servo_thread.h"

namespace handpiece::drivers {
namespace {

using core::Vec3;
using link::DeviceFault;
using Sdl = SdlLibrary;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kAgainNs = 250 * kMs;
constexpr std::int64_t kRumbleNs = 30 * kMs;  // between two commands to its motors, which take time to turn
constexpr std::uint32_t kRumbleMs = 100;      // it ends by itself when nobody says it again
constexpr double kStrongestN = 3.3;           // of a force without vibration: shaken as hard as it can
constexpr double kPedalDead = 0.03;
/// Our bits: the upper button cuts, the lower undoes, the clutch, then as they come.
constexpr std::array<int, 7> kButtons{Sdl::kA, Sdl::kB, Sdl::kRightShoulder, Sdl::kX, Sdl::kY, Sdl::kBack, Sdl::kStart};

double unit(std::int16_t value) noexcept {
    return std::clamp(static_cast<double>(value) / 32767.0, -1.0, 1.0);
}

/// Indices of the gamepads among SDL's joysticks.
std::vector<int> controllers(const Sdl& sdl) {
    std::vector<int> found;
    for (int i = 0; i < sdl.count(); ++i)
        if (sdl.isController(i)) found.push_back(i);
    return found;
}

/// The pad that is meant, or none (-1).
int choose(const Sdl& sdl, const std::string& which) {
    const std::vector<int> found = controllers(sdl);
    if (found.empty()) return -1;
    if (which.empty()) return found.front();
    if (which.front() == '#') {
        for (std::size_t i = 0; i < found.size(); ++i)
            if (which == fmt::format("#{}", i + 1)) return found[i];
        return -1;
    }
    for (const int index : found)
        if (sdl.nameOf(index).find(which) != std::string::npos) return index;
    return -1;
}

/// What the thread works on. Outlives the driver when SDL hangs in a device's own driver.
struct Pad {
    const Sdl* sdl = nullptr;
    std::string which;
    Sdl::Controller* controller = nullptr;
    std::unique_ptr<ServoPort> door;
    RateHand hand{RateHandSettings{}};
    link::DriverReading reading;
    std::int64_t lastNs = 0, triedNs = 0, rumbledNs = 0;
    std::uint16_t shaking = 0;

    ~Pad() { close(); }
    void close() noexcept {
        if (controller != nullptr) sdl->closeController(controller);
        controller = nullptr;
    }
    void frame() noexcept;
    void read(double dtS) noexcept;
    void shake(const link::DriverCommand& command) noexcept;
    void last() noexcept {
        if (controller != nullptr) (void)sdl->rumble(controller, 0, 0, 0);
        close();
    }
};

void Pad::frame() noexcept {
    sdl->update();
    const std::int64_t now = rt::monotonicNs();
    if (controller != nullptr && !sdl->controllerAttached(controller)) {
        close();
        triedNs = now;
    }
    if (controller == nullptr && now - triedNs > kAgainNs) {
        triedNs = now;
        if (const int index = choose(*sdl, which); index >= 0) controller = sdl->openController(index);
        lastNs = now;
    }
    if (controller != nullptr) {
        read(lastNs == 0 ? 0.0 : static_cast<double>(now - lastNs) * 1e-9);
    } else {
        reading.buttons = 0;
        reading.pedal = 0.0f;
    }
    lastNs = now;
    reading.timeNs = now;
    ++reading.frame;
    reading.trouble = controller != nullptr ? DeviceFault::none : DeviceFault::unplugged;
    shake(door->exchange(reading));
}

void Pad::read(double dtS) noexcept {
    const auto axis = [&](int number) { return unit(sdl->controllerAxis(controller, number)); };
    const auto down = [&](int number) { return sdl->controllerButton(controller, number) != 0; };
    reading.buttons = 0;
    for (std::size_t bit = 0; bit < kButtons.size(); ++bit)
        if (down(kButtons[bit])) reading.buttons |= 1u << bit;
    const double trigger = std::max(0.0, axis(Sdl::kRightTrigger));
    const double pedal = trigger > kPedalDead ? (trigger - kPedalDead) / (1.0 - kPedalDead) : 0.0;
    reading.pedal = static_cast<float>(down(Sdl::kA) ? 1.0 : pedal);
    const double lift = (down(Sdl::kLeftShoulder) ? 1.0 : 0.0) - std::max(0.0, axis(Sdl::kLeftTrigger));
    const double yaw = (down(Sdl::kLeft) ? 1.0 : 0.0) - (down(Sdl::kRight) ? 1.0 : 0.0);
    hand.step(Vec3(axis(Sdl::kLeftX), lift, axis(Sdl::kLeftY)), Vec3(axis(Sdl::kRightY), yaw, -axis(Sdl::kRightX)),
              down(Sdl::kY), dtS);
    hand.tell(reading);
}

/// A force can only be told by shaking.
void Pad::shake(const link::DriverCommand& command) noexcept {
    const double force = core::hypot(command.forceN[0], command.forceN[1], command.forceN[2]) / kStrongestN;
    double strength = std::max(static_cast<double>(command.vibration), force);
    strength = strength > 0.0 ? std::min(strength, 1.0) : 0.0;  // what is no number is none
    const auto wanted = static_cast<std::uint16_t>(std::lround(strength * 65535.0));
    if (controller == nullptr || (wanted == 0 && shaking == 0)) return;
    if (reading.timeNs - rumbledNs < kRumbleNs && (wanted != 0 || shaking == 0)) return;
    rumbledNs = reading.timeNs;
    shaking = wanted;
    (void)sdl->rumble(controller, wanted, static_cast<std::uint16_t>(wanted / 2), kRumbleMs);  // not all can
}

class GamepadDriver final : public link::Driver {
  public:
    explicit GamepadDriver(const OpenOptions& options);
    ~GamepadDriver() override { stop(); }
    [[nodiscard]] const link::DriverInfo& info() const noexcept override { return info_; }
    void start(link::Servo& servo) override;
    void stop() noexcept override;

  private:
    link::DriverInfo info_;
    std::shared_ptr<Pad> pad_ = std::make_shared<Pad>();
    std::unique_ptr<ServoThread> thread_;
    bool started_ = false, stopped_ = false;
};

GamepadDriver::GamepadDriver(const OpenOptions& options) {
    info_.servoHz = options.servoHz > 0.0 ? options.servoHz : 250.0;
    if (!(info_.servoHz >= 20.0 && info_.servoHz <= 1000.0))
        throw core::Error(fmt::format("a rate of {} Hz", info_.servoHz), "gamepad", "ask for 20 to 1000 Hz")
            .as("servo-rate", {fmt::format("{}", info_.servoHz)});
    const Sdl& sdl = Sdl::get();
    sdl.update();
    const int index = choose(sdl, options.which);
    if (index < 0)
        throw core::Error(options.which.empty() ? "no gamepad is connected"
                                                : fmt::format("there is no gamepad called '{}'", options.which),
                          "gamepad", "plug it in or switch it on; pads that SDL does not know count as joysticks")
            .as("device-missing", {options.which.empty() ? "gamepad" : options.which});
    pad_->sdl = &sdl;
    info_.driver = "gamepad";
    info_.model = sdl.nameOf(index);
    info_.version = sdl.version();
    info_.capability.name = info_.model;
    info_.capability.workspaceMm = Vec3(2.0 * RateHandSettings{}.reachMm);
    info_.capability.rateHz = info_.servoHz;
    info_.pushes = false;
    info_.sources = "no force; it shakes";
    pad_->which = options.which.empty() ? info_.model : options.which;
    pad_->controller = sdl.openController(index);
    if (pad_->controller == nullptr)
        throw core::Error("the gamepad cannot be opened", info_.model,
                          "this person may not read it: log in at the machine itself, or add a udev rule")
            .as("device-permission", {info_.model});
}

void GamepadDriver::start(link::Servo& servo) {
    link::requireStartable(started_, stopped_, info_.model);
    started_ = true;
    pad_->door = std::make_unique<ServoPort>(servo);
    const std::shared_ptr<Pad> pad = pad_;
    thread_ = std::make_unique<ServoThread>(
        info_.servoHz, [pad] { pad->frame(); }, [pad] { pad->last(); });
}

void GamepadDriver::stop() noexcept {
    stopped_ = true;
    if (pad_ && pad_->door) pad_->door->shut();
    if (thread_) (void)thread_->stop(std::chrono::milliseconds(800));
    thread_.reset();
    pad_.reset();  // closes the pad, unless the thread hangs with it
}

}  // namespace

Found lookGamepad() {
    Found found;
    found.driver = "gamepad";
    found.makes = "Gamepads (SDL 2); they shake, but cannot push";
    found.pushes = false;
    try {
        const Sdl& sdl = Sdl::get();
        sdl.update();
        for (const int index : controllers(sdl)) {
            found.models.push_back(sdl.nameOf(index));
            const std::string which = fmt::format("#{}", found.models.size());
            found.units.push_back({which, fmt::format("{} ({})", found.models.back(), which)});
        }
        found.available = !found.models.empty();
        if (!found.available) {
            found.why = "No gamepad is connected.";
            found.remedy = "Plug it in or switch it on.";
        }
    } catch (const core::Error& e) {
        found.why = fmt::format("{}.", e.problem());
        found.remedy = e.remedy();
    }
    return found;
}

std::unique_ptr<link::Driver> openGamepad(const OpenOptions& options) {
    return std::make_unique<GamepadDriver>(options);
}

}  // namespace handpiece::drivers
