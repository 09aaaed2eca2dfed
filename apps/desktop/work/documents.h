// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// From a file's name, or a tooth of a patient that the program makes, to a tooth ready to be cut. No widgets, any
/// thread.

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "desktop/work/outside_files.h"
#include "handpiece/app/course/first_mouth.h"
#include "handpiece/app/simulation/history_bytes.h"
#include "handpiece/app/simulation/live_session.h"
#include "handpiece/app/simulation/live_tooth.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/assess/task/task.h"
#include "handpiece/base/core/progress.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/dentition/tooth_form.h"

namespace handpiece::desktop {

/// What is withheld where somebody shows what they can do by themselves: a retest.
inline constexpr std::array<std::string_view, 7> kUnaidedLocks{
    "depth", "tissue-colours", "cross-section", "transparency", "guide", "calliper", "compare"};
[[nodiscard]] bool isUnaided(const tasks::Task& task);

/// A tooth that the program makes: one of the 32 of a patient.
struct Starter {
    int fdi = course::kFirstFdi;
    dentition::Patient patient{};
    std::size_t faces = course::kFirstFaces;  ///< of its surface: one of the five resolutions of the paper's Table II
    bool inMouth = true;                      ///< with the patient's other teeth, gingiva and bone; else alone
    friend bool operator==(const Starter&, const Starter&) = default;
};
struct Resolution {
    int percent;
    std::size_t faces;
};
inline constexpr std::array<Resolution, 5> kResolutions{
    {{6, 9760}, {12, 19516}, {25, 40656}, {50, 68151}, {100, 325312}}};

/// What a file is, told by its name and content.
enum class FileKind { unknown, toothCase, attempt, mesh, session };
[[nodiscard]] FileKind fileKindOf(const std::filesystem::path& path);

/// A recording and where its bytes are: itself on the shelf, or the attempt that it came with.
struct RecordingPlace {
    std::string name;  ///< of its file
    std::filesystem::path in;
    bool packed = false;  ///< `in` is the attempt
};

/// What is open.
struct Document {
    std::filesystem::path caseFile;     ///< of the tooth; of a starter tooth its place in the cache
    int workedOn = 0;                   ///< another tooth of that case than its own; 0: its own
    std::filesystem::path attemptFile;  ///< where it was saved or read; empty: nowhere yet
    std::optional<Starter> starter;
    std::string name;  ///< for the title: the file's, or the tooth's
    /// That led to this tooth before the recording under way, in their order.
    std::vector<RecordingPlace> recordings{};
    std::string student{};                      ///< of an attempt, as typed
    std::shared_ptr<const tasks::Task> task{};  ///< null: none is set
    std::filesystem::path taskPath{};
    std::int64_t began = 0;  ///< work on it [ms since 1970]; 0: not known
    double beforeS = 0.0;    ///< worked before the recording under way began
    std::string exam{};      ///< sitting of the exam that it is; empty: it is none
};

/// What is being done for a tooth that opens, for people.
enum class LoadStep { reading, recovering, shaping, mouth, distances, tissues, surface };
/// A tooth that is not ready to be cut, ready to be touched: its mesh felt exactly, the field around it coarse.
struct Touchable {
    std::shared_ptr<const cases::Case> toothCase;  ///< alone
    simulation::SimulationSetup station;
    std::shared_ptr<simulation::LiveTooth> liveTooth;
};

/// Hears of it on the thread that loads.
struct LoadListener {
    std::function<void(LoadStep step)> step;
    /// Something to look at before there is anything to feel: its parts and what stands around them.
    std::function<void(std::shared_ptr<const cases::Case> sketch)> sketch;
    /// The tooth that comes, to be touched until it can be cut. Once, and not where that takes no time.
    std::function<void(std::shared_ptr<Touchable> touchable)> touchable;
    /// It has its shape; the mouth around it is yet to be made.
    std::function<void(const cases::Tooth& tooth)> shaped;
    /// What was kept at `place` is damaged or not what its name says: it is made anew.
    std::function<void(const std::filesystem::path& place)> renewed;
    /// What was made cannot be kept at `place`: a full disk, a folder that is read only.
    std::function<void(const std::filesystem::path& place, const core::Error& why)> notKept;
};

/// What to open, and with what in hand.
struct LoadRequest {
    std::filesystem::path path;  ///< case, attempt or mesh; a session to be recovered from
    int fdi = 0;                 ///< the tooth of a case to work on; 0: its own
    std::optional<Starter> starter;
    std::filesystem::path task;          ///< an exercise, in the place of `path`
    bool unaided = false;                ///< with `task`: kUnaidedLocks are locked as well
    std::string exam;                    ///< with `task`, or to be recovered: the sitting ...
    std::vector<std::string> examLocks;  ///< ... and all helps that are locked in it
    bool recover = false;
    Document recovered;  ///< with `recover`: what its marker says
    std::optional<cases::Exercise> exercise;
    std::filesystem::path sessionFolder;  ///< where recordings are that an attempt only names
    std::filesystem::path starterFolder;
    std::string bur = "330", drive = "turbine";
    double speedRpm = 0.0;  ///< 0: the drive's own
    simulation::SimulationSettings settings;
    bool useCache = true;
    std::shared_ptr<const OutsideFiles> outside{};  ///< what the file is read by first; null: it is opened as it lies
};
struct LoadedTooth {
    Document document;
    std::shared_ptr<const cases::Case> toothCase;
    simulation::SimulationSetup station;
    std::shared_ptr<simulation::LiveTooth> liveTooth;
    tooth::StateDelta state;  ///< that it was resumed with
    simulation::KeptHistory history;
    double elapsedS = 0.0;
    std::string bur, drive, code;
    double speedRpm = 0.0;
    /// The recording that goes on with it, and from where; empty: a new one begins.
    std::filesystem::path recording;
    simulation::LiveSessionSettings::Session session = simulation::LiveSessionSettings::Session::anew;
    std::string missingBur;  ///< the bur an attempt was cut with, when it cannot be had: another is in hand
    std::string lockedBur;   ///< and when its exercise does not allow it
};
/// Seconds, the first time; a tooth whose cache stands within one. Throws core::Error.
[[nodiscard]] LoadedTooth loadTooth(const LoadRequest& request, const core::Progress& progress,
                                    const LoadListener& listener = {});

/// The recordings' bytes by name, the newest first as far as they go into tooth::kMaxRecordingBytes; `packedOnly`: of
/// those that came with an attempt. `leftOut`: how many did not fit, or are no longer there.
[[nodiscard]] cases::PackageFiles recordingBytes(const std::vector<RecordingPlace>& places, bool packedOnly,
                                                 std::size_t& leftOut, const core::Progress& progress);

/// The case of a starter tooth: it and its patient's mouth out of their folders in the cache, made and put there the
/// first time. Where nothing can be put there it is opened all the same.
[[nodiscard]] cases::Case starterCase(const Starter& starter, const std::filesystem::path& folder,
                                      const core::Progress& progress, const LoadListener& listener = {});

/// The drive by name, its free speed set to `speedRpm` (0: its own; never more than that).
[[nodiscard]] instrument::Drive driveAt(const std::string& name, double speedRpm);

/// The tissues of its parts, in their order; of a case without parts enamel.
[[nodiscard]] std::vector<cases::Tissue> presentTissues(const cases::Case& toothCase);

}  // namespace handpiece::desktop
