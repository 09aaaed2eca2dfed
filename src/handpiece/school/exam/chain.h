// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a station's service notes of its exams: entries, each signed by the station's key and naming the hash of the
/// one before, so that none can be taken out, put in or changed unseen. docs/school-exams.md.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/school/exam/pack.h"

namespace handpiece::exam {

/// A session as it was handed over.
struct HandedOver {
    std::string file{};  ///< SHA-256
    std::string work{};  ///< assessment::workHash(), 16 digits
    std::int64_t bytes = 0;
};

struct Entry {
    std::int64_t format = 2;  ///< 1: of before, without a confirmation
    std::string station{};    ///< 32 digits
    std::int64_t number = 0;  ///< from 1, without gaps
    std::string previous{};   ///< hash of the entry before; zeros for the first
    Milliseconds at = 0;      ///< by the service's clock
    std::string kind{};       ///< "started" (the service), "begun", "checkpoint", "given-up", "finished"
    std::string sitting{};    ///< 32 digits; none of "started"
    // Of "begun".
    std::string exam{}, pack{};  ///< its id; SHA-256 of its text
    std::string candidate{};     ///< candidateHash()
    std::string invigilator{};   ///< who confirmed the candidate's identity
    std::int64_t again = 0;      ///< how often this candidate had begun here before
    /// The code that they typed, of "given-up" too: it opens nothing else, and shows the server that they were there.
    /// Empty: by a pack of format 1.
    std::string confirmation{};
    // Of "checkpoint": the recording as far as it had come.
    std::int64_t part = 0;   ///< which of the sitting's recordings, from 1
    std::int64_t ticks = 0;  ///< of it
    std::string inputs{};    ///< SHA-256 of all inputs of these ticks
    // Of "finished".
    std::vector<HandedOver> files{};  ///< in the order of the work
};
inline constexpr const char* kNoEntry = "0000000000000000000000000000000000000000000000000000000000000000";

[[nodiscard]] std::string toText(const Entry& entry);
/// Throws core::Error "exam-damaged", "exam-newer".
[[nodiscard]] Entry entryFrom(std::string_view text, const std::string& where);
[[nodiscard]] std::string hashOfEntry(std::string_view text);

/// How far a chain is.
struct ChainEnd {
    std::int64_t number = 0;
    std::string hash = kNoEntry;
};
/// The next of a station's chain. Throws core::Error: "exam-damaged", "exam-other-key", "exam-changed", "exam-chain"
/// where it is not the one that follows.
[[nodiscard]] Entry nextOf(const ChainEnd& end, const Signed& entry, const std::string& station,
                           std::string_view stationKey);

/// What a teacher should know of a sitting before they confirm anything, by the entries alone, from its "begun" to its
/// "finished" with all that the station noted in between; `received`: when the server had each. One sentence each.
[[nodiscard]] std::vector<std::string> doubtsOf(const Pack& pack, std::span<const Entry> entries,
                                                std::span<const Milliseconds> received);

}  // namespace handpiece::exam
