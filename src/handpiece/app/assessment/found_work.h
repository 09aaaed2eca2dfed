// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What work lies in a folder: the one way by which all who score, mark and re-score find it.

#include <filesystem>
#include <optional>
#include <vector>

#include "handpiece/base/core/error.h"

namespace handpiece::assessment {

struct FoundWork {
    std::filesystem::path path;  ///< a session, a folder with the sessions of one work, an attempt (folder or file)
    bool isResultOnly = false;   ///< a result.json without the work that it is of
    std::optional<core::Error> error{};  ///< it cannot be read: why
};

/// By path: sessions (.h5) and attempts in the folder, each a work; in each folder directly below it its attempts, each
/// a work, and its sessions, together one: a chain. Where there is none of these, a result.json. What is something else
/// is passed over, and what begins with a dot. Throws core::Error (as "no-work-folder") where there is no such folder.
[[nodiscard]] std::vector<FoundWork> findWork(const std::filesystem::path& folder);

}  // namespace handpiece::assessment
