// SPDX-License-Identifier: Apache-2.0
#include "devices/drivers/gamepad_virtual.h"

#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "handpiece/base/core/error.h"
#include "handpiece/devices/drivers/sdl_library.h"

namespace handpiece::test {
namespace {

using drivers::SdlLibrary;

// As SDL 2.24 and later have them.
struct Description {
    std::uint16_t version = 1, type = 0, axes = 0, buttons = 0, hats = 0, vendor = 0, product = 0, padding = 0;
    std::uint32_t buttonMask = 0, axisMask = 0;
    const char* name = nullptr;
    void* self = nullptr;
    void (*update)(void*) = nullptr;
    void (*player)(void*, int) = nullptr;
    int (*rumble)(void*, std::uint16_t, std::uint16_t) = nullptr;
    int (*rumbleTriggers)(void*, std::uint16_t, std::uint16_t) = nullptr;
    int (*led)(void*, std::uint8_t, std::uint8_t, std::uint8_t) = nullptr;
    int (*effect)(void*, const void*, int) = nullptr;
};
constexpr std::uint16_t kUnknown = 0, kGamepad = 1;

struct Functions {
    int (*attach)(const Description*) = nullptr;
    int (*detach)(int) = nullptr;
    int (*setAxis)(void*, int, std::int16_t) = nullptr;
    int (*setButton)(void*, int, std::uint8_t) = nullptr;
};

const Functions& functions() {
    static const Functions all = [] {
        Functions f;
        const link::SharedLibrary& sdl = SdlLibrary::get().library();
        sdl.require(f.attach, "SDL_JoystickAttachVirtualEx");
        sdl.require(f.detach, "SDL_JoystickDetachVirtual");
        sdl.require(f.setAxis, "SDL_JoystickSetVirtualAxis");
        sdl.require(f.setButton, "SDL_JoystickSetVirtualButton");
        return f;
    }();
    return all;
}

}  // namespace

bool hasVirtualJoysticks(std::string& why) {
    try {
        (void)functions();
        return true;
    } catch (const core::Error& e) {
        why = e.what();
        return false;
    }
}

VirtualJoystick::VirtualJoystick(std::string name, bool gamepad, int axes, int buttons)
    : name_(std::move(name)), gamepad_(gamepad), axes_(axes), buttons_(buttons) {
    plug();
}

void VirtualJoystick::plug() {
    if (joystick_ != nullptr) return;
    Description d;
    d.type = gamepad_ ? kGamepad : kUnknown;
    d.axes = static_cast<std::uint16_t>(axes_);
    d.buttons = static_cast<std::uint16_t>(buttons_);
    d.name = name_.c_str();
    d.self = this;
    d.update = &updated;
    d.rumble = &rumbled;
    const int index = functions().attach(&d);
    if (index < 0) throw std::runtime_error("SDL makes no virtual joystick");
    const SdlLibrary& sdl = SdlLibrary::get();
    joystick_ = sdl.openJoystick(index);
    id_ = sdl.idAt(index);
    if (gamepad_) {
        axis(SdlLibrary::kLeftTrigger, -1.0);
        axis(SdlLibrary::kRightTrigger, -1.0);
    }
    sdl.update();
}

void VirtualJoystick::unplug() {
    if (joystick_ == nullptr) return;
    const SdlLibrary& sdl = SdlLibrary::get();
    for (int i = 0; i < sdl.count(); ++i) {
        if (sdl.idAt(i) != id_) continue;
        functions().detach(i);
        break;
    }
    sdl.closeJoystick(static_cast<SdlLibrary::Joystick*>(joystick_));
    joystick_ = nullptr;
}

void VirtualJoystick::axis(int which, double value) {
    functions().setAxis(joystick_, which,
                        static_cast<std::int16_t>(std::lround(value < 0 ? value * 32768.0 : value * 32767.0)));
}

void VirtualJoystick::button(int which, bool pressed) {
    functions().setButton(joystick_, which, pressed ? 1 : 0);
}

bool VirtualJoystick::settle() const {
    const std::uint64_t then = updates_;
    for (int i = 0; i < 10'000; ++i) {
        if (updates_ >= then + 3) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
}

void VirtualJoystick::stall(double seconds) {
    stallS_ = seconds;
    for (int i = 0; i < 10'000 && stallS_ > 0.0; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

void VirtualJoystick::updated(void* self) {
    auto* const me = static_cast<VirtualJoystick*>(self);
    ++me->updates_;
    if (const double s = me->stallS_.exchange(0.0); s > 0.0)
        std::this_thread::sleep_for(std::chrono::duration<double>(s));
}

int VirtualJoystick::rumbled(void* self, std::uint16_t low, std::uint16_t high) {
    auto* const me = static_cast<VirtualJoystick*>(self);
    me->low_ = low;
    me->high_ = high;
    ++me->rumbles_;
    return 0;
}

}  // namespace handpiece::test
