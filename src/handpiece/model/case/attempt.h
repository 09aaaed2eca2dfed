// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What somebody has cut so far: it refers to its case, which cutting never alters, and resumes exactly where it was.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/model/case/case.h"
#include "handpiece/model/case/package.h"

namespace handpiece::cases {

struct Attempt {
    std::filesystem::path caseFile;  ///< folder or file of the case; relative only inside the file
    std::uint64_t caseKey = 0;       ///< contentKey() of the case
    std::string caseName;
    std::vector<std::byte> state;  ///< of the cut field, as bytes
    double voxelMm = 0.05;         ///< of the field that the state belongs to
    std::array<double, kTissueCount> removedMm3{};
    std::string bur, cuttingParameters, drive;  ///< by name, as they were chosen
    double elapsedS = 0.0;
    std::string student;  ///< name or code, as typed; never taken from the machine
    std::string session;  ///< file name of the recording, without a folder; empty when there is none
    std::map<std::string, std::int64_t> counters;
    std::int64_t undoDepth = 0;  ///< strokes that could still be undone when it was saved
    /// All recordings that led to this tooth, in their order, and whether they come with it. None where nobody kept
    /// account.
    struct Recording {
        std::string name;  ///< of its file, without a folder
        bool packed = false;
        friend bool operator==(const Recording&, const Recording&) = default;
    };
    std::vector<Recording> recordings;
    bool handedIn = false;  ///< given to a teacher
    /// Of work on an exercise that was handed in: for which, and what its own program and its student make of it.
    struct HandIn {
        std::string exercise;  ///< id
        std::int64_t version = 1;
        std::string exerciseHash;               ///< 16 hexadecimal digits
        std::string result;                     ///< JSON of the score that it got where it was done; may be empty
        std::optional<double> expectedPercent;  ///< by its student, before they saw it
        std::string expectedWords;
        friend bool operator==(const HandIn&, const HandIn&) = default;
    };
    std::optional<HandIn> handIn;  ///< none of what was handed in without an exercise
    /// exercise.toml and rubric.toml of the exercise that it is work on, as text; empty: of none.
    std::string exercise{}, rubric{};
};

inline constexpr const char* kAttemptFile = "attempt.toml";
inline constexpr const char* kAttemptStateFile = "tooth.state";
inline constexpr const char* kRecordingsFile = "recordings.toml";
inline constexpr const char* kHandInFile = "hand-in.toml";
inline constexpr const char* kHandInResultFile = "result.json";
inline constexpr const char* kExerciseInAttempt = "exercise/exercise.toml";
inline constexpr const char* kRubricInAttempt = "exercise/rubric.toml";
/// Of the recordings that come along with an attempt, all together: an hour's work is a few dozen megabytes.
inline constexpr std::uint64_t kMaxRecordingBytes = 256ull << 20;

/// True for a folder with attempt.toml and for a .handpiece file that holds one. Throws core::Error for a .handpiece
/// file that cannot be read.
[[nodiscard]] bool isAttempt(const std::filesystem::path& path);

/// Into a folder (attempt.toml and tooth.state), or as one .handpiece file; whole or not at all. The case is named
/// relative to it; with `toothCase` a .handpiece file holds the case as well, and needs nothing beside it.
/// `recordings` by name come along; each must be one of the attempt's. Throws core::Error, also when the case to be
/// packed is not the attempt's and when the recordings are more than kMaxRecordingBytes.
void writeAttempt(const Attempt& attempt, const std::filesystem::path& path, const Case* toothCase = nullptr,
                  PackageFiles recordings = {});

/// One that came along. Throws core::Error when there is none of this name.
[[nodiscard]] std::vector<std::byte> readRecording(const std::filesystem::path& attempt, const std::string& name);

/// The attempt alone, with its case's place made absolute. Throws core::Error for what is missing, damaged, of a newer
/// format, negative or not finite.
[[nodiscard]] Attempt readAttempt(const std::filesystem::path& path);

struct OpenAttempt {
    Attempt attempt;
    Case toothCase;
};
/// The attempt and its case: the one packed with it, else the one that it names. Throws core::Error when that has
/// vanished or is another tooth by now.
[[nodiscard]] OpenAttempt openAttempt(const std::filesystem::path& path);

/// attempt.toml as text, and back; `where` names it in messages.
[[nodiscard]] std::string attemptToml(const Attempt& attempt);
[[nodiscard]] Attempt parseAttempt(std::string_view text, const std::string& where);

}  // namespace handpiece::cases
