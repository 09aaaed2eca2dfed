// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// From what somebody did to a score: sessions or an attempt, held against their exercise, measured, judged.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "handpiece/app/assessment/recording.h"
#include "handpiece/assess/score/score.h"
#include "handpiece/assess/task/task.h"
#include "handpiece/base/core/progress.h"
#include "handpiece/model/tooth/tooth_mirror.h"

namespace handpiece::assessment {

/// What was done, as far as it goes into a score.
struct Work {
    tooth::Teeth teeth;  ///< by their numbers in the exercise's case
    tooth::StateDelta state;
    std::vector<std::string> sessionHashes;  ///< of the files, in the order of the work; none of an attempt alone
    bool isProven = false;                   ///< cut again from its beginning it left this very tooth, bit for bit
    std::string proof;                       ///< in a sentence: that, or why not
    score::Context context;
    std::vector<Recording> recordings{};   ///< that led to this tooth, in the order of the work, where all are known
    std::string noHand{};                  ///< why nothing is measured of the hand; empty: it is
    std::optional<score::ScanFit> scan{};  ///< of a scan; readScan() makes those
    std::string noBeside{};                ///< why nothing is known of cuts in the teeth beside it; empty: it is
};

/// Files of sessions (.h5) in a folder, by name.
[[nodiscard]] std::vector<std::filesystem::path> sessionsIn(const std::filesystem::path& folder);
/// Of all that makes a piece of work: a session, a folder's sessions, an attempt's files. Throws core::Error.
[[nodiscard]] std::string workHash(const std::filesystem::path& work);

/// Of a session (.h5), of a folder with all sessions of a chain, each of which goes on from the tooth that the one
/// before it left, or of an attempt, with the sessions that came along. Sessions are cut again unless `prove` is false;
/// one that does not come to the same tooth, or is of another engine, is taken from its last key frame and says so.
/// Where a session of a chain is missing, or is another tooth than the attempt, it is not proven and has no measures of
/// the hand. Throws core::Error: none of these; work on another tooth than the exercise's, or in another voxel; a
/// folder with sessions of several works. `unpacked`: a folder in which the sessions that came along with an attempt
/// lie already, under their names; empty: they are unpacked.
[[nodiscard]] Work readWork(const std::filesystem::path& path, const tasks::Task& task, bool prove = true,
                            const core::Progress& progress = {}, const std::filesystem::path& unpacked = {});

/// A teacher's own work on an exercise (one session, .h5), as its file may carry it. Nothing in a session says of which
/// exercise it is: who takes it may hold `work` against the task. Throws core::Error: no session, of another tooth or
/// voxel, not proven, too large.
struct ProvenWork {
    std::shared_ptr<const std::vector<std::byte>> file;
    Work work;
};
[[nodiscard]] ProvenWork provenWork(const std::filesystem::path& session, const tasks::Task& task,
                                    const core::Progress& progress = {});

/// A session of a chain that is known, whatever happened to its file.
struct ChainLink {
    std::string name;          ///< of its file
    std::filesystem::path in;  ///< itself, or the attempt that it came with
    bool isPacked = false;     ///< that
};
/// Of a chain in the order of the work, as readWork() of an attempt's; the tooth is what the last one leaves. Throws
/// core::Error also where that is not there.
[[nodiscard]] Work readChain(std::span<const ChainLink> chain, const tasks::Task& task, bool prove = true,
                             const core::Progress& progress = {});

/// What was measured of a piece of work: all that a rubric needs to judge it.
struct MeasuredWork {
    std::vector<measures::Measured> measured;
    score::Identity identity;
    score::Context context;
    std::string proof;
    core::Vec3 draw = core::Vec3::UnitZ();  ///< path of draw, out of the tooth; not kept in a store
};
/// What a rubric asks for, each once.
[[nodiscard]] std::vector<measures::Request> requestsOf(const rubric::Rubric& rubric);
/// The same inputs, the same bits, at any thread count. Throws core::Error for what does not exist.
[[nodiscard]] MeasuredWork measureWork(const Work& work, const tasks::Task& task,
                                       std::span<const measures::Request> requests,
                                       const core::Progress& progress = {});

using Result = score::Result;
/// Throws core::Error for a rubric that is not sound.
[[nodiscard]] Result judge(const MeasuredWork& work, const rubric::Rubric& rubric);
/// measureWork() and judge().
[[nodiscard]] Result scoreWork(const Work& work, const tasks::Task& task, const rubric::Rubric& rubric,
                               const core::Progress& progress = {});

}  // namespace handpiece::assessment
