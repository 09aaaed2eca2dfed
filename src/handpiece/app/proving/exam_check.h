// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// An exam's recordings held against what its station noted while they were made. docs/school-exams.md.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "handpiece/school/exam/chain.h"

namespace handpiece::proving {

/// All inputs of a recording (pose, pedal, buttons, time) as one number, as far as whole blocks of them are there: what
/// a checkpoint says. Grows with a file that is being written.
class RecordedInputs {
  public:
    static constexpr std::int64_t kBlock = 1000;  ///< ticks

    explicit RecordedInputs(std::filesystem::path session) : session_(std::move(session)) {}
    /// On to what is there by now, `most` ticks at most. Throws core::Error for what cannot be read.
    void goOn(std::int64_t most = std::int64_t{1} << 53);
    [[nodiscard]] std::int64_t ticks() const noexcept { return ticks_; }
    [[nodiscard]] const std::string& hash() const noexcept { return hash_; }
    /// Whether the hand ever was elsewhere than at first: what nobody did is not anybody's.
    [[nodiscard]] bool hasMoved() const noexcept { return hasMoved_; }

  private:
    std::filesystem::path session_;
    std::int64_t ticks_ = 0;
    std::string hash_ = exam::kNoEntry;
    std::optional<std::array<std::int32_t, 3>> first_;
    bool hasMoved_ = false;
};

/// What a teacher should know: recordings that are not those that were noted while they were made, that ran faster than
/// the time, in which was done what was locked. `entries` as exam::doubtsOf takes them. One sentence each.
[[nodiscard]] std::vector<std::string> recordingDoubts(const std::vector<std::string>& locked,
                                                       std::span<const exam::Entry> entries,
                                                       std::span<const std::filesystem::path> sessions);

}  // namespace handpiece::proving
