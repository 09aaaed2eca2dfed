// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a school's server makes of an attempt that a station pushed: its sessions cut again, measured, judged. Nothing
/// that the station says is taken for granted. docs/school-books.md.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/assess/task/task.h"
#include "handpiece/base/core/progress.h"
#include "handpiece/school/store/books.h"

namespace handpiece::proving {

/// Under which conditions a session (.h5) was recorded that the exercise does not have, from its beginning through
/// every change: harder or softer tissues, a bur that it does not allow or that is not the catalogue's, a stronger
/// drive, everything cut at once. One sentence each; empty: none. How the hand feels the tooth (device, force law,
/// stiffness) is its station's affair. Throws core::Error for a file that cannot be read.
[[nodiscard]] std::vector<std::string> otherConditions(const std::filesystem::path& session, const tasks::Task& task);

/// Of an attempt with its session files in their order. Exercise, tooth, tissues and rubric are the caller's own.
/// "proven": cut again from its beginning it leaves the tooth that it says, bit for bit, under the exercise's
/// conditions; the score is the one found here, and `reason` tells where the station said another. "refused": why, in a
/// sentence; what its last key frame is worth stands there too where that can be read. `made`, `worker` and `campaign`
/// are left to the caller. Throws core::Error only for a task or rubric that is not sound, and "cancelled".
[[nodiscard]] school::Score prove(const school::PushedAttempt& attempt, std::span<const std::filesystem::path> sessions,
                                  const tasks::Task& task, const rubric::Rubric& rubric,
                                  const core::Progress& progress = {});

}  // namespace handpiece::proving
