// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// One arm of OpenHaptics: what it tells of itself, and what its servo does with it.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "handpiece/devices/drivers/openhaptics_hd.h"
#include "handpiece/devices/drivers/servo_thread.h"

namespace handpiece::drivers {

/// What callback and driver share. Never freed: the library may call back later than it should.
class Arm {
  public:
    Arm(const hd::Library& itsLibrary, hd::Handle itsHandle, std::string itsKey)
        : library(itsLibrary), handle(itsHandle), key(std::move(itsKey)) {}

    /// Asks the library, with the device current, and fills the rest from a table.
    [[nodiscard]] link::DriverInfo describe();

    static unsigned HANDPIECE_HD_CALL callback(void* self) { return static_cast<Arm*>(self)->tick(); }

    /// From now on the force is zero and the gate is not called again; waits so long for a frame with zero.
    void silence(std::chrono::milliseconds patience) noexcept;
    void letGo() noexcept { gone_.store(true); }

    /// While the servo hangs in the library: motors off. Where the current device is one for all threads, a frame that
    /// comes back to life meanwhile is refused its force (FRAME_ERROR), and no other arm is in a frame.
    void relax() noexcept;
    std::atomic<bool> relaxing{false};  ///< one at a time

    [[nodiscard]] unsigned calibrationAnswer() const noexcept { return answer_.load(); }
    /// Asks the servo to calibrate; false when it does not come round in time. The code of an error, if there was one.
    bool calibrate(std::chrono::milliseconds patience, unsigned& error) noexcept;
    [[nodiscard]] int calibrationStyle() const noexcept { return style_; }

    const hd::Library& library;
    const hd::Handle handle;
    const std::string key;  ///< its name among those that are open
    std::unique_ptr<ServoPort> door;
    hd::Job job = 0;
    bool scheduled = false;

  private:
    unsigned tick() noexcept HANDPIECE_REALTIME;
    /// A frame of zero force; what it tells no longer matters.
    void sendNothing() noexcept;
    void note(unsigned code) noexcept;
    /// What this model does not have is refused once, here, and not asked for again.
    void findOut() noexcept;
    void readPose() noexcept;
    void readRest() noexcept;
    void calibration() noexcept;
    void mistrust(link::DeviceFault trouble) noexcept;
    void send(const link::DriverCommand& command) noexcept;

    int style_ = 0;
    bool torque_ = false;
    double torquePerNmm_ = 0.001;  // see unitOfTorque()
    link::DriverReading reading_;
    unsigned pending_ = hd::kSuccess;
    bool first_ = true, dead_ = false, lastZero_ = false, seenHeld_ = false, seenOut_ = false;
    bool hasTemperature_ = false, hasSafetySwitch_ = false, hasInkwellSwitch_ = false;
    std::atomic<bool> closing_{false}, silent_{false}, gone_{false}, wanted_{false}, relaxed_{false};
    std::atomic<unsigned> answer_{hd::kCalibrated}, calibrationError_{hd::kSuccess};
    std::atomic<std::uint32_t> calibrated_{0};
};

}  // namespace handpiece::drivers
