// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a marker gives back to a student of one work, as a file: what was judged otherwise and why, comments, who
/// passes. docs/formats/returned.md.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/app/marking/desk.h"

namespace handpiece::marking {

struct ReturnedMarks {
    std::string marker;
    /// Of which work: what a student's store knows of it as well.
    std::string exercise, exerciseHash, stateHash;
    std::vector<std::string> sessionHashes;  ///< the chain, in order; none of an attempt without its sessions
    std::string rubric, rubricHash;          ///< that the marker judged by
    double score = 0.0, maxScore = 0.0;      ///< with all overrides
    score::Passed passed = score::Passed::teacher;
    std::string decision;  ///< why, where the marker decided over the score; else empty
    struct Change {
        std::string criterion, band;   ///< as it stands now; band may be empty
        std::optional<double> points;  ///< now; none of what gives none
        double maxPoints = 0.0;
        bool isCritical = false;
        std::string reason;
    };
    std::vector<Change> changes;  ///< in the rubric's order
    std::vector<Comment> comments;
};

/// Throws core::Error: the work is hidden yet, or has no score.
[[nodiscard]] ReturnedMarks returnedMarks(const Desk& desk, const std::string& code);
/// Whether it is of this work.
[[nodiscard]] bool areOf(const ReturnedMarks& marks, const score::Identity& work);

inline constexpr std::size_t kMaxReturnedBytes = 4u << 20;
/// In `handpiece` of the file.
inline constexpr const char* kReturnedKind = "returned";
[[nodiscard]] std::string returnedJson(const ReturnedMarks& marks);
/// Throws core::Error: no returned marks, damaged, of a newer format, hostile sizes.
[[nodiscard]] ReturnedMarks parseReturned(std::string_view json, const std::string& where);

}  // namespace handpiece::marking
