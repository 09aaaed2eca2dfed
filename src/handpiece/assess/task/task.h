// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// An exercise as a file: a case, what is to be done with it, how it is judged. docs/formats/exercise.md.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/assess/preparation/preparation.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/case/package.h"

namespace handpiece::tasks {

inline constexpr const char* kTaskFile = "exercise.toml";
inline constexpr const char* kRubricFile = "rubric.toml";
inline constexpr const char* kTeacherWorkFile = "teacher.h5";
/// Half an hour at 1 kHz is some 30 MB [R].
inline constexpr std::uint64_t kMaxTeacherWorkBytes = 64u << 20;
inline constexpr const char* kZonesFile = "zones.bin";  ///< of recorded work
/// For whom an exercise is, the easiest first.
inline constexpr std::array<std::string_view, 4> kLevels = {"beginner", "basic", "intermediate", "advanced"};
/// A drive can be set to no slower speed than this share of its free one.
inline constexpr double kLeastSpeedShare = 0.02;

struct Task {
    std::string id;                                  ///< small letters, digits, '-'; 1 to 64 of them
    std::int64_t version = 1;                        ///< raised with each change that people shall tell apart
    cases::Case toothCase;                           ///< its `exercise` has texts, burs, locks, view
    double voxelMm = 0.05;                           ///< of the tooth: a score never hangs on a student's setting
    std::optional<double> minutes;                   ///< that it may take
    std::string level;                               ///< of kLevels; empty: not said
    bool isTimeHard = false;                         ///< work ends with them; else one is told
    bool hasLiveBar = false;                         ///< what is removed of the target is shown during the work
    std::string drive;                               ///< in hand at the beginning; empty: the student's choice
    std::optional<double> speedRpm;                  ///< that it is set to then; none: its own. Only with a drive
    std::optional<preparation::Recipe> preparation;  ///< what is to be cut; none: nothing is asked
    bool ownJudgement = false;                       ///< a student says what they expect before they see the result
    std::string rubric;                              ///< how it is judged, as its TOML text; empty: it is not
    /// The bytes of a session: the teacher's own work on this tooth, for the student to look at beside theirs. Null:
    /// there is none. What an attempt carries of its exercise is without it.
    std::shared_ptr<const std::vector<std::byte>> teacherWork{};
};

/// True for a folder with exercise.toml and for a .handpiece file that holds one. Throws core::Error for a .handpiece
/// file that cannot be read.
[[nodiscard]] bool isTask(const std::filesystem::path& path);
/// A folder or a .handpiece file; also a case with `[exercise]` in its case.toml, which then is a task without
/// preparation and rubric, and an attempt that carries its exercise. Throws core::Error (what, where with line,
/// remedy).
[[nodiscard]] Task readTask(const std::filesystem::path& path);
/// exercise.toml, as an attempt carries it beside the rubric, and back with the case that the attempt is of. Recorded
/// work does not go into it: such an exercise must be at hand itself.
[[nodiscard]] std::string taskToml(const Task& task);
[[nodiscard]] Task parseTask(std::string_view toml, std::string rubric, cases::Case toothCase,
                             const std::string& where);
/// The bytes of its .handpiece file. Throws core::Error.
[[nodiscard]] std::vector<std::byte> packedTask(const Task& task);
/// Into a folder, or as one .handpiece file; whole or not at all.
void writeTask(const Task& task, const std::filesystem::path& path);

/// What a score rests on: the case's surfaces and tissues, voxel, preparation. Not the texts, burs and drive, nor the
/// teacher's work, nor the rubric, which has a hash of its own.
[[nodiscard]] std::uint64_t contentHash(const Task& task);

/// What is wrong with it that can be told without working it: the preparation does not lie on the tooth, or leaves
/// nothing to do; burs that are too wide for its narrowest place. One sentence each; empty: nothing.
[[nodiscard]] std::vector<std::string> problems(const Task& task);

}  // namespace handpiece::tasks
