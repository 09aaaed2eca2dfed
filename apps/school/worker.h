// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Takes attempts that wait to be scored, cuts their sessions again, and enters what comes of it.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>

#include "school/lent_work.h"

namespace handpiece::school_server {

class Worker {
  public:
    /// `pause` lies between two looks for work; where one fails they grow to a minute.
    explicit Worker(std::unique_ptr<WorkSource> source, std::chrono::milliseconds pause = std::chrono::seconds(1),
                    std::chrono::milliseconds renewal = std::chrono::milliseconds(kLeaseMs / 4));
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
    const std::chrono::milliseconds pause_, renewal_;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::atomic<bool> ends_{false};
    std::thread thread_;
};

}  // namespace handpiece::school_server
