// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Threads for connections: as many as there are connections, up to a number; those that have nothing to do go.

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <list>
#include <mutex>
#include <thread>

#include "school/http.h"

namespace handpiece::school_server {

class GrowingPool final : public httplib::TaskQueue {
  public:
    explicit GrowingPool(std::size_t most) : most_(most) {}

    void enqueue(std::function<void()> work) override {
        const std::lock_guard lock(mutex_);
        waiting_.push_back(std::move(work));
        if (idle_ < waiting_.size() && threads_ < most_) {
            ++threads_;
            std::thread([this] { serve(); }).detach();
        }
        wake_.notify_one();
    }
    /// What was begun and what waits is done first.
    void shutdown() override {
        std::unique_lock lock(mutex_);
        ends_ = true;
        wake_.notify_all();
        ended_.wait(lock, [this] { return threads_ == 0; });
    }

  private:
    void serve() {
        constexpr auto kIdle = std::chrono::seconds(30);
        std::unique_lock lock(mutex_);
        for (;;) {
            if (waiting_.empty()) {
                ++idle_;
                const bool isCalled = wake_.wait_for(lock, kIdle, [this] { return ends_ || !waiting_.empty(); });
                --idle_;
                if (waiting_.empty() && (ends_ || !isCalled)) break;
            }
            const std::function<void()> work = std::move(waiting_.front());
            waiting_.pop_front();
            lock.unlock();
            work();
            lock.lock();
        }
        --threads_;
        ended_.notify_all();
    }

    const std::size_t most_;
    std::mutex mutex_;
    std::condition_variable wake_, ended_;
    std::list<std::function<void()>> waiting_;
    std::size_t threads_ = 0, idle_ = 0;
    bool ends_ = false;
};

}  // namespace handpiece::school_server
