// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a vendor's device is to us: readings out of its own servo thread, forces into it. Never used by the tick
/// itself: safety::GuardedDevice stands between.
///
/// **Device frame**, the same for all drivers: right-handed, +x to the user's right, +y up, +z to the user; origin
/// where the vendor has it; millimetre, newton, newton millimetre. **Stylus frame**: origin at the point whose position
/// the device reports and on which its force acts; +z from the tip to the tail, +y up while the buttons look up. A
/// driver converts at its edge and nowhere else.

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "handpiece/base/core/realtime.h"
#include "handpiece/tick/device/device.h"

namespace handpiece::link {

/// Why a device's pose is not to be trusted, or why it may not push. Anything but `none` ends in zero force.
enum class DeviceFault : std::uint8_t {
    none,
    starting,       ///< no reading yet
    unplugged,      ///< the device or its service went away
    vendorError,    ///< the vendor's library reports an error: see vendorCode
    badData,        ///< a frame that cannot be read
    stalled,        ///< no reading for too long
    tickStalled,    ///< no command for too long: the simulation stands
    notFinite,      ///< a pose or a force that is no number
    jumped,         ///< a pose farther from the last one than a hand can move
    notCalibrated,  ///< the device asks for calibration
    hot,            ///< its motors are too warm
    inputLost,      ///< nobody holds it (safety switch, stylus in its inkwell)
    stopped,        ///< it was stopped
};
/// An id for messages and files ("unplugged"), and one sentence for people with what to do.
[[nodiscard]] std::string_view idOf(DeviceFault trouble) noexcept;
[[nodiscard]] std::string_view sentenceOf(DeviceFault trouble) noexcept;
[[nodiscard]] std::string_view remedyOf(DeviceFault trouble) noexcept;

/// One frame of the device's own servo. Plain: crosses threads by value.
struct DriverReading {
    std::int64_t timeNs = 0;                        ///< rt::monotonicNs() when it was read
    std::uint64_t frame = 0;                        ///< counts up from 1
    std::array<double, 3> positionMm{};             ///< of the stylus, device frame
    std::array<double, 4> orientation{1, 0, 0, 0};  ///< stylus in device frame, w x y z; unit
    std::uint32_t buttons = 0;  ///< bit 0: the upper one (cuts), bit 1: the lower one (undoes), others as they come
    float pedal = -1.0f;        ///< 0..1; below 0: the device has none
    float motorTemperature = -1.0f;  ///< 0..1 of what the vendor allows, the hottest motor; below 0: not told
    DeviceFault trouble = DeviceFault::none;
    std::int32_t vendorCode = 0;  ///< of the error told by the vendor's library; 0: none
};

/// What the device is to push with until the next exchange. Plain: crosses threads by value.
struct DriverCommand {
    std::int64_t timeNs = 0;  ///< when the simulation gave it
    std::uint64_t number = 0;
    std::array<double, 3> forceN{};     ///< on the hand, device frame
    std::array<double, 3> torqueNmm{};  ///< about the stylus' origin, device frame
    float vibration = 0.0f;             ///< 0..1, for devices that can only rumble
};

/// The one place where a driver gets forces from: the last gate, which lives in the driver's own servo thread.
class Servo {
  public:
    virtual ~Servo() = default;
    /// Called once a frame in the driver's thread with what was read, also when there is trouble; what it returns is
    /// to be sent, and nothing else ever is. Neither waits nor throws.
    [[nodiscard]] virtual DriverCommand exchange(const DriverReading& reading) noexcept HANDPIECE_REALTIME = 0;
};

/// What is known of a device that was opened.
struct DriverInfo {
    std::string driver;   ///< "openhaptics", "forcedimension", "haply", "falcon", "spacemouse", "gamepad", "simulated"
    std::string model;    ///< as the vendor calls it
    std::string serial;   ///< may be empty; names the profile
    std::string version;  ///< of library, driver and firmware, as far as they tell
    device::Capability capability;  ///< hand's side: newton and millimetres at the stylus. Its name is the model
    bool pushes = true;             ///< false: input without force
    bool hasOrientation = true;
    double servoHz = 1000.0;  ///< nominal
    double frictionN = 0.0;   ///< of its own joints at the stylus; 0: unknown
    double massKg = 0.0;      ///< felt at the stylus; 0: unknown
    std::string sources;      ///< one line: where the figures come from ("device table of CHAI3D 3.3; unchecked ...")
};

enum class CalibrationState : std::uint8_t { notNeeded, good, wanted, wantedByHand };

/// A device in its own thread. Made by drivers::open(); made off the tick, used by one owner thread.
class Driver {
  public:
    virtual ~Driver() = default;  ///< stop()
    [[nodiscard]] virtual const DriverInfo& info() const noexcept = 0;
    /// Begins to exchange frames with `servo`, which outlives stop(). Throws core::Error with the vendor's reason in
    /// words and a remedy. Once.
    virtual void start(Servo& servo) = 0;
    /// Sends zero force if that is still possible, ends the servo thread, closes the device. Idempotent; never throws;
    /// returns within a second even when the device is gone.
    virtual void stop() noexcept = 0;
    /// Called from a thread of its own when no exchange() has come for too long, so while the servo thread may hang:
    /// switches the motors off if the vendor's library can be asked to from another thread; never waits. They are on
    /// again before the answer of a next exchange() is sent, which is zero.
    virtual void relax() noexcept {}
    /// Whether it knows where its axes are. Any time after start().
    [[nodiscard]] virtual CalibrationState calibration() { return CalibrationState::notNeeded; }
    /// What the person does for it ("Put the stylus into the inkwell and press it home."), in one sentence.
    [[nodiscard]] virtual std::string calibrationStep() { return {}; }
    /// Tries once; true when it is calibrated now. Throws core::Error when the vendor's library refuses.
    virtual bool calibrate() { return true; }
};

/// A driver is started once. Throws core::Error when it runs already or was stopped.
void requireStartable(bool runs, bool stopped, const std::string& model);
/// Only a driver that runs can be calibrated. Throws core::Error ("not-started").
void requireCalibratable(bool runs, const std::string& model);

}  // namespace handpiece::link
