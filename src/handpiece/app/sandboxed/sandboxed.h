// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a school's server and the window read of strangers' files, each time in a process that holds nothing
/// (base/sandbox): sessions, exercises, attempts. docs/sandbox.md.
///
/// What a file does to its reader stays there; what comes back is looked at here before it is believed to be of its
/// kind. Whether it is true nobody but its own reader knows: a file that takes its reader over can have it say of this
/// file whatever it likes, and of no other.
///
/// All throw core::Error: what the reader says of the file, and by id what sandbox::ask() says of the reader. Texts
/// that come back are UTF-8 without control characters other than line ends.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "handpiece/app/marking/scoring.h"
#include "handpiece/app/report/review.h"
#include "handpiece/base/core/progress.h"
#include "handpiece/model/case/exercise.h"
#include "handpiece/school/store/books.h"
#include "handpiece/senses/view/image.h"

namespace handpiece::sandboxed {

/// Sessions of one work in their order, and the file of the exercise, whose name ends in .handpiece.
struct Files {
    std::vector<std::filesystem::path> sessions{};
    std::filesystem::path exercise{};  ///< empty: none
};

/// What a station noted while an exam was worked.
struct ExamNotes {
    std::vector<std::string> locked{}, entries{};
};
/// What recordings hold, whatever their bytes; one entry a session.
struct Contents {
    std::vector<std::string> inputs{};                 ///< as one number; empty: nothing was done in it
    std::vector<std::vector<std::string>> sketches{};  ///< proving::motionSketch()
};
struct Proof {
    school::Score score{};
    Contents contents{};
    std::vector<std::string> doubts{};  ///< of its exam, as proving::recordingDoubts()
};
/// What is asked of an attempt that was pushed, but for its files: JSON, which may go to another machine. It names
/// nobody. `rubric` is a text.
[[nodiscard]] std::string questionOf(const school::PushedAttempt& attempt, const std::string& rubric,
                                     const std::optional<ExamNotes>& exam);
/// As proving::prove(). Of `score`, attempt, rubric and campaign are the caller's. Never throws for a session that
/// cannot be read: it is refused, as one is that ends its reader. What is wrong with exercise or rubric throws
/// "sandbox-exercise".
[[nodiscard]] Proof prove(const std::string& question, const Files& files, const core::Progress& progress = {});
/// That of a session which cannot be read is empty.
[[nodiscard]] Contents contentsOf(const std::vector<std::filesystem::path>& sessions);
/// For the way between two machines. Throws core::Error for what is no proof of so many sessions.
[[nodiscard]] std::string toJson(const Proof& proof);
[[nodiscard]] std::string toJson(const Contents& contents);
[[nodiscard]] Proof proofFrom(const std::string& json, std::size_t sessions);

/// What a review page shows. `result` and `rubric` are texts of the books; empty: the work is shown alone.
[[nodiscard]] report::Review review(const Files& files, const std::string& title, const std::string& result,
                                    const std::string& rubric, std::size_t mostBytes,
                                    const core::Progress& progress = {});

/// Reads all of a session, and keeps nothing of it.
struct ReadThrough {
    std::uint64_t ticks = 0, events = 0, keyFrames = 0;
    std::uint64_t peakBytes = 0;  ///< of memory that its reader had
};
[[nodiscard]] ReadThrough readThrough(const std::filesystem::path& session, const core::Progress& progress = {});

/// Reads all of a .handpiece file, be it a case, an exercise or an attempt, and all of the sessions in it, and keeps
/// nothing of them. A case that an attempt only names is another file.
struct CheckedPackage {
    std::string type{};                   ///< of cases::kPackageTypes
    std::vector<std::string> sessions{};  ///< SHA-256 of each
};
[[nodiscard]] CheckedPackage checkPackage(const std::filesystem::path& file, const core::Progress& progress = {});

/// What a teacher's desk asks of work that was given back.
struct Returned {
    std::filesystem::path work;      ///< a session, a folder with a chain of them, an attempt
    std::filesystem::path exercise;  ///< its file
    std::string rubric{};            ///< its text
    bool prove = true, draws = true;
};
/// As marking::judgeReturned(). Whether the result is of this exercise and rubric its caller looks at. A case that an
/// attempt only names is read where it lies in the attempt's own folder.
[[nodiscard]] marking::Judged returned(const Returned& of, const core::Progress& progress = {});

/// The tooth as this work leaves it, from occlusal.
[[nodiscard]] view::Image picture(const Files& files, int widthPx, int heightPx);

/// What pages say of an exercise.
struct Exercise {
    std::string id{}, hash{}, tooth{}, level{}, rubric{};
    cases::Texts title{}, instructions{};  ///< by language
    std::int64_t version = 0;
    std::optional<double> minutes{};
    double voxelMm = 0.0;
    bool hasPreparation = false;
    std::vector<std::string> lockedHelps{};
};
[[nodiscard]] Exercise exercise(const std::filesystem::path& file);
/// An exercise's file or folder as this program writes it. Throws core::Error also for one without a rubric.
struct PackedExercise {
    Exercise exercise{};
    std::vector<std::byte> file{};
};
[[nodiscard]] PackedExercise pack(const std::filesystem::path& file, std::size_t mostBytes);

/// report::studentReport() without pictures: a page.
[[nodiscard]] std::string studentReport(const std::filesystem::path& exercise, const std::string& result,
                                        const std::string& rubric);

}  // namespace handpiece::sandboxed
