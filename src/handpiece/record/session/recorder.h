// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Records a session while it runs: the caller hands over and goes on, a thread of its own writes.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/record/session/record.h"

namespace handpiece::session {

/// What the person should know.
struct RecorderStatus {
    bool recording = true;             ///< false once the disk has refused, and after close()
    std::string message;               ///< why it stopped, to be told once; empty while all is well
    std::string id, reason;            ///< of that: core::Error's id and the system's word; empty where there is none
    std::uint64_t writtenRecords = 0;  ///< ticks in the file
    std::uint64_t lostRecords = 0;     ///< ticks that did not fit the queue: the session cannot be replayed past them
    std::uint64_t lostItems = 0;       ///< events and key frames that did not fit
    std::uint64_t sizeBytes = 0;
};

/// One thread hands over, which is not the tick's. What was handed over more than a second ago is in the file, and
/// stays readable through kill -9, a full disk and a crash.
class Recorder {
  public:
    /// Makes the file, in place of one that was there. Throws core::Error as SessionWriter.
    Recorder(const std::filesystem::path& path, const SessionInfo& info);
    /// Goes on in the session that is there, from firstTick() on. Throws core::Error as SessionWriter.
    explicit Recorder(const std::filesystem::path& path);
    ~Recorder();  ///< close()
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// The file's number for tick 0 of what is handed over; all that follow are counted from there.
    [[nodiscard]] std::uint64_t firstTick() const noexcept;
    /// Never waits and never throws; false, and counted, when the disk has been too slow for four seconds.
    bool push(const Record& record) noexcept;
    /// Waits for room instead: for runs on simulated time, which outpace the disk.
    void pushWaiting(const Record& record);
    /// Never waits for the disk. What the file cannot hold (a text above a megabyte, above 256 MB waiting) is counted.
    void event(std::uint64_t tick, EventName name, std::string_view text = {});
    void keyFrame(std::uint64_t tick, std::vector<std::byte> state);
    /// Any thread.
    [[nodiscard]] RecorderStatus status() const;
    /// Writes what waits and ends the file; waits for the disk. Returns the final status.
    RecorderStatus close();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace handpiece::session
