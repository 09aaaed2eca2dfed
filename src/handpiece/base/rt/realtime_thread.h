// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A thread for the tick, with what real-time privileges this machine grants and one plain line about them.

#include <atomic>
#include <cstdint>
#include <functional>
#include <future>
#include <string>
#include <thread>

#include "handpiece/base/config/words.h"

namespace handpiece::rt {

/// How a thread is scheduled, best last.
enum class Scheduling { notAsked, normal, highPriority, realtimeKit, fifo };
/// "fifo", as in files.
[[nodiscard]] const char* nameOf(Scheduling scheduling) noexcept;

/// What a thread was granted.
struct SchedulingGrant {
    Scheduling scheduling = Scheduling::notAsked;
    bool memoryLocked = false;                                     ///< no page of the process can be swapped out
    bool timerSlack = false;                                       ///< wake-ups are not rounded to save power
    config::Phrase told = config::phrase("scheduling.not-asked");  ///< for people
    int timesTakenBack = 0;                                        ///< real time that had been granted

    [[nodiscard]] bool realTime() const noexcept { return scheduling >= Scheduling::realtimeKit; }
    /// In the program's language: "real-time scheduling: SCHED_FIFO, priority 80".
    [[nodiscard]] std::string text() const;
    /// The same and what became of the memory: "...; memory locked".
    [[nodiscard]] std::string line() const;
};

/// Asks for the best that there is for the calling thread, locked memory and no timer slack. Never fails: what is not
/// permitted is said. Allocates and may take a second; call before the first tick.
///
/// SCHED_FIFO by the process's own limits first: it costs one call, stands above all that RealtimeKit gives (20), and
/// nobody takes it back. RealtimeKit then. Last the normal scheduler, with a slice so short that the thread may go
/// before others when it wakes up. HANDPIECE_SCHEDULING=fifo, rtkit or plain asks for nothing better than that.
///
/// A real-time thread that runs for a tenth of a second without a pause is given to the normal scheduler, so that no
/// tick keeps a processor from everybody (RLIMIT_RTTIME, SIGXCPU).
[[nodiscard]] SchedulingGrant requestRealtime(int priority = 80);

/// What requestRealtime() does about threads that run without a pause, for those that a library makes and has made
/// real-time (sound): one that ran too long would end the program. Call before that.
void guardAgainstRunaways();

/// For a thread that works long at a time and for nobody's hand, such as one that draws: tick, sound and window go
/// before it, and before the threads that it makes. For good; call at its beginning.
void stepBack() noexcept;

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
    /// True once real time that was granted has been taken back: it ran too long without a pause, or RealtimeKit
    /// rescued the machine. A system call.
    [[nodiscard]] bool lostRealTime() const noexcept;
    /// What it has now, for who looks after it; from the owner's thread, every now and then. What was taken back is
    /// asked for again 1 s later, then after 30 and 330 s (RealtimeKit refuses for 300 s after it has rescued the
    /// machine), and then no more. Never waits for an answer.
    const SchedulingGrant& keepRealTime();

  private:
    SchedulingGrant grant_;
    const int priority_;
    std::size_t askedAgain_ = 0;
    std::int64_t sinceNs_ = 0;  // it was lost, or asked for again
    std::future<SchedulingGrant> asking_;
    std::atomic<int> id_{0};  // of the kernel's; 0 before and after its body
    std::thread thread_;
};

}  // namespace handpiece::rt
