// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Opens a session file: whole, cut off by a kill or a full disk, or still being written.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/record/session/record.h"

namespace handpiece::session {

/// True where readers of several threads may be at work at once: the HDF5 library was built for it, as Debian's is.
[[nodiscard]] bool readSideBySide();

/// Reads by stretches; memory does not grow with the session. One thread.
///
/// What the file says about itself (types, sizes, links, filters) is checked before anything is read by it, and what
/// cannot be so throws. The HDF5 library underneath parses the file's own structure first: a file made to attack that
/// library is beyond what can be checked here, and is for who has such files read apart (core::takenFrom()).
class SessionReader {
  public:
    /// Throws core::Error: no such file, not a session, of a newer version, damaged (naming what is wrong).
    explicit SessionReader(const std::filesystem::path& path);
    ~SessionReader();
    SessionReader(const SessionReader&) = delete;
    SessionReader& operator=(const SessionReader&) = delete;

    [[nodiscard]] const SessionInfo& info() const noexcept;
    [[nodiscard]] std::int32_t formatVersion() const noexcept;
    /// True when the recorder closed it; false after a kill, a full disk, or while it is written.
    [[nodiscard]] bool isComplete() const noexcept;
    /// Ticks recorded.
    [[nodiscard]] std::uint64_t size() const noexcept;
    /// At most `count` records from the `first` on. Throws core::Error for a damaged chunk.
    [[nodiscard]] std::vector<Record> records(std::uint64_t first, std::size_t count) const;
    /// Index of the first record at or after a tick; size() when there is none.
    [[nodiscard]] std::uint64_t indexOfTick(std::uint64_t tick) const;
    /// The first tick behind all that the file holds, samples, events and key frames: where it may go on.
    [[nodiscard]] std::uint64_t endTick() const noexcept;
    /// In the order they were written. What a killed program still told of ticks whose samples it took along is left
    /// out where the session goes on: it was not done.
    [[nodiscard]] std::vector<Event> events() const;
    /// Ticks of the key frames, in the order they were written.
    [[nodiscard]] const std::vector<std::uint64_t>& keyFrameTicks() const noexcept;
    /// Throws core::Error when its bytes are not what was written.
    [[nodiscard]] KeyFrame keyFrame(std::size_t index) const;
    /// The last one at or before a tick; none when there is none.
    [[nodiscard]] std::optional<KeyFrame> keyFrameBefore(std::uint64_t tick) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace handpiece::session
