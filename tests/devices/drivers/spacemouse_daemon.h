// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// spacenavd as its library knows it, in this process: its socket, both versions of its protocol, one device.

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace handpiece::test {

class SpaceMouseDaemon {
  public:
    /// Listens at `path`. Version 0 answers no questions.
    explicit SpaceMouseDaemon(std::string path, int version = 1);
    ~SpaceMouseDaemon();
    SpaceMouseDaemon(const SpaceMouseDaemon&) = delete;
    SpaceMouseDaemon& operator=(const SpaceMouseDaemon&) = delete;

    /// Counts as it sends them: x right, y up, z away from the user; turns about these.
    void motion(const std::array<int, 6>& counts);
    void button(int number, bool pressed);
    void send(const void* bytes, std::size_t size);  ///< whatever it is, to everybody
    void plug(bool there);
    void stall(double seconds);
    /// Waits until clients have asked twice: what was sent before has been read. False after 10 s.
    [[nodiscard]] bool settle();
    [[nodiscard]] std::size_t clients() const;
    [[nodiscard]] unsigned breaches() const;
    [[nodiscard]] std::string lastBreach() const;

  private:
    void serve(int client);
    bool answer(int client, const std::array<std::int32_t, 8>& question);
    const std::string path_;
    const int version_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<int> clients_;
    std::vector<std::thread> threads_;
    std::thread listener_;
    int listening_ = -1;
    bool there_ = true, ends_ = false;
    std::uint64_t questions_ = 0;
    unsigned breaches_ = 0;
    std::string breach_;
    std::chrono::steady_clock::time_point stalledUntil_{};
};

}  // namespace handpiece::test
