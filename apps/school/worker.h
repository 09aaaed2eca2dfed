// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Takes attempts that wait to be scored, cuts their sessions again, and enters what comes of it.

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "handpiece/school/store/books.h"

namespace handpiece::school_server {

struct WorkerSettings {
    std::filesystem::path data;
    std::string database{};
    school::Milliseconds leaseMs = 120'000;  ///< renewed while it works: after a crash another takes over then
    std::chrono::milliseconds pause{1000};   ///< between two looks for work
};

class Worker {
  public:
    Worker(WorkerSettings settings, std::function<school::Milliseconds()> clock);
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
    /// `isLost`: its lease ran out, and it is another's by now. Throws core::Error "cancelled" then, or when it ends.
    [[nodiscard]] school::Score heard(school::Books& books, school::Job& job, bool& isLost);

    const WorkerSettings settings_;
    const std::function<school::Milliseconds()> clock_;
    const std::string name_;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::atomic<bool> ends_{false};
    std::thread thread_;
};

}  // namespace handpiece::school_server
