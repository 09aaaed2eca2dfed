// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// SDL's own virtual joysticks, in the very library that the drivers load.

#include <array>
#include <atomic>
#include <cstdint>
#include <string>

namespace handpiece::test {

/// False when SDL is not installed, or too old for them: tests then skip, and say so.
[[nodiscard]] bool hasVirtualJoysticks(std::string& why);

class VirtualJoystick {
  public:
    /// A gamepad has six axes and fifteen buttons in SDL's order, triggers at rest.
    VirtualJoystick(std::string name, bool gamepad, int axes = 6, int buttons = 15);
    ~VirtualJoystick() { unplug(); }
    VirtualJoystick(const VirtualJoystick&) = delete;
    VirtualJoystick& operator=(const VirtualJoystick&) = delete;

    void axis(int which, double value);  ///< -1..1
    void button(int which, bool pressed);
    void unplug();
    void plug();
    /// SDL hangs in this joystick's driver for so long; returns when it does.
    void stall(double seconds);
    /// Waits until SDL has updated it twice: what was set has been read. False after 10 s.
    [[nodiscard]] bool settle() const;
    [[nodiscard]] std::array<std::uint16_t, 2> rumble() const { return {low_.load(), high_.load()}; }
    [[nodiscard]] std::uint64_t rumbles() const { return rumbles_.load(); }

  private:
    static void updated(void* self);
    static int rumbled(void* self, std::uint16_t low, std::uint16_t high);
    const std::string name_;
    const bool gamepad_;
    const int axes_, buttons_;
    void* joystick_ = nullptr;
    std::int32_t id_ = -1;
    std::atomic<double> stallS_{0.0};
    std::atomic<std::uint64_t> updates_{0}, rumbles_{0};
    std::atomic<std::uint16_t> low_{0}, high_{0};
};

}  // namespace handpiece::test
