// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// An exam as its school's server gives it out, signed: what is to be done, by whom, with which helps, when. Stations
/// fetch it beforehand and check it without the network. docs/school-exams.md.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/school/exam/signing.h"
#include "handpiece/school/store/store.h"

namespace handpiece::exam {

using school::Milliseconds;

/// Of the rubrics that this program reads: rubric::parseRubric().
inline constexpr std::int64_t kRubricFormat = 1;

/// Codes are not in it, only what is made of them: a pack that gets about lets nobody begin.
struct Candidate {
    std::string code{};                ///< candidateHash()
    std::int64_t extraPercent = 0;     ///< more time, 0 to 300
    std::int64_t pauseMinutes = 0;     ///< and for pauses, 0 to 600
    std::vector<std::string> helps{};  ///< of cases::kHelps: unlocked for this one
    /// Of codes that an invigilator has on paper, each to confirm this candidate once: school::hashOfPassword() of 60
    /// random bits, which nobody guesses from that.
    std::vector<std::string> confirmations{};
};
/// Who confirms at the station that the candidate is who they say.
struct Invigilator {
    std::string person{};
    std::string pin{};  ///< school::hashOfPassword(); of packs of format 1, where one code confirmed everybody
};

struct Pack {
    std::int64_t format = 2;  ///< 1: of before; can be read and sat still
    std::string exam{};       ///< id of its assignment
    std::int64_t version = 1;
    std::string title{};
    std::string exercise{};  ///< its content hash, 16 digits
    std::string file{};      ///< SHA-256 of its file
    std::int64_t bytes = 0;
    std::string rubric{};  ///< 16 digits
    std::int64_t rubricFormat = 1;
    std::int64_t engine = 0;  ///< revision that cuts the work again
    Milliseconds opens = 0, closes = 0;
    std::int64_t minutes = 0;                 ///< that one has
    std::string seal{};                       ///< hashOfPassword() of the code that opens the exercise; format 1: none
    std::vector<std::string> locked{};        ///< of cases::kHelps, besides those of the exercise
    std::vector<Candidate> candidates{};      ///< by their codes' hashes, none twice
    std::vector<Invigilator> invigilators{};  ///< by person, none twice
};

/// Sorts candidates and invigilators. Throws core::Error: "exam-duplicate" (a code or person twice), "books-invalid".
[[nodiscard]] std::string toText(Pack pack);
/// Throws core::Error: "exam-damaged", "exam-newer", "exam-duplicate".
[[nodiscard]] Pack packFrom(std::string_view text, const std::string& where);
/// Checked by the server's key that this station knows. Throws also "exam-other-key", "exam-changed".
[[nodiscard]] Pack openedPack(const Signed& pack, std::string_view serverKey, const std::string& where);

/// What a typed code is in a pack: of this exam alone, so that two packs do not tell whose they are.
[[nodiscard]] std::string candidateHash(std::string_view exam, std::string_view typedCode);

/// Of each candidate so many codes: to begin, to begin again, to give up.
inline constexpr std::size_t kConfirmations = 3;

/// Throws core::Error "exam-rubric-newer", "exam-engine-other".
void requireFitting(const Pack& pack, std::int64_t rubricFormat, std::int64_t engine);
/// To begin now: throws core::Error "exam-early", "exam-expired".
void requireOpen(const Pack& pack, Milliseconds now);
/// Throws core::Error "exam-candidate-unknown".
[[nodiscard]] const Candidate& candidateOf(const Pack& pack, std::string_view typedCode);
/// When the work of one who began then has to be handed over.
[[nodiscard]] Milliseconds deadlineOf(const Pack& pack, const Candidate& candidate, Milliseconds began);
/// All that is locked for this one: the exercise's and the pack's, without their own helps.
[[nodiscard]] std::vector<std::string> lockedFor(const Pack& pack, const Candidate& candidate,
                                                 const std::vector<std::string>& exercise);

/// "2026-11-26 15:08 UTC"
[[nodiscard]] std::string clockOf(Milliseconds since1970);

}  // namespace handpiece::exam
