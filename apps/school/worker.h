// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Takes attempts that wait to be scored, cuts their sessions again, and enters what comes of it.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "handpiece/base/core/error.h"
#include "school/lent_work.h"

namespace handpiece::school_server {

class Worker {
  public:
    /// `pause` lies between two looks for work; where one fails they grow to a minute.
    explicit Worker(std::unique_ptr<WorkSource> source, std::chrono::milliseconds pause = std::chrono::seconds(1));
    /// Before start(): called once, from its thread, when a server takes no work of this machine any more. It ends
    /// then.
    void onRefused(std::function<void(const core::Error&)> told) { refused_ = std::move(told); }
    ~Worker();
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;

    void start();
    /// What it has in hand goes back to the others.
    void stop();
    /// One attempt, in the caller's thread; false: none waited.
    bool workOnce();

  private:
    void loop();

    const std::unique_ptr<WorkSource> source_;
    const std::chrono::milliseconds pause_;
    std::function<void(const core::Error&)> refused_;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::atomic<bool> ends_{false};
    std::thread thread_;
};

}  // namespace handpiece::school_server
