// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/pedal.h"

#include <fmt/format.h>

#include <algorithm>

#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/devices/drivers/sdl_library.h"
#include "handpiece/devices/drivers/servo_thread.h"

namespace handpiece::drivers {
namespace {

using Sdl = SdlLibrary;

constexpr double kRateHz = 250.0;
constexpr std::int64_t kAgainNs = 250'000'000;
constexpr double kUp = 0.02;  // of its way: nobody stands on it

/// The joystick that is meant, or none (-1).
int choose(const Sdl& sdl, const std::string& name) {
    for (int i = 0; i < sdl.count(); ++i)
        if (name.empty() ? !sdl.isController(i) : sdl.nameOf(i).find(name) != std::string::npos) return i;
    return -1;
}

}  // namespace

double pedalOf(int raw, bool inverted, double deadTravel) noexcept {
    double way = std::clamp((raw + 32768.0) / 65535.0, 0.0, 1.0);
    if (inverted) way = 1.0 - way;
    return std::clamp((way - deadTravel) / (1.0 - 2.0 * deadTravel), 0.0, 1.0);
}

std::vector<PedalFound> pedals() {
    const Sdl& sdl = Sdl::get();
    sdl.update();
    std::vector<PedalFound> found;
    for (int i = 0; i < sdl.count(); ++i) {
        PedalFound one{sdl.nameOf(i), 0, 0};
        Sdl::Joystick* const joystick = sdl.openJoystick(i);
        if (joystick == nullptr) continue;
        one.axes = std::max(0, sdl.axisCount(joystick));
        one.buttons = std::max(0, sdl.buttonCount(joystick));
        sdl.closeJoystick(joystick);
        found.push_back(one);
    }
    return found;
}

struct FootPedal::State {
    const Sdl* sdl = nullptr;
    PedalSettings settings;
    std::shared_ptr<link::PedalValue> value = std::make_shared<link::PedalValue>();
    std::atomic<bool> attached{false};
    Sdl::Joystick* joystick = nullptr;
    bool wasUp = false;
    std::int64_t triedNs = 0;

    ~State() { close(); }
    void close() noexcept {
        if (joystick != nullptr) sdl->closeJoystick(joystick);
        joystick = nullptr;
        attached = false;
        wasUp = false;
    }
    [[nodiscard]] bool has() const noexcept {
        return settings.button >= 0 ? settings.button < sdl->buttonCount(joystick)
                                    : settings.axis < sdl->axisCount(joystick);
    }
    void frame() noexcept {
        sdl->update();
        const std::int64_t now = rt::monotonicNs();
        if (joystick != nullptr && !sdl->joystickAttached(joystick)) {
            close();
            triedNs = now;
        }
        if (joystick == nullptr && now - triedNs > kAgainNs) {
            triedNs = now;
            if (const int index = choose(*sdl, settings.name); index >= 0) joystick = sdl->openJoystick(index);
            if (joystick != nullptr && !has()) close();
            attached = joystick != nullptr;
        }
        double pressed = 0.0;
        if (joystick != nullptr) {
            pressed = settings.button >= 0
                          ? (sdl->joystickButton(joystick, settings.button) != 0) != settings.inverted ? 1.0 : 0.0
                          : pedalOf(sdl->joystickAxis(joystick, settings.axis), settings.inverted, settings.deadTravel);
            // Many say the middle of their way until they are first moved.
            if (pressed <= kUp) wasUp = true;
        }
        value->write(wasUp ? static_cast<float>(pressed) : 0.0f, now);
    }
};

struct FootPedal::Thread {
    ServoThread servo;
};

FootPedal::FootPedal(const PedalSettings& settings, std::shared_ptr<link::PedalValue> into)
    : state_(std::make_shared<State>()) {
    if (into) state_->value = std::move(into);
    if (settings.axis < 0 || !(settings.deadTravel >= 0.0 && settings.deadTravel <= 0.4))
        throw core::Error(
            fmt::format("a pedal on axis {} with a dead travel of {}", settings.axis, settings.deadTravel), "pedal",
            "axes count from 0, the dead travel is 0 to 0.4")
            .as("pedal-settings", {});
    const Sdl& sdl = Sdl::get();
    sdl.update();
    const int index = choose(sdl, settings.name);
    if (index < 0)
        throw core::Error(settings.name.empty() ? "no pedal is connected"
                                                : fmt::format("there is no pedal called '{}'", settings.name),
                          "pedal", "plug it in; it must be seen by the system as a joystick")
            .as("device-missing", {settings.name.empty() ? "pedal" : settings.name});
    name_ = sdl.nameOf(index);
    state_->sdl = &sdl;
    state_->settings = settings;
    if (state_->settings.name.empty()) state_->settings.name = name_;
    state_->joystick = sdl.openJoystick(index);
    if (state_->joystick == nullptr)
        throw core::Error("the pedal cannot be opened", name_,
                          "this person may not read it: log in at the machine itself, or add a udev rule")
            .as("device-permission", {name_});
    if (!state_->has())
        throw core::Error(settings.button >= 0 ? fmt::format("'{}' has no button {}", name_, settings.button)
                                               : fmt::format("'{}' has no axis {}", name_, settings.axis),
                          "pedal",
                          fmt::format("it has {} axes and {} buttons, counted from 0", sdl.axisCount(state_->joystick),
                                      sdl.buttonCount(state_->joystick)))
            .as("pedal-settings", {name_});
    state_->attached = true;
    const std::shared_ptr<State> state = state_;
    thread_.reset(new Thread{ServoThread(
        kRateHz, [state] { state->frame(); },
        [state] {
            state->close();
            state->value->write(0.0f, rt::monotonicNs());
        })});
}

FootPedal::~FootPedal() {
    (void)thread_->servo.stop(std::chrono::milliseconds(800));
}

std::shared_ptr<const link::PedalValue> FootPedal::value() const noexcept {
    return state_->value;
}
bool FootPedal::attached() const noexcept {
    return state_->attached;
}

}  // namespace handpiece::drivers
