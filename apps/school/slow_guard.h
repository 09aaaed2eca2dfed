// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Cuts off whoever holds a connection and sends next to nothing, or more than was let in: the HTTP library waits for
/// the next byte only, and a byte a second would keep a thread for hours; and it reads a line, or lines of headers, to
/// their end, wherever that is. And whoever holds so many connections that nobody else gets one.

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace handpiece::school_server {

class SlowGuard {
  public:
    static constexpr std::uint64_t kLeastBytes = 2000;
    /// Of a head, TLS with it, before admit() has let it in.
    static constexpr std::uint64_t kMostHead = 128 << 10;

    /// Connections at a time. Beyond that those go that have been silent longest and are not being answered; new ones
    /// where all are as young.
    struct Bounds {
        std::size_t ofAddress = 200;       ///< a network of IPv6 (64 bits) counts as one
        std::size_t all = 768;             ///< what descriptors there are
        std::set<std::string> excepted{};  ///< addresses behind which many are: proxies
    };
    /// @param listening  socket of this server: connections that came by it are looked at
    /// @param window     in which each has to send or take kLeastBytes, unless its request is being answered
    SlowGuard(int listening, std::chrono::milliseconds window, Bounds bounds);
    ~SlowGuard();
    SlowGuard(const SlowGuard&) = delete;
    SlowGuard& operator=(const SlowGuard&) = delete;

    /// A request whose head was read: so many bytes may follow, and the next head. `remote`: "address port".
    void admit(const std::string& remote, std::uint64_t bytes);
    /// What else it sends is not read: after a refusal nobody takes the rest of it for the next request.
    void hearNoMore(const std::string& remote);

    /// A request that came whole: its answer may take its time.
    class Working {
      public:
        Working(SlowGuard& guard, std::string remote);
        ~Working();
        Working(const Working&) = delete;
        Working& operator=(const Working&) = delete;

      private:
        SlowGuard& guard_;
        std::string remote_;
    };

  private:
    struct Watched {
        std::chrono::steady_clock::time_point since{};
        std::uint64_t bytes = 0, mayRead = kMostHead;
    };
    struct Seen {
        std::uint64_t socket = 0;  ///< its inode
        std::chrono::steady_clock::time_point since{};
        std::uint32_t silentMs = 0;  ///< of those that were first seen in one look, who is older
        std::string source{};        ///< its address; empty: excepted
        bool isAnswered = false;
    };
    class Sight;
    void watch();
    void look(std::chrono::steady_clock::time_point now);
    /// The inodes of those that go.
    [[nodiscard]] std::set<std::uint64_t> tooMany(std::vector<Seen>& seen) const;

    const std::chrono::milliseconds window_;
    const Bounds bounds_;
    const std::unique_ptr<Sight> sight_;
    std::mutex mutex_;
    std::condition_variable wake_;
    bool ends_ = false;
    std::multiset<std::string> working_;             ///< remotes
    std::map<std::string, std::uint64_t> admitted_;  ///< since they were last looked at
    std::map<std::uint64_t, Watched> watched_;       ///< by the socket's inode
    std::thread thread_;
};

}  // namespace handpiece::school_server
