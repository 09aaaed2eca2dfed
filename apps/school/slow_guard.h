// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Cuts off whoever holds a connection and sends next to nothing: the HTTP library waits for the next byte only, and a
/// byte a second would keep a thread for hours.

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <thread>

namespace handpiece::school_server {

class SlowGuard {
  public:
    static constexpr std::uint64_t kLeastBytes = 2000;

    /// @param listening  socket of this server: connections that came by it are looked at
    /// @param window     in which each has to send or take kLeastBytes, unless its request is being answered
    SlowGuard(int listening, std::chrono::milliseconds window);
    ~SlowGuard();
    SlowGuard(const SlowGuard&) = delete;
    SlowGuard& operator=(const SlowGuard&) = delete;

    /// A request that came whole: its answer may take its time.
    class Working {
      public:
        Working(SlowGuard& guard, int remotePort);
        ~Working();
        Working(const Working&) = delete;
        Working& operator=(const Working&) = delete;

      private:
        SlowGuard& guard_;
        int port_;
    };

  private:
    struct Watched {
        std::chrono::steady_clock::time_point since{};
        std::uint64_t bytes = 0;
    };
    void watch();
    void look(std::chrono::steady_clock::time_point now);

    const int listening_;
    const std::chrono::milliseconds window_;
    std::mutex mutex_;
    std::condition_variable wake_;
    bool ends_ = false;
    std::multiset<int> working_;                ///< remote ports
    std::map<std::uint64_t, Watched> watched_;  ///< by the socket's inode
    std::thread thread_;
};

}  // namespace handpiece::school_server
