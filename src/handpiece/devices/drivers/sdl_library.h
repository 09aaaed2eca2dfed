// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The few functions of SDL 2 that gamepads and pedals need, loaded when one is asked for (HANDPIECE_SDL_LIBRARY names
/// another library). Declarations are our own.

#include <cstdint>
#include <string>

#include "handpiece/devices/link/shared_library.h"

namespace handpiece::drivers {

/// SDL without a window, a sound or a signal handler of its own; once a program, and it stays.
class SdlLibrary {
  public:
    struct Controller;  ///< theirs
    struct Joystick;

    // As SDL numbers them.
    static constexpr int kLeftX = 0, kLeftY = 1, kRightX = 2, kRightY = 3, kLeftTrigger = 4, kRightTrigger = 5;
    static constexpr int kA = 0, kB = 1, kX = 2, kY = 3, kBack = 4, kStart = 6, kLeftShoulder = 9, kRightShoulder = 10,
                         kUp = 11, kDown = 12, kLeft = 13, kRight = 14;

    /// Throws core::Error when the library is missing, of a wrong version, or does not start.
    [[nodiscard]] static const SdlLibrary& get();

    void (*update)() = nullptr;  ///< reads all devices and looks for new ones; locks inside, any thread
    int (*count)() = nullptr;
    const char* (*nameAt)(int index) = nullptr;
    int (*isController)(int index) = nullptr;
    std::int32_t (*idAt)(int index) = nullptr;

    Controller* (*openController)(int index) = nullptr;
    void (*closeController)(Controller*) = nullptr;
    int (*controllerAttached)(Controller*) = nullptr;
    std::int16_t (*controllerAxis)(Controller*, int axis) = nullptr;
    std::uint8_t (*controllerButton)(Controller*, int button) = nullptr;
    int (*rumble)(Controller*, std::uint16_t low, std::uint16_t high, std::uint32_t milliseconds) = nullptr;

    Joystick* (*openJoystick)(int index) = nullptr;
    void (*closeJoystick)(Joystick*) = nullptr;
    int (*joystickAttached)(Joystick*) = nullptr;
    std::int16_t (*joystickAxis)(Joystick*, int axis) = nullptr;
    std::uint8_t (*joystickButton)(Joystick*, int button) = nullptr;
    int (*axisCount)(Joystick*) = nullptr;
    int (*buttonCount)(Joystick*) = nullptr;

    [[nodiscard]] const link::SharedLibrary& library() const noexcept { return library_; }
    [[nodiscard]] std::string version() const;
    [[nodiscard]] std::string nameOf(int index) const;

  private:
    SdlLibrary();
    link::SharedLibrary library_;
};

}  // namespace handpiece::drivers
