// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Whether a person may do something now: the one place that decides, asked by commands, panels, keys and the pointer.

#include <algorithm>
#include <array>
#include <bitset>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/model/case/exercise.h"

namespace handpiece::exercise {

/// What a person is at: at work on a tooth, watching a recording, or looking at what somebody handed in.
enum class WorkMode { nothing, work, replay, review };

/// What an exercise may lock, or what one mode has and another has not.
enum class Operation {
    undo,
    redo,
    reset,
    depthStop,
    depthReadout,  ///< depth and what is left over the pulp, beside the picture
    depthTool,
    pulpTool,
    calliper,
    removedDepth,   ///< its colours
    tissueColours,  ///< of the textbook, and the legend
    section,
    transparency,  ///< the removed part as glass, the tooth before, hidden tissues
    compare,
    mirror,
    directView,  ///< locked: only the mirror's picture is seen
    mirrorView,  ///< to choose between the two
    scaleBar,
    chart,     ///< of the mouth
    guidance,  ///< first steps, and hints in the picture
    volumes,   ///< that were removed
    report,
    elsewhere,  ///< other work, or copies of this one: no exercise locks it, an exam does
};
inline constexpr std::size_t kOperationCount = static_cast<std::size_t>(Operation::elsewhere) + 1;

/// Which operations a lock of cases::kHelps takes away. Old locks take what they always took.
struct Lock {
    std::string_view help;
    std::array<Operation, 6> takes;
    std::size_t count;
};
inline constexpr std::array<Lock, cases::kHelps.size()> kLocks{{
    {"undo", {Operation::undo, Operation::redo, Operation::reset}, 3},
    {"reset", {Operation::reset}, 1},
    {"depth",
     {Operation::depthStop, Operation::depthReadout, Operation::depthTool, Operation::pulpTool, Operation::calliper,
      Operation::removedDepth},
     6},
    {"tissue-colours", {Operation::tissueColours}, 1},
    {"cross-section", {Operation::section}, 1},
    {"transparency", {Operation::transparency, Operation::compare}, 2},
    {"guide", {Operation::guidance, Operation::depthStop}, 2},
    {"score", {Operation::volumes, Operation::report}, 2},
    {"mirror", {Operation::mirror, Operation::mirrorView}, 2},
    {"scale-bar", {Operation::scaleBar}, 1},
    {"chart", {Operation::chart}, 1},
    {"calliper", {Operation::calliper}, 1},
    {"compare", {Operation::compare}, 1},
    {"direct-view", {Operation::directView, Operation::mirrorView}, 2},
}};
static_assert(std::equal(kLocks.begin(), kLocks.end(), cases::kHelps.begin(),
                         [](const Lock& lock, std::string_view help) { return lock.help == help; }),
              "one lock a help, in the order of tooth::kHelps");

/// What is shut besides while an exam runs.
inline constexpr std::array kShutInExam{Operation::elsewhere, Operation::report, Operation::chart};

/// Plain data: what is allowed and what an exercise forbids. As made by default: everything, any bur.
class Permissions {
  public:
    [[nodiscard]] bool allows(Operation operation) const noexcept { return !has(locked_ | absent_, operation); }
    /// Forbidden by the exercise or the exam, not by what one is at.
    [[nodiscard]] bool locks(Operation operation) const noexcept { return has(locked_, operation); }
    /// An exam runs.
    [[nodiscard]] bool isExam() const noexcept { return isExam_; }
    [[nodiscard]] bool allowsBur(std::string_view bur) const {
        return burs_.empty() || std::find(burs_.begin(), burs_.end(), bur) != burs_.end();
    }
    /// Empty: all.
    [[nodiscard]] const std::vector<std::string>& burs() const noexcept { return burs_; }

    friend Permissions permissionsOf(const cases::Exercise* exercise, WorkMode mode, bool isExam);

  private:
    using Set = std::bitset<kOperationCount>;
    static bool has(const Set& set, Operation operation) noexcept { return set[static_cast<std::size_t>(operation)]; }

    Set locked_, absent_;
    bool isExam_ = false;
    std::vector<std::string> burs_;
};

/// A pure function. Locks hold while one works, and in a replay of that work; who looks at what was handed in has none.
/// `exercise`: of the tooth that is worked at, also while a replay covers it; null without one.
[[nodiscard]] inline Permissions permissionsOf(const cases::Exercise* exercise, WorkMode mode, bool isExam = false) {
    Permissions permissions;
    permissions.isExam_ = isExam;
    if (isExam)
        for (const Operation operation : kShutInExam)
            permissions.locked_.set(static_cast<std::size_t>(operation));
    if (mode != WorkMode::work)
        for (const Operation operation : {Operation::undo, Operation::redo, Operation::reset, Operation::depthStop})
            permissions.absent_.set(static_cast<std::size_t>(operation));
    if (mode == WorkMode::nothing) {
        permissions.absent_.set();
        permissions.absent_.reset(static_cast<std::size_t>(Operation::chart));
        permissions.absent_.reset(static_cast<std::size_t>(Operation::elsewhere));
        permissions.absent_.reset(static_cast<std::size_t>(Operation::guidance));
    }
    if (exercise == nullptr || mode == WorkMode::review) return permissions;
    permissions.burs_ = exercise->allowedBurs;
    for (const Lock& lock : kLocks) {
        const auto& helps = exercise->lockedHelps;
        if (std::find(helps.begin(), helps.end(), lock.help) == helps.end()) continue;
        for (std::size_t i = 0; i < lock.count; ++i)
            permissions.locked_.set(static_cast<std::size_t>(lock.takes[i]));
    }
    return permissions;
}

/// The bur to begin with: the one asked for where it is allowed, else the exercise's own, else the first allowed.
[[nodiscard]] inline std::string firstBur(const cases::Exercise* exercise, const std::string& asked) {
    if (exercise == nullptr || permissionsOf(exercise, WorkMode::work).allowsBur(asked)) return asked;
    return exercise->bur.empty() ? exercise->allowedBurs.front() : exercise->bur;
}

}  // namespace handpiece::exercise
