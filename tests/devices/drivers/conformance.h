// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// One suite that every driver passes against a double of its vendor's interface. A driver joins with an Adaptor in a
/// file of its own that ends with
///     INSTANTIATE_TEST_SUITE_P(OpenHaptics, Conformance, testing::Values(&makeOpenHaptics), nameOfAdaptor);
/// where makeOpenHaptics is a `std::unique_ptr<Adaptor> ()`. The tests themselves are in conformance.cpp.

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/devices/drivers/catalogue.h"
#include "handpiece/devices/link/driver.h"

namespace handpiece::drivers {

/// What arrived at the double's motors last, in the device frame.
struct Arrived {
    core::Vec3 forceN = core::Vec3::Zero();
    core::Vec3 torqueNmm = core::Vec3::Zero();
    std::uint64_t count = 0;  ///< how often something was sent since reset()
};

/// An error that the vendor's interface can tell.
struct VendorError {
    std::string name;
    int code = 0;       ///< expected in DriverReading::vendorCode; 0: this interface has no codes
    bool fatal = true;  ///< false: noted in vendorCode, frames go on
    link::DeviceFault told = link::DeviceFault::vendorError;  ///< expected when fatal
};

/// What a driver's double can do: what it cannot is skipped, and said so.
struct Traits {
    std::string driver;       ///< as DriverInfo::driver
    bool absolute = true;     ///< false: the hand is steered by a deflection (SpaceMouse, stick); see Adaptor::move
    bool orientation = true;  ///< turns are sensed
    bool force = true, torque = false;
    double stepMm = 1e-6;      ///< a pose is exact to this
    double angleRad = 1e-6;    ///< a turn is exact to this
    double forceStepN = 1e-6;  ///< a force arrives exact to this
    double torqueStepNmm = 1e-3;
    int buttons = 2;          ///< bits 0..buttons-1 of DriverReading::buttons can be pressed
    int devices = 2;          ///< at once; 1: the two-device test is skipped
    bool exclusive = true;    ///< a device that is open cannot be opened again: core::Error
    bool calibrates = false;  ///< the double can ask for calibration
    bool tellsUnplug = true;
    bool steered = true;            ///< false: the hand goes a way of its own
    bool felt = true;               ///< what arrives at the motors can be read
    bool stalls = true;             ///< its interface can be held up
    core::Vec3 workMm{20, 20, 20};  ///< the hand may go from -work to +work on each axis, device frame
};

/// Speaks to the double. One test thread; the double answers from any thread. Device 0 is the default one.
class Adaptor {
  public:
    virtual ~Adaptor() = default;
    [[nodiscard]] virtual Traits traits() const = 0;
    /// A healthy double with traits().devices devices, calibrated, no button pressed, the hand at the origin and held
    /// there (force does not move it), counters at zero. Called before each test with no driver open.
    virtual void reset() = 0;
    /// As drivers::openX; not started.
    [[nodiscard]] virtual std::unique_ptr<link::Driver> open(int device) = 0;
    /// The hand goes there at once: stylus in the device frame of link/driver.h (the adaptor turns it into the
    /// vendor's frame and units, with code of its own). Not absolute: pushes the cap or stick along positionMm and
    /// turns it along the rotation vector until the next move; the origin lets go.
    virtual void move(int device, const core::Pose& stylusInDevice) = 0;
    virtual void press(int device, std::uint32_t buttons) = 0;  ///< in our bits, all at once
    [[nodiscard]] virtual Arrived arrived(int device) = 0;
    virtual void unplug(int device) = 0;
    /// The interface says nothing for so long, then goes on.
    virtual void stall(int device, double seconds) = 0;
    [[nodiscard]] virtual std::vector<VendorError> errors() const { return {}; }
    virtual void raise(int /*device*/, const VendorError& /*error*/) {}
    /// The double asks for calibration; `finishCalibration` is what calibrationStep() asks the person for.
    virtual void uncalibrate(int /*device*/) {}
    virtual void finishCalibration(int /*device*/) {}
    /// Breaches of the vendor's documented order since reset(), and the newest in words.
    [[nodiscard]] virtual unsigned breaches() { return 0; }
    [[nodiscard]] virtual std::string lastBreach() { return {}; }
};

using MakeAdaptor = std::unique_ptr<Adaptor> (*)();

/// Answers a driver with what the test tells it to; remembers what the driver told.
class Probe final : public link::Servo {
  public:
    link::DriverCommand exchange(const link::DriverReading& reading) noexcept override {
        const std::lock_guard guard(mutex_);
        if (reading.frame != last_.frame + 1) ++frameGaps_;
        if (reading.timeNs < last_.timeNs) ++timesBack_;
        if (count_ > 0) longestNs_ = std::max(longestNs_, reading.timeNs - last_.timeNs);
        if (reading.trouble != link::DeviceFault::none) trouble_ = reading.trouble;
        if (reading.vendorCode != 0) code_ = reading.vendorCode;
        last_ = reading;
        ++count_;
        command_.timeNs = reading.timeNs;
        ++command_.number;
        // As the gate: no force into a device that is in trouble.
        return reading.trouble == link::DeviceFault::none ? command_ : link::DriverCommand{};
    }
    void push(const core::Vec3& forceN, const core::Vec3& torqueNmm = core::Vec3::Zero()) {
        const std::lock_guard guard(mutex_);
        for (int i = 0; i < 3; ++i) {
            command_.forceN[static_cast<std::size_t>(i)] = forceN[i];
            command_.torqueNmm[static_cast<std::size_t>(i)] = torqueNmm[i];
        }
    }
    void forget() {
        const std::lock_guard guard(mutex_);
        trouble_ = link::DeviceFault::none;
        code_ = 0;
        longestNs_ = 0;
    }
    [[nodiscard]] link::DriverReading last() const {
        const std::lock_guard guard(mutex_);
        return last_;
    }
    [[nodiscard]] std::uint64_t count() const {
        const std::lock_guard guard(mutex_);
        return count_;
    }
    /// Since the last forget().
    [[nodiscard]] link::DeviceFault trouble() const {
        const std::lock_guard guard(mutex_);
        return trouble_;
    }
    [[nodiscard]] int code() const {
        const std::lock_guard guard(mutex_);
        return code_;
    }
    [[nodiscard]] std::int64_t longestNs() const {
        const std::lock_guard guard(mutex_);
        return longestNs_;
    }
    /// Frames whose number was not the last one's successor; times that went back.
    [[nodiscard]] std::uint64_t faultsOfOrder() const {
        const std::lock_guard guard(mutex_);
        return frameGaps_ + timesBack_;
    }

  private:
    mutable std::mutex mutex_;
    link::DriverReading last_;
    link::DriverCommand command_;
    link::DeviceFault trouble_ = link::DeviceFault::none;
    int code_ = 0;
    std::int64_t longestNs_ = 0;
    std::uint64_t count_ = 0, frameGaps_ = 0, timesBack_ = 0;
};

/// Waits for a condition, not for a time: up to 20 s on a machine that is busy.
template <class Condition>
[[nodiscard]] bool await(const Condition& condition, double seconds = 20.0) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) return condition();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
}

class Conformance : public testing::TestWithParam<MakeAdaptor> {
  protected:
    void SetUp() override {
        adaptor = GetParam()();
        adaptor->reset();
        traits = adaptor->traits();
    }
    /// Started and streaming.
    [[nodiscard]] std::unique_ptr<link::Driver> started(int device, Probe& probe) {
        auto driver = adaptor->open(device);
        driver->start(probe);
        EXPECT_TRUE(await([&] { return probe.count() > 2 && probe.last().trouble == link::DeviceFault::none; }))
            << "trouble: " << link::idOf(probe.last().trouble);
        return driver;
    }
    /// The interface goes on for many frames, told to somebody else: what was still on its way comes meanwhile.
    void anotherRound() {
        Probe other;
        auto driver = started(0, other);
        EXPECT_TRUE(await([&] { return other.count() > 20; }));
        driver->stop();
    }
    [[nodiscard]] bool felt() const { return traits.force && traits.felt; }
    std::unique_ptr<Adaptor> adaptor;
    Traits traits;
};

/// "openhaptics": the last argument of INSTANTIATE_TEST_SUITE_P.
inline std::string nameOfAdaptor(const testing::TestParamInfo<MakeAdaptor>& info) {
    return info.param()->traits().driver;
}

}  // namespace handpiece::drivers
