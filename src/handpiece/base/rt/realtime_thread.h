// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A thread for the tick, with what real-time privileges this machine grants and one plain line about them.

#include <functional>
#include <string>
#include <thread>

namespace handpiece::rt {

/// What the calling thread was granted.
struct SchedulingGrant {
    bool realTime = false;      ///< SCHED_FIFO
    bool memoryLocked = false;  ///< no page of the process can be swapped out
    bool timerSlack = false;    ///< wake-ups are not rounded to save power
    std::string line;           ///< for people: "real-time scheduling: SCHED_FIFO priority 80; memory locked"
};

/// Asks for SCHED_FIFO, locked memory and no timer slack for the calling thread. Never fails: what is not permitted is
/// said in the line. Allocates; call before the first tick.
[[nodiscard]] SchedulingGrant requestRealtime(int priority = 80);

/// Runs `body` on a thread of its own that has called requestRealtime(). Joins when destroyed.
class RealtimeThread {
  public:
    /// Returns when the thread has its grant and is about to call `body`. Throws core::Error when no thread can be
    /// made.
    explicit RealtimeThread(std::function<void()> body, int priority = 80);
    ~RealtimeThread() { join(); }
    RealtimeThread(const RealtimeThread&) = delete;
    RealtimeThread& operator=(const RealtimeThread&) = delete;

    void join() {
        if (thread_.joinable()) thread_.join();
    }
    [[nodiscard]] const SchedulingGrant& grant() const noexcept { return grant_; }

  private:
    SchedulingGrant grant_;
    std::thread thread_;
};

}  // namespace handpiece::rt
