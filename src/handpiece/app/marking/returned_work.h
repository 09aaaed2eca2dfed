// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What lies in a folder of returned work: sessions, attempts, results.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/progress.h"

namespace handpiece::marking {

struct ReturnedWork {
    std::string name;                    ///< below the folder, with '/'
    std::string id;                      ///< of its content, 16 hexadecimal digits: the same for every marker and place
    std::filesystem::path path;          ///< a session, a folder of a chain of them, an attempt; of a lone result that
    bool isResultOnly = false;           ///< a result.json without the work that it is of
    std::optional<core::Error> error{};  ///< why it cannot be scored; none: nothing known
    std::string twin{};                  ///< name of another work that is the same to the byte; empty: none
};

inline constexpr std::size_t kMaxWorks = 5000;

/// What assessment::findWork() finds, by name; what cannot be read, and what is the same to the byte as another, is
/// there with its problem. Throws core::Error: no such folder, more than kMaxWorks, cancelled.
[[nodiscard]] std::vector<ReturnedWork> findWork(const std::filesystem::path& folder,
                                                 const core::Progress& progress = {});

}  // namespace handpiece::marking
