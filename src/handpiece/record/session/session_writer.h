// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Writes a session file, on the calling thread. The Recorder does it on a thread of its own.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "handpiece/record/session/record.h"

namespace handpiece::session {

/// Grows one file by whole chunks (chunkRows); between any two of its writes to the disk the file can be opened
/// and read. When the disk fails it goes on as if nothing were, and writes nothing: see failure().
class SessionWriter {
  public:
    /// For tests: every change of the file, see FileState::observer.
    using Observer = std::function<void(std::uint64_t address, std::span<const unsigned char> data)>;

    /// Makes the file, in place of one that was there. Throws core::Error for a place that cannot be written and for
    /// information that is out of range.
    SessionWriter(const std::filesystem::path& path, const SessionInfo& info, Observer observer = {});
    /// Goes on in a session that is there, closed or cut off, whose first part stays as it is: from firstTick() on.
    /// Throws core::Error as SessionReader, and for a place that cannot be written.
    explicit SessionWriter(const std::filesystem::path& path, Observer observer = {});
    ~SessionWriter();  ///< close()
    SessionWriter(const SessionWriter&) = delete;
    SessionWriter& operator=(const SessionWriter&) = delete;

    /// The first tick that can follow: 0, or behind all that the session held.
    [[nodiscard]] std::uint64_t firstTick() const noexcept;
    [[nodiscard]] double rateHz() const noexcept;
    /// Ticks must rise. Goes to the file when a chunk is full.
    void append(const Record& record);
    /// Goes to the file at once.
    void append(const Event& event);
    void append(const KeyFrame& keyFrame);
    /// What does not fill a chunk goes to the file as well. Then nothing can be added.
    void close();

    /// Why writing has stopped, for people; empty while all is well.
    [[nodiscard]] const std::string& failure() const noexcept;
    /// The system's number for it.
    [[nodiscard]] int errorNumber() const noexcept;
    /// Ticks that are in the file.
    [[nodiscard]] std::uint64_t writtenRecords() const noexcept;
    [[nodiscard]] std::uint64_t sizeBytes() const noexcept;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace handpiece::session
