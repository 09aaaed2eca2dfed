// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A station's exams and its school's server: packs come, what was noted and handed over goes.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "handpiece/school/exam/invigilation.h"

namespace handpiece::school_exam {

/// Makes the station's key and gives its open half to the server, whose own is pinned. With a one-time code as any
/// station. Throws core::Error as school_station::enrol().
void enrolForExams(const std::string& server, const std::string& code, const std::filesystem::path& folder);

struct Fetched {
    std::vector<exam::Pack> packs;      ///< that came now
    std::vector<std::string> problems;  ///< a sentence each; the rest came
};
/// All exams that can still be begun. Throws core::Error "server-silent", "not-enrolled".
Fetched fetchExams(const std::filesystem::path& folder);

/// Asks for what opens those that are sealed here and whose time has come by this clock; the server's own decides.
/// Throws core::Error "server-silent".
void openExams(const std::filesystem::path& folder, school::Milliseconds now);

struct Told {
    std::size_t entries = 0, files = 0;
};
/// Entries that the server has not, in their order, and the recordings that it asks for. `entriesAfter` and `fileOf`
/// are asked from this thread. Throws core::Error "server-silent", or what the server says of an entry.
Told pushExams(const exam::StationIdentity& station,
               const std::function<std::vector<exam::Signed>(std::int64_t, std::size_t)>& entriesAfter,
               const std::function<std::filesystem::path(const std::string& sha256)>& fileOf);

/// Asks for the receipts of sittings that are there, each checked and put into its file. What the server has not whole
/// yet comes another time.
void fetchReceipts(const exam::StationIdentity& station,
                   const std::vector<std::pair<std::string, std::filesystem::path>>& sittings);

}  // namespace handpiece::school_exam
