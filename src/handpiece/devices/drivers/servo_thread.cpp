// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/servo_thread.h"

#include <cmath>
#include <system_error>
#include <thread>

#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/clock.h"

namespace handpiece::drivers {
namespace {

/// A thread that hangs in a vendor's call: another one waits for it, for as long as the library takes.
void leaveBehind(std::unique_ptr<rt::RealtimeThread> thread) noexcept {
    rt::RealtimeThread* left = thread.release();
    try {
        std::thread([left] { delete left; }).detach();
    } catch (const std::exception&) {
        // No thread can be made: then it is never joined, and its memory stays.
    }
}

std::int64_t periodOf(double rateHz) {
    if (!(rateHz >= 1.0) || rateHz > 20'000.0)
        throw core::Error("a servo rate of " + std::to_string(rateHz) + " Hz", "servo", "ask for 1 to 20000 Hz")
            .as("servo-rate", {std::to_string(rateHz)});
    return std::llround(1e9 / rateHz);
}

}  // namespace

void ServoPort::shut() noexcept {
    for (;;) {
        State expected = State::open;
        if (state_.compare_exchange_strong(expected, State::shut, std::memory_order_acq_rel)) return;
        if (expected == State::shut) return;
        std::this_thread::yield();
    }
}

struct ServoThread::Shared {
    std::atomic<bool> stopping{false};
    std::promise<void> ended;
    std::function<void()> frame, last;
};

ServoThread::ServoThread(double rateHz, std::function<void()> frame, std::function<void()> last)
    : shared_(std::make_shared<Shared>()) {
    rt::PeriodicClock clock(periodOf(rateHz));
    shared_->frame = std::move(frame);
    shared_->last = std::move(last);
    ended_ = shared_->ended.get_future();
    thread_ = std::make_unique<rt::RealtimeThread>([shared = shared_, clock]() mutable {
        clock.start();
        while (!shared->stopping.load(std::memory_order_acquire)) {
            shared->frame();
            clock.wait();
        }
        shared->last();
        shared->ended.set_value();
    });
    grant_ = thread_->grant();
}

bool ServoThread::stop(std::chrono::milliseconds patience) noexcept {
    if (!thread_) return true;
    shared_->stopping.store(true, std::memory_order_release);
    if (ended_.wait_for(patience) == std::future_status::ready) {
        thread_.reset();
        return true;
    }
    leaveBehind(std::move(thread_));
    return false;
}

bool waitedFor(std::chrono::milliseconds patience, std::function<void()> work) {
    auto done = std::make_shared<std::promise<void>>();
    std::future<void> ended = done->get_future();
    std::thread([done, work = std::move(work)] {
        try {
            work();
            done->set_value();
        } catch (...) {
            done->set_exception(std::current_exception());
        }
    }).detach();
    if (ended.wait_for(patience) != std::future_status::ready) return false;
    ended.get();
    return true;
}

}  // namespace handpiece::drivers
