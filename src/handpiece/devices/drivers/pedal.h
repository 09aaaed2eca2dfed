// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A foot pedal: an axis or a button of a joystick, a wheel's pedals or a HID foot switch, through SDL 2. Beside any
/// other device: safety::withPedal. Never tried on hardware: docs/devices/pedal.md.

#include <memory>
#include <string>
#include <vector>

#include "handpiece/devices/link/pedal_value.h"

namespace handpiece::drivers {

struct PedalSettings {
    std::string name;          ///< a part of the joystick's name; empty: the first that is no gamepad
    int axis = 0;              ///< counted from 0
    int button = -1;           ///< 0 and more: this button is the pedal, up or down
    bool inverted = false;     ///< it rests at the end where others are pressed
    double deadTravel = 0.05;  ///< share of its way at both ends that counts for nothing; 0 to 0.4
};

/// A joystick that could be a pedal.
struct PedalFound {
    std::string name;
    int axes = 0, buttons = 0;
};
/// Throws core::Error when SDL is missing.
[[nodiscard]] std::vector<PedalFound> pedals();

/// Reads the pedal in a thread of its own, 250 times a second. A pedal that is lost is up; one that comes back or was
/// pressed when it was opened counts again once it has been up.
class FootPedal {
  public:
    /// Throws core::Error: no SDL, no such joystick, no such axis, settings out of range. `into`: a value that others
    /// hold already; it has one writer at a time.
    explicit FootPedal(const PedalSettings& settings, std::shared_ptr<link::PedalValue> into = nullptr);
    ~FootPedal();
    FootPedal(const FootPedal&) = delete;
    FootPedal& operator=(const FootPedal&) = delete;

    [[nodiscard]] const std::string& name() const noexcept { return name_; }
    [[nodiscard]] std::shared_ptr<const link::PedalValue> value() const noexcept;
    [[nodiscard]] bool attached() const noexcept;

  private:
    struct State;
    std::string name_;
    std::shared_ptr<State> state_;
    struct Thread;
    std::unique_ptr<Thread> thread_;
};

/// 0..1 of an axis' raw value.
[[nodiscard]] double pedalOf(int raw, bool inverted, double deadTravel) noexcept;

}  // namespace handpiece::drivers
