// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The thread of a driver that calls a vendor's library: it beats, and it can be left behind when the library never
/// comes back from a call. For drivers whose library has no scheduler of its own.

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <memory>

#include "handpiece/base/rt/realtime_thread.h"
#include "handpiece/devices/link/driver.h"

namespace handpiece::drivers {

/// The way to the gate that can be shut for good: once shut() has returned the gate is not called again, whatever the
/// thread on the other side still does. exchange() belongs to one thread, shut() to one other.
class ServoPort {
  public:
    explicit ServoPort(link::Servo& servo) noexcept : servo_(&servo) {}
    /// What the gate answers; no force when it is shut.
    [[nodiscard]] link::DriverCommand exchange(const link::DriverReading& reading) noexcept HANDPIECE_REALTIME {
        State expected = State::open;
        if (!state_.compare_exchange_strong(expected, State::inside, std::memory_order_acquire)) return {};
        const link::DriverCommand command = servo_->exchange(reading);
        state_.store(State::open, std::memory_order_release);
        return command;
    }
    /// Waits for an exchange under way (microseconds).
    void shut() noexcept;

  private:
    enum class State : int { open, inside, shut };
    link::Servo* servo_;
    std::atomic<State> state_{State::open};
};

/// Calls `frame` at every beat and, when told to stop, `last` once; both in its own thread. What they hold on to must
/// live as long as they do: capture shared pointers, not a driver that may be gone.
class ServoThread {
  public:
    /// Throws core::Error for a rate out of range or when no thread can be made.
    ServoThread(double rateHz, std::function<void()> frame, std::function<void()> last);
    ~ServoThread() { (void)stop(std::chrono::milliseconds(0)); }
    ServoThread(const ServoThread&) = delete;
    ServoThread& operator=(const ServoThread&) = delete;

    /// True when it has ended within `patience`. False: it hangs in a call and is left behind; it does `last` should it
    /// ever come back, and its memory stays. Idempotent.
    bool stop(std::chrono::milliseconds patience) noexcept;
    [[nodiscard]] const rt::SchedulingGrant& grant() const noexcept { return grant_; }

  private:
    struct Shared;
    std::shared_ptr<Shared> shared_;
    std::unique_ptr<rt::RealtimeThread> thread_;
    std::future<void> ended_;
    rt::SchedulingGrant grant_;
};

/// Runs `work` in a thread of its own and waits for it no longer than `patience`; throws what it throws in that time,
/// and where no thread is to be had.
bool waitedFor(std::chrono::milliseconds patience, std::function<void()> work);

/// The same for who may not throw: true when it has ended well within `patience`. A library that hangs keeps that
/// thread.
template <class Work>
bool withPatience(std::chrono::milliseconds patience, Work&& work) noexcept {
    try {
        return waitedFor(patience, std::function<void()>(std::forward<Work>(work)));
    } catch (...) {
        return false;  // no memory, no thread, or the work failed: as if it hung
    }
}

}  // namespace handpiece::drivers
